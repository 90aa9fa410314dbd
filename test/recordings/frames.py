"""The poses of a drive as a tree of frames: map -> odom -> base_link -> LiDAR."""

import numpy as np

from drive import inverse, pose_track, rotation, transform

# The LiDAR looks to the left of the vehicle.
T_BASE_LIDAR = transform(rotation(np.array([0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)])), [1.25, 0.5, 1.75])


def map_of_odometry(share):
    """T_map_odom, which a localizer changes a little during the drive."""
    half = 0.5 * (0.3 + 0.02 * share)
    return transform(rotation(np.array([0.0, 0.0, np.sin(half), np.cos(half)])), [5.0 + 0.1 * share, -3.0, 0.25])


def frame_tree(scans, per_scan):
    """(stamp_ns, T_map_odom, T_odom_base) by growing stamps, those of the scans among them."""
    track = pose_track(scans, per_scan)
    tree = []
    for i, (stamp_ns, T_map_lidar) in enumerate(track):
        T_map_odom = map_of_odometry(i / len(track))
        tree.append((stamp_ns, T_map_odom, inverse(T_map_odom) @ T_map_lidar @ inverse(T_BASE_LIDAR)))
    return tree
