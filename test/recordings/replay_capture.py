#!/usr/bin/env python3
"""Sends the UDP payloads of a capture (.pcap of Ethernet frames) to a port of this machine, as fast as they were
recorded.

    replay_capture.py drive.pcap 2368
"""

import argparse
import socket
import struct
import time


def payloads(capture):
    """Yields (time in s, payload) of the UDP packets of a capture."""
    header = capture.read(24)
    magic = header[:4]
    order = "<" if magic in (b"\xd4\xc3\xb2\xa1", b"\x4d\x3c\xb2\xa1") else ">"
    unit_s = 1e-9 if magic in (b"\x4d\x3c\xb2\xa1", b"\xa1\xb2\x3c\x4d") else 1e-6
    if struct.unpack(order + "I", header[20:24])[0] != 1:
        raise SystemExit("no capture of Ethernet frames")
    while True:
        record = capture.read(16)
        if len(record) < 16:
            return
        seconds, parts, size, _ = struct.unpack(order + "4I", record)
        data = capture.read(size)
        if len(data) == size >= 42 and data[12:14] == b"\x08\x00" and data[23] == 17:
            udp = 14 + 4 * (data[14] & 15)
            yield seconds + unit_s * parts, data[udp + 8 :]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture")
    parser.add_argument("port", type=int)
    parser.add_argument("--rate", type=float, default=1.0, metavar="FACTOR", help="of the recorded rate")
    parser.add_argument("--address", default="127.0.0.1", help="where to send to (default: %(default)s)")
    arguments = parser.parse_args()

    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    first_s, begin_s = None, time.monotonic()
    with open(arguments.capture, "rb") as capture:
        for time_s, payload in payloads(capture):
            first_s = time_s if first_s is None else first_s
            wait_s = begin_s + (time_s - first_s) / arguments.rate - time.monotonic()
            if wait_s > 0.0:
                time.sleep(wait_s)
            sender.sendto(payload, (arguments.address, arguments.port))


if __name__ == "__main__":
    main()
