"""Bags of ten thousand messages, some of which no reader can read."""

import struct

import numpy as np

from drive import FIRST_STAMP_NS, POINT
from point_layouts import FRAME, PACKED, cloud_bytes

MESSAGES = 10_000
EVERY = 1_000  # of so many messages one is damaged, and one is of another topic and type
DAMAGED_AT, OTHER_AT = 500, 250
POINTS = 12
STEP_NS = 10_000_000


def small_clouds(scan):
    """(number, stamp_ns, points): each some points of the scan, for a LiDAR that stands."""
    stride = len(scan.points) // POINTS
    for number in range(MESSAGES):
        yield number, FIRST_STAMP_NS + number * STEP_NS, scan.points[number % stride::stride][:POINTS].astype(POINT)


def is_damaged(number):
    return number % EVERY == DAMAGED_AT


def is_other(number):
    return number % EVERY == OTHER_AT


def damaged(data, number, name_of_x, points):
    """The bytes of a cloud message with the damage of its number; `name_of_x` is the string "x" as the form has it."""
    data = bytearray(data)
    fields = data.index(struct.pack("<I", len(PACKED.names)) + name_of_x)
    fields_end = fields + (len(data) - fields) // 2
    content = cloud_bytes(points, PACKED)
    content_at = data.index(content)
    frame_at = data.index(FRAME.encode())
    offset_at = data.index(b"intensity", fields, fields_end)
    offset_at = data.index(struct.pack("<I", PACKED.fields["intensity"][1]), offset_at)

    def put(at, value):
        data[at:at + 4] = struct.pack("<I", value)

    kind = number // EVERY % 10
    if kind == 0:
        return bytes(data[:len(data) // 2])
    if kind == 1:
        return bytes(data[:7])
    if kind == 2:
        return b""
    if kind == 3:
        return np.random.default_rng(number).bytes(len(data))
    if kind == 4:
        put(content_at - 4, 0xFFFFFFFF)  # bytes of the points
    if kind == 5:
        put(frame_at - 4, 0xFFFFFFF0)  # length of the frame's name
    if kind == 6:
        put(fields, 0x7FFFFFFF)  # number of fields
    if kind == 7:
        put(content_at - 12, 0)  # bytes a point
    if kind == 8:
        put(fields - 8, 0x80000000)  # rows, and points a row
        put(fields - 4, 0x80000002)
    if kind == 9:
        put(offset_at, 0xFFFFFFFE)  # where in a point a field lies
    return bytes(data)
