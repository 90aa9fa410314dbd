"""Messages of ROS 2 in the bytes that they travel in (CDR, little endian)."""

import struct

from drive import quaternion
from point_layouts import FRAME, cloud_bytes, cloud_fields


class CdrWriter:
    def __init__(self):
        self.bytes = bytearray(b"\x00\x01\x00\x00")  # plain CDR, little endian, no options

    def numbers(self, form, *values):
        """Numbers of one type, each at a multiple of its size behind the four bytes of the head."""
        size = struct.calcsize("<" + form)
        self.bytes += bytes(-(len(self.bytes) - 4) % size)
        self.bytes += struct.pack(f"<{len(values)}{form}", *values)

    def string(self, text):
        self.numbers("I", len(text) + 1)
        self.bytes += text.encode() + b"\0"

    def header(self, stamp_ns, frame):
        self.numbers("i", stamp_ns // 10**9)
        self.numbers("I", stamp_ns % 10**9)
        self.string(frame)

    def vector(self, numbers):
        self.numbers("d", *numbers)

    def rotation_of(self, T):
        self.numbers("d", *quaternion(T[:3, :3]))


def point_cloud(stamp_ns, points, layout):
    cdr = CdrWriter()
    cdr.header(stamp_ns, FRAME)
    cdr.numbers("I", 1, len(points))
    fields = cloud_fields(layout)
    cdr.numbers("I", len(fields))
    for name, offset, datatype in fields:
        cdr.string(name)
        cdr.numbers("I", offset)
        cdr.numbers("B", datatype)
        cdr.numbers("I", 1)
    cdr.numbers("?", False)
    cdr.numbers("I", layout.itemsize, layout.itemsize * len(points))
    data = cloud_bytes(points, layout)
    cdr.numbers("I", len(data))
    cdr.bytes += data
    cdr.numbers("?", True)
    return bytes(cdr.bytes)


def pose_stamped(stamp_ns, T_map_lidar):
    cdr = CdrWriter()
    cdr.header(stamp_ns, "map")
    cdr.vector(T_map_lidar[:3, 3])
    cdr.rotation_of(T_map_lidar)
    return bytes(cdr.bytes)


def tf_message(transforms):
    """Of (stamp_ns, parent, child, T_parent_child)."""
    cdr = CdrWriter()
    cdr.numbers("I", len(transforms))
    for stamp_ns, parent, child, T in transforms:
        cdr.header(stamp_ns, parent)
        cdr.string(child)
        cdr.vector(T[:3, 3])
        cdr.rotation_of(T)
    return bytes(cdr.bytes)


def text(content):
    cdr = CdrWriter()
    cdr.string(content)
    return bytes(cdr.bytes)
