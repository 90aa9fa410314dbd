"""Folders of PCD and of PLY files."""

import os

import numpy as np

from drive import POINT, quaternion, seconds
from kitti_writers import matrix_line, write_tum

PCD_POINT = np.dtype([(name, POINT[name]) for name in ("x", "y", "z", "intensity", "t", "ring")])
# Another order of the fields, and of other sizes: ring before the times, these as float.
PLY_POINT = np.dtype([("ring", "<u2"), ("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("t", "<f4"), ("intensity", "<f4")])
PLY_TYPES = {"<f4": "float", "<u2": "ushort", "<u4": "uint"}


def in_layout(points, layout):
    """The points with the fields of another layout."""
    result = np.zeros(len(points), dtype=layout)
    for name in layout.names:
        result[name] = points[name]
    return result


def write_pcd(path, points):
    header = ("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity t ring\n"
              "SIZE 4 4 4 4 4 2\nTYPE F F F F U U\nCOUNT 1 1 1 1 1 1\n"
              f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n")
    path.write_bytes(header.encode() + in_layout(points, PCD_POINT).tobytes())


def write_pcd_by_stamps(folder, scans):
    """Files whose names are their stamps, and poses in TUM format."""
    folder.mkdir(parents=True)
    for scan in scans:
        write_pcd(folder / f"{seconds(scan.stamp_ns)}.pcd", scan.points)
    write_tum(folder / "poses.txt", scans)


def write_pcd_by_numbers(folder, scans, folder_by_stamps):
    """The same files under numbers, with times.txt, and poses in CSV."""
    folder.mkdir(parents=True)
    rows = ["stamp,x,y,z,qx,qy,qz,qw\n"]
    for number, scan in enumerate(scans):
        os.link(folder_by_stamps / f"{seconds(scan.stamp_ns)}.pcd", folder / f"{number:06d}.pcd")
        numbers = [*scan.T_map_lidar[:3, 3], *quaternion(scan.T_map_lidar[:3, :3])]
        rows.append(seconds(scan.stamp_ns) + "".join(f",{value:.17g}" for value in numbers) + "\n")
    (folder / "times.txt").write_text("".join(seconds(scan.stamp_ns) + "\n" for scan in scans))
    (folder / "poses.csv").write_text("".join(rows))


def _ply_header(form, layout, count):
    properties = "".join(f"property {PLY_TYPES[layout[name].str]} {name}\n" for name in layout.names)
    return f"ply\nformat {form} 1.0\ncomment a LiDAR scan\nelement vertex {count}\n{properties}end_header\n"


def write_ply(path, points):
    cloud = in_layout(points, PLY_POINT)
    path.write_bytes(_ply_header("binary_little_endian", PLY_POINT, len(cloud)).encode() + cloud.tobytes())


def write_ascii_ply(path, points):
    rows = "".join(f"{x:.9g} {y:.9g} {z:.9g} {intensity:.9g} {ring} {t}\n" for x, y, z, intensity, ring, t in points)
    path.write_text(_ply_header("ascii", POINT, len(points)) + rows)


def write_ply_folder(folder, scans, write_scan):
    """times.txt, and poses in KITTI format, which without a camera are the LiDAR's."""
    folder.mkdir(parents=True)
    for number, scan in enumerate(scans):
        write_scan(folder / f"{number:06d}.ply", scan.points)
    (folder / "times.txt").write_text("".join(seconds(scan.stamp_ns) + "\n" for scan in scans))
    (folder / "poses.txt").write_text("".join(matrix_line(scan.T_map_lidar) + "\n" for scan in scans))
