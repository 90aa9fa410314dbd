#!/usr/bin/python3
"""Writes a simulated drive in many forms of recording, none of them by the library that reads them."""

import argparse
import json
import shutil
import struct
import sys
from pathlib import Path

import cdr
from cloud_writers import write_ascii_ply, write_pcd_by_numbers, write_pcd_by_stamps, write_ply, write_ply_folder
from damage import damaged, is_damaged, is_other, small_clouds
from db3_writer import CLOUD, TEXT, drive_messages, tf_messages, write_bag_folder, write_file
from drive import PERIOD_NS, Scan, pose_track, quaternion, read_drive
from kitti_writers import write_kitti_odometry, write_kitti_raw, write_tum
from point_layouts import PACKED

try:
    import ros1_writer
    from std_msgs.msg import String
except ImportError as missing:
    ros1_writer = None
    print(f"no bags of ROS 1: {missing} (python3-rosbag, python3-sensor-msgs, python3-nav-msgs, python3-tf2-msgs)")

# Of forms that take much space.
FIRST_SCANS = 3


def write_folders(out, scans):
    write_kitti_odometry(out / "kitti", scans)
    write_kitti_odometry(out / "kitti_first", scans[:FIRST_SCANS])
    write_kitti_raw(out / "kitti_raw", scans, out / "kitti")
    write_pcd_by_stamps(out / "pcd_stamps", scans)
    write_pcd_by_numbers(out / "pcd_numbers", scans, out / "pcd_stamps")
    write_ply_folder(out / "ply", scans, write_ply)
    write_ply_folder(out / "ply_ascii", scans[:FIRST_SCANS], write_ascii_ply)


def write_ros1(out, scans):
    folder = out / "ros1"
    folder.mkdir()
    for compression in ("none", "bz2", "lz4"):
        ros1_writer.write_bag(folder / f"{compression}.bag", scans, compression)
    ros1_writer.write_tf_bag(folder / "tf.bag", scans)


def write_db3(out, scans):
    write_bag_folder(out / "ros2_db3", drive_messages(scans), files=2)
    write_bag_folder(out / "ros2_db3_tf", tf_messages(scans), files=1)


def damaged_ros1(scan):
    for number, stamp_ns, points in small_clouds(scan):
        if is_other(number):
            message = String("no cloud")
        else:
            message = ros1_writer.cloud_message(stamp_ns, points, PACKED)
        data = ros1_writer.bytes_of(message)
        if is_damaged(number):
            data = damaged(data, number, struct.pack("<I", 1) + b"x", points)
        yield stamp_ns, "/status" if is_other(number) else "/points", type(message), data


def damaged_ros2(scan):
    for number, stamp_ns, points in small_clouds(scan):
        if is_other(number):
            yield stamp_ns, "/status", TEXT, cdr.text("no cloud")
            continue
        data = cdr.point_cloud(stamp_ns, points, PACKED)
        if is_damaged(number):
            data = damaged(data, number, struct.pack("<I", 2) + b"x\0", points)
        yield stamp_ns, "/points", CLOUD, data


def write_damaged(out, scan):
    folder = out / "damaged"
    folder.mkdir()
    # The vehicle stands.
    write_tum(folder / "poses.txt", [Scan(stamp_ns, scan.T_map_lidar, points)
                                     for _, stamp_ns, points in small_clouds(scan)])
    messages = list(damaged_ros2(scan))
    write_file(folder / "damaged.db3", messages)
    write_for_mcap(folder / "damaged.messages", messages)
    if ros1_writer:
        ros1_writer.write_raw_bag(folder / "damaged.bag", damaged_ros1(scan))


def write_for_mcap(path, messages):
    """Messages that write_mcap.mjs puts into a bag as they are: stamp, whether of a cloud, size, bytes."""
    with open(path, "wb") as file:
        for stamp_ns, _, kind, data in messages:
            file.write(struct.pack("<QII", stamp_ns, kind == CLOUD, len(data)) + data)


def write_track(path, scans):
    """The poses that write_mcap.mjs puts into bags: stamp in ns, x y z, qx qy qz qw."""
    lines = []
    for stamp_ns, T in pose_track(scans, 4):
        lines.append(f"{stamp_ns} " + " ".join(f"{v:.17g}" for v in [*T[:3, 3], *quaternion(T[:3, :3])]) + "\n")
    path.write_text("".join(lines))


def write_big_bag(path, scans, gigabytes):
    """A bag of ROS 2 in SQLite of that size: the drive, again and again. For use by hand."""
    def repeated():
        size, start_ns = 0, 0
        while size < gigabytes * 2**30:
            for scan in scans:
                stamp_ns = scan.stamp_ns + start_ns
                size += scan.points.nbytes
                yield stamp_ns, "/points", CLOUD, cdr.point_cloud(stamp_ns, scan.points, PACKED)
                yield stamp_ns, "/pose", "geometry_msgs/msg/PoseStamped", cdr.pose_stamped(stamp_ns, scan.T_map_lidar)
            start_ns += len(scans) * PERIOD_NS
    write_file(path, repeated())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("drive", type=Path, help="what saw_ndt_simulate -rolling-shutter wrote")
    parser.add_argument("sensor", type=Path, help="its sensor, as in data/sensors")
    parser.add_argument("out", type=Path, help="folder to write, replaced where it exists")
    parser.add_argument("--big-bag", type=float, metavar="GB", help="write a bag of that size, to the file OUT, alone")
    arguments = parser.parse_args()

    scans = read_drive(arguments.drive, json.loads(arguments.sensor.read_text())["elevations_deg"])
    out = arguments.out
    if arguments.big_bag:
        return write_big_bag(out, scans, arguments.big_bag)
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    write_folders(out, scans)
    write_track(out / "track.txt", scans)
    if ros1_writer:
        write_ros1(out, scans)
    write_db3(out, scans)
    write_damaged(out, scans[0])
    print(f"{out}: {len(scans)} scans of {sum(len(scan.points) for scan in scans)} points")


if __name__ == "__main__":
    sys.exit(main())
