"""Drives in the layouts of KITTI odometry and of KITTI raw data."""

import os
from datetime import datetime, timezone

import numpy as np

from drive import inverse, quaternion, seconds, transform

DATE = "2023_11_14"
EARTH_RADIUS_M = 6378137.0

# The camera looks along its z axis, x to the right. Numbers without a rounding: the poses of the LiDAR are those of
# the other recordings to the last bits.
T_CAMERA_LIDAR = transform(np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]), np.zeros(3))


def matrix_line(T):
    return " ".join(f"{value:.17g}" for value in T[:3, :].ravel())


def write_bin(path, points):
    """x y z intensity ring t, all float32, t in ns."""
    np.stack([points[name].astype("<f4") for name in ("x", "y", "z", "intensity", "ring", "t")], axis=1).tofile(path)


def write_kitti_odometry(folder, scans):
    (folder / "velodyne").mkdir(parents=True)
    for number, scan in enumerate(scans):
        write_bin(folder / "velodyne" / f"{number:06d}.bin", scan.points)
    (folder / "times.txt").write_text("".join(seconds(scan.stamp_ns) + "\n" for scan in scans))
    cameras = "".join(f"P{i}: 718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0\n" for i in range(4))
    (folder / "calib.txt").write_text(cameras + f"Tr: {matrix_line(T_CAMERA_LIDAR)}\n")
    camera_poses = [T_CAMERA_LIDAR @ scan.T_map_lidar @ inverse(T_CAMERA_LIDAR) for scan in scans]
    (folder / "poses.txt").write_text("".join(matrix_line(T) + "\n" for T in camera_poses))


def raw_date(stamp_ns):
    date = datetime.fromtimestamp(stamp_ns // 10**9, timezone.utc)
    return date.strftime("%Y-%m-%d %H:%M:%S") + f".{stamp_ns % 10**9:09d}\n"


def _rotation_about(axis, angle):
    a, b = [(1, 2), (2, 0), (0, 1)][axis]
    R = np.eye(3)
    R[a, a] = R[b, b] = np.cos(angle)
    R[a, b], R[b, a] = -np.sin(angle), np.sin(angle)
    return R


def _rotation_rpy(roll, pitch, yaw):
    return _rotation_about(2, yaw) @ _rotation_about(1, pitch) @ _rotation_about(0, roll)


def oxts_line(T_world_imu, scale):
    """The 30 columns of a packet, whose pose in the Mercator projection of that scale is the given one."""
    R, (x, y, z) = T_world_imu[:3, :3], T_world_imu[:3, 3]
    lon_deg = np.degrees(x / (scale * EARTH_RADIUS_M))
    lat_deg = np.degrees(2.0 * np.arctan(np.exp(y / (scale * EARTH_RADIUS_M)))) - 90.0
    roll, pitch, yaw = np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(R[2, 0]), np.arctan2(R[1, 0], R[0, 0])
    motion = [0.0] * 17  # velocities, accelerations and turn rates
    accuracy_and_state = [0.05, 0.01, 4, 11, 5, 5, 6]
    numbers = [lat_deg, lon_deg, z, roll, pitch, yaw] + motion + accuracy_and_state
    return " ".join(f"{number:.17g}" for number in numbers) + "\n"


def write_calibration(path, T, with_projection=False):
    R = " ".join(f"{value:.17g}" for value in T[:3, :3].ravel())
    t = " ".join(f"{value:.17g}" for value in T[:3, 3])
    text = f"calib_time: 15-Mar-2012 11:37:16\nR: {R}\nT: {t}\n"
    path.write_text(text + "delta_f: 0 0\ndelta_c: 0 0\n" if with_projection else text)


def write_kitti_raw(folder, scans, odometry_folder):
    """folder/DATE/DATE_drive_0001_sync with the scans of a folder in odometry layout, which are linked."""
    date_folder = folder / DATE
    drive = date_folder / f"{DATE}_drive_0001_sync"
    (drive / "velodyne_points" / "data").mkdir(parents=True)
    (drive / "oxts" / "data").mkdir(parents=True)
    for number in range(len(scans)):
        os.link(odometry_folder / "velodyne" / f"{number:06d}.bin",
                drive / "velodyne_points" / "data" / f"{number:010d}.bin")
    for name, offset_ns in [("timestamps", 0), ("timestamps_start", 0), ("timestamps_end", 100_000_000)]:
        dates = "".join(raw_date(scan.stamp_ns + offset_ns) for scan in scans)
        (drive / "velodyne_points" / f"{name}.txt").write_text(dates)
    (drive / "oxts" / "timestamps.txt").write_text("".join(raw_date(scan.stamp_ns) for scan in scans))

    # Somewhere in Karlsruhe, and mounted as on KITTI's car: numbers like those of its files.
    lat_deg, lon_deg = 49.011212804408, 8.4228850417969
    scale = np.cos(np.radians(lat_deg))
    x = scale * EARTH_RADIUS_M * np.radians(lon_deg)
    y = scale * EARTH_RADIUS_M * np.log(np.tan(np.radians(90.0 + lat_deg) / 2.0))
    T_world_first = transform(_rotation_rpy(0.02, -0.01, 0.7), [x, y, 112.83])
    T_lidar_imu = transform(_rotation_rpy(0.0008, 0.0003, 0.0148), [-0.81, 0.32, -0.8])
    for number, scan in enumerate(scans):
        # The map is the frame of the first scan.
        T_world_imu = T_world_first @ inverse(T_lidar_imu) @ scan.T_map_lidar @ T_lidar_imu
        if number == 0:
            lat = np.degrees(2.0 * np.arctan(np.exp(T_world_imu[1, 3] / (scale * EARTH_RADIUS_M)))) - 90.0
            assert abs(lat - lat_deg) < 1e-12
        (drive / "oxts" / "data" / f"{number:010d}.txt").write_text(oxts_line(T_world_imu, scale))
    write_calibration(date_folder / "calib_imu_to_velo.txt", T_lidar_imu)
    write_calibration(date_folder / "calib_velo_to_cam.txt", T_CAMERA_LIDAR, with_projection=True)
    (date_folder / "calib_cam_to_cam.txt").write_text(
        "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 0.0995\n" + "".join(
            f"S_rect_0{i}: 1242 375\nR_rect_0{i}: 1 0 0 0 1 0 0 0 1\n"
            f"P_rect_0{i}: 718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0\n" for i in range(4)))


def write_tum(path, scans):
    lines = []
    for scan in scans:
        numbers = [*scan.T_map_lidar[:3, 3], *quaternion(scan.T_map_lidar[:3, :3])]
        lines.append(seconds(scan.stamp_ns) + "".join(f" {value:.17g}" for value in numbers) + "\n")
    path.write_text("".join(lines))
