#!/usr/bin/env python3
"""Writes the capture (.pcap) that a VLP-16 would have sent of a simulated drive.

    saw_ndt_simulate drive -scene residential -scans 20 -sensor VLP-16
    write_velodyne_capture.py drive drive.pcap

The drive is a sequence in the layout of KITTI odometry whose LiDAR has the beams of a VLP-16: velodyne/*.bin and
times.txt. A turn of the capture begins at the stamp of a scan, at azimuth 0, and ends at the next one. As a VLP-16 does,
it fires every 55.296 us; the range of a firing is interpolated between the two points of its ring beside it where they
are of one surface, else that of the nearer one.

With --exact nothing is interpolated: there is a firing every 0.01 degrees, so that each point has one of its own, at 20
times the rate of packets. Times within a packet then say little.

Scans must be as seen from their poses: the simulator's -rolling-shutter turns the other way round.
This program shares no code with the reader, which it tests.
"""

import argparse
import bisect
import math
import pathlib
import random
import struct

ELEVATIONS_DEG = [-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15]  # by laser
FIRING_US = 55.296
LASER_US = 2.304
FIRINGS_PER_PACKET = 24
TURN = 36000  # 0.01 degrees
DISTANCE_UNIT_M = 0.002
MOST_DISTANCE = 0xFFFF
# Neighbours in a ring lie on one surface where their ranges differ by less than this share, and are that near.
SURFACE_SHARE = 0.05
NEIGHBOUR = 30


def read_scan(path):
    """Returns by laser the points as (azimuth in 0.01 degrees clockwise, range in metres, intensity), by azimuth."""
    lasers = [[] for _ in ELEVATIONS_DEG]
    for x, y, z, intensity in struct.iter_unpack("<4f", path.read_bytes()):
        elevation_deg = math.degrees(math.atan2(z, math.hypot(x, y)))
        laser = min(range(16), key=lambda i: abs(ELEVATIONS_DEG[i] - elevation_deg))
        azimuth = math.degrees(math.atan2(-y, x)) % 360.0 * 100.0
        lasers[laser].append((azimuth, math.sqrt(x * x + y * y + z * z), intensity))
    for points in lasers:
        points.sort()
    return lasers


def quantized(range_m, intensity):
    distance = round(range_m / DISTANCE_UNIT_M)
    return (distance if distance <= MOST_DISTANCE else 0, min(255, max(0, round(intensity * 255.0))))


def interpolated(points, azimuth, reach):
    """The return (distance, intensity) of a laser at an azimuth."""
    if not points:
        return 0, 0
    index = bisect.bisect_left(points, (azimuth,))
    before, after = points[index - 1], points[index % len(points)]
    since = (azimuth - before[0]) % TURN
    until = (after[0] - azimuth) % TURN
    if since + until <= NEIGHBOUR and abs(after[1] - before[1]) <= SURFACE_SHARE * min(after[1], before[1]):
        share = since / (since + until) if since + until > 0.0 else 0.0
        return quantized(before[1] + share * (after[1] - before[1]), after[2] if share > 0.5 else before[2])
    nearest, away = (before, since) if since < until else (after, until)
    return quantized(nearest[1], nearest[2]) if away <= reach else (0, 0)


def packet_bytes(blocks, time_us):
    """A data packet of 12 blocks (azimuth, 32 returns)."""
    data = bytearray()
    for azimuth, returns in blocks:
        data += struct.pack("<HH", 0xEEFF, azimuth)
        for distance, intensity in returns:
            data += struct.pack("<HB", distance, intensity)
    # Strongest return; VLP-16.
    return bytes(data + struct.pack("<IBB", time_us % 3_600_000_000, 0x37, 0x22))


def sensor_packets(scans, stamps_s):
    """Yields (time in s, packet) of the firings of a VLP-16 from the first stamp to the last one."""
    firing, scan, lasers, blocks, begin_s = 0, 0, read_scan(scans[0]), [], stamps_s[0]
    while True:
        time_s = stamps_s[0] + 1e-6 * FIRING_US * firing
        while time_s >= stamps_s[scan + 1]:
            scan += 1
            if scan == len(scans):
                return
            lasers = read_scan(scans[scan])
        rate = TURN / (stamps_s[scan + 1] - stamps_s[scan])  # 0.01 degrees a second
        half_step = 0.5e-6 * rate * FIRING_US
        azimuth = rate * (time_s - stamps_s[scan])
        if firing % 2 == 0:
            block_azimuth = round(azimuth) % TURN
            returns = []
            if not blocks:
                begin_s = time_s
        for laser in range(16):
            fired_at = (azimuth + 1e-6 * LASER_US * laser * rate) % TURN
            returns.append(interpolated(lasers[laser], fired_at, half_step))
        if firing % 2 == 1:
            blocks.append((block_azimuth, returns))
        firing += 1
        if len(blocks) == 12:
            yield begin_s, packet_bytes(blocks, round(begin_s * 1e6))
            blocks = []


def exact_packets(scans, stamps_s):
    """Yields (time in s, packet) with blocks every 0.02 degrees; each of its two firings is 0.01 degrees ahead of the
    one before, and the lasers within a firing by up to 0.006 degrees more."""
    for scan, path in enumerate(scans):
        returns = {}
        for laser, points in enumerate(read_scan(path)):
            for azimuth, range_m, intensity in points:
                firing = round(azimuth - laser * LASER_US / FIRING_US) % TURN
                returns[firing, laser] = quantized(range_m, intensity)
        period_s = stamps_s[scan + 1] - stamps_s[scan]
        for first in range(0, TURN, FIRINGS_PER_PACKET):
            blocks = []
            for azimuth in range(first, first + FIRINGS_PER_PACKET, 2):
                keys = [(azimuth + i, laser) for i in range(2) for laser in range(16)]
                blocks.append((azimuth, [returns.get(key, (0, 0)) for key in keys]))
            time_s = stamps_s[scan] + period_s * first / TURN
            yield time_s, packet_bytes(blocks, round(time_s * 1e6))


def checksum(header):
    total = sum(struct.unpack(">10H", header))
    while total > 0xFFFF:
        total = (total & 0xFFFF) + (total >> 16)
    return ~total & 0xFFFF


def frame(payload, source, destination=(255, 255, 255, 255), port=2368):
    """An Ethernet frame of a UDP packet."""
    udp = struct.pack(">HHHH", port, port, 8 + len(payload), 0) + payload
    ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 0, 0x4000, 255, 17, 0, bytes(source), bytes(destination))
    ip = ip[:10] + struct.pack(">H", checksum(ip)) + ip[12:]
    return b"\xff" * 6 + b"\x60\x76\x88\x00\x00\x01" + b"\x08\x00" + ip + udp


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=pathlib.Path, help="folder with velodyne/ and times.txt")
    parser.add_argument("capture", type=pathlib.Path, help="the .pcap file to write")
    parser.add_argument("--exact", action="store_true", help="a firing for every point; see above")
    parser.add_argument("--start-time", type=float, default=1.6e9, metavar="SECONDS",
                        help="since 1970, added to times.txt (default: %(default).0f)")
    parser.add_argument("--sensor-clock", type=float, default=0.0, metavar="SECONDS",
                        help="how far the sensor's clock is ahead of GPS time")
    parser.add_argument("--jitter", type=float, default=0.0, metavar="SECONDS",
                        help="how much later than sent a packet comes at most")
    parser.add_argument("--source", default="192.168.1.201", metavar="ADDRESS", help="of the sensor")
    parser.add_argument("--scans", type=int, default=0, metavar="N", help="of the sequence at most; 0: all")
    arguments = parser.parse_args()

    scans = sorted((arguments.sequence / "velodyne").glob("*.bin"))
    stamps_s = [float(line) for line in (arguments.sequence / "times.txt").read_text().split()]
    if arguments.scans > 0:
        scans = scans[: arguments.scans]
    if not scans or len(stamps_s) < len(scans):
        parser.error(f"{arguments.sequence}: {len(scans)} scans and {len(stamps_s)} times")
    stamps_s = [arguments.start_time + stamp_s for stamp_s in stamps_s[: len(scans)]]
    stamps_s.append(2.0 * stamps_s[-1] - stamps_s[-2] if len(scans) > 1 else stamps_s[-1] + 0.1)
    source = [int(number) for number in arguments.source.split(".")]
    noise = random.Random(1)

    packets = exact_packets(scans, stamps_s) if arguments.exact else sensor_packets(scans, stamps_s)
    with open(arguments.capture, "wb") as capture:
        capture.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1))
        for time_s, packet in packets:
            stamp_us = struct.unpack_from("<I", packet, 1200)[0] + round(arguments.sensor_clock * 1e6)
            packet = packet[:1200] + struct.pack("<I", stamp_us % 3_600_000_000) + packet[1204:]
            captured_us = round((time_s + noise.uniform(0.0, arguments.jitter)) * 1e6)
            data = frame(packet, source)
            capture.write(struct.pack("<IIII", captured_us // 1_000_000, captured_us % 1_000_000, len(data), len(data)))
            capture.write(data)


if __name__ == "__main__":
    main()
