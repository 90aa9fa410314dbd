"""A simulated drive as every writer of recordings takes it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

PERIOD_NS = 100_000_000
FIRST_STAMP_NS = 1_700_000_000_123_456_789
# Times are multiples of this, so that float32 holds them exactly, too.
TIME_STEP_NS = 16

POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4"), ("ring", "<u2"), ("t", "<u4")])


@dataclass
class Scan:
    """A turn of the LiDAR from its x axis on, counterclockwise."""

    stamp_ns: int  # since 1970, of the start of the turn
    T_map_lidar: np.ndarray  # 4 x 4, at the stamp
    points: np.ndarray  # of POINT, in the order of time; t in ns from the stamp


def seconds(stamp_ns):
    """The stamp in seconds, to the nanosecond."""
    return f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d}"


def quaternion(R):
    """x y z w of a rotation that turns by less than 180 degrees, w positive."""
    w = np.sqrt(1.0 + np.trace(R)) / 2.0
    q = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 4.0 * w * w]) / (4.0 * w)
    return q / np.linalg.norm(q)


def rotation(q):
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def transform(R, t):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def inverse(T):
    return transform(T[:3, :3].T, -T[:3, :3].T @ T[:3, 3])


def between(T_a, T_b, share):
    """The pose at a share of the way from one pose to a near one."""
    q_a, q_b = quaternion(T_a[:3, :3]), quaternion(T_b[:3, :3])
    q = (1.0 - share) * q_a + share * q_b
    return transform(rotation(q / np.linalg.norm(q)), (1.0 - share) * T_a[:3, 3] + share * T_b[:3, 3])


def read_matrices(lines):
    return [transform(m[:, :3], m[:, 3]) for m in (np.array(line.split(), dtype=float).reshape(3, 4) for line in lines)]


def read_drive(folder, elevations_deg):
    """Reads what saw_ndt_simulate -rolling-shutter wrote: the rings of points by their elevations, and their times by
    their azimuths.

    A simulated turn begins and ends behind the LiDAR, and its stamp and pose are those of the middle, where the LiDAR
    looks along its x axis. Drivers put the stamp where a turn begins. A scan here is therefore the second half of one
    turn and the first half of the next one, which one after the other are a turn from x axis to x axis, and stamp and
    pose at its start are exact. Poses are those of the LiDAR relative to the first one.
    """
    folder = Path(folder)
    calibration = [line[3:] for line in (folder / "calib.txt").read_text().splitlines() if line.startswith("Tr:")]
    T_camera_lidar = read_matrices(calibration)[0]
    poses = [inverse(T_camera_lidar) @ T @ T_camera_lidar
             for T in read_matrices((folder / "poses.txt").read_text().splitlines())]
    files = sorted((folder / "velodyne").glob("*.bin"))
    halves = [_halves_of_turn(np.fromfile(file, dtype="<f4").reshape(-1, 4), elevations_deg) for file in files]

    scans = []
    for k in range(len(files) - 1):
        points = np.concatenate([halves[k][1], halves[k + 1][0]])
        points = points[np.lexsort((points["ring"], points["t"]))]
        # Clocks are not even: a few ns more or less, which no measurement can tell.
        stamp_ns = FIRST_STAMP_NS + k * PERIOD_NS + k * 37 % 101
        T = inverse(poses[0]) @ poses[k]
        q = quaternion(T[:3, :3])
        scans.append(Scan(stamp_ns, transform(rotation(q), T[:3, 3]), points))
    return scans


def _halves_of_turn(xyzi, elevations_deg):
    """The points of a turn before and after its middle, t being from the start of the scan that each belongs to."""
    x, y, z, intensity = xyzi.astype(float).T
    points = np.zeros(len(xyzi), dtype=POINT)
    points["x"], points["y"], points["z"], points["intensity"] = xyzi.T

    elevations = np.degrees(np.arctan2(z, np.hypot(x, y)))
    distance = np.abs(elevations[:, None] - np.asarray(elevations_deg)[None, :])
    points["ring"] = np.argmin(distance, axis=1)
    assert np.min(distance, axis=1).max() < 0.1, "a point is of no ring"

    azimuths = np.arctan2(y, x)
    turned = np.where(azimuths < 0.0, azimuths + 2.0 * np.pi, azimuths) / (2.0 * np.pi)
    points["t"] = np.minimum(np.round(turned * PERIOD_NS / TIME_STEP_NS), PERIOD_NS // TIME_STEP_NS) * TIME_STEP_NS
    return points[azimuths < 0.0], points[azimuths >= 0.0]


def pose_track(scans, per_scan):
    """(stamp_ns, T_map_lidar) of a source of poses at another rate than that of the scans, whose stamps are among its
    own."""
    track = []
    for scan, following in zip(scans, scans[1:]):
        step_ns = (following.stamp_ns - scan.stamp_ns) // per_scan
        for i in range(per_scan):
            share = i * step_ns / (following.stamp_ns - scan.stamp_ns)
            T = between(scan.T_map_lidar, following.T_map_lidar, share) if i else scan.T_map_lidar
            track.append((scan.stamp_ns + i * step_ns, T))
    track.append((scans[-1].stamp_ns, scans[-1].T_map_lidar))
    return track
