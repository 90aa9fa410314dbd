"""Bags of ROS 1, by the rosbag of ROS itself."""

import io

import genpy
import rosbag
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, PointCloud2, PointField
from tf2_msgs.msg import TFMessage

from drive import pose_track, quaternion
from frames import T_BASE_LIDAR, frame_tree
from point_layouts import FRAME, ODD, OUSTER, cloud_bytes, cloud_fields

# From the start of a turn to the message being recorded.
DELAY_NS = 137_000_000
TRACK_DELAY_NS = 3_000_000


def time_of(stamp_ns):
    return genpy.Time(stamp_ns // 10**9, stamp_ns % 10**9)


def cloud_message(stamp_ns, points, layout):
    message = PointCloud2()
    message.header.stamp, message.header.frame_id = time_of(stamp_ns), FRAME
    message.height, message.width = 1, len(points)
    message.fields = [PointField(name, offset, datatype, 1) for name, offset, datatype in cloud_fields(layout)]
    message.point_step, message.row_step = layout.itemsize, layout.itemsize * len(points)
    message.data = cloud_bytes(points, layout)
    message.is_dense = True
    return message


def _set(position, orientation, T):
    position.x, position.y, position.z = T[:3, 3]
    orientation.x, orientation.y, orientation.z, orientation.w = quaternion(T[:3, :3])


def odometry_message(stamp_ns, T_map_lidar):
    message = Odometry()
    message.header.stamp, message.header.frame_id, message.child_frame_id = time_of(stamp_ns), "map", FRAME
    _set(message.pose.pose.position, message.pose.pose.orientation, T_map_lidar)
    return message


def transform_message(stamp_ns, parent, child, T):
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = time_of(stamp_ns), parent, child
    _set(message.transform.translation, message.transform.rotation, T)
    return message


def bytes_of(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def _cloud_writes(scans, layout):
    return [(scan.stamp_ns + DELAY_NS, "/points", lambda scan=scan: cloud_message(scan.stamp_ns, scan.points, layout))
            for scan in scans]


def _write_in_order(path, writes, compression):
    with rosbag.Bag(str(path), "w", compression=compression, chunk_threshold=1 << 20) as bag:
        for recorded_ns, topic, message in sorted(writes, key=lambda write: write[:2]):
            bag.write(topic, message(), t=time_of(recorded_ns))


def write_bag(path, scans, compression):
    """Clouds on /points, poses of the LiDAR on /odometry and, of no use here, /imu. Compression is none, bz2 or lz4;
    where there is none, the points lie oddly."""
    writes = _cloud_writes(scans, ODD if compression == "none" else OUSTER)
    for stamp_ns, T in pose_track(scans, 4):
        writes.append((stamp_ns + TRACK_DELAY_NS, "/odometry", lambda s=stamp_ns, T=T: odometry_message(s, T)))
        writes.append((stamp_ns + 1, "/imu", Imu))
    _write_in_order(path, writes, compression)


def write_tf_bag(path, scans):
    """Clouds on /points, and their poses by /tf and /tf_static alone."""
    writes = _cloud_writes(scans, OUSTER)
    mounting = transform_message(scans[0].stamp_ns, "base_link", FRAME, T_BASE_LIDAR)
    writes.append((scans[0].stamp_ns, "/tf_static", lambda: TFMessage([mounting])))
    for stamp_ns, T_map_odom, T_odom_base in frame_tree(scans, 4):
        pair = [transform_message(stamp_ns, "map", "odom", T_map_odom),
                transform_message(stamp_ns, "odom", "base_link", T_odom_base)]
        writes.append((stamp_ns + TRACK_DELAY_NS, "/tf", lambda pair=pair: TFMessage(pair)))
    _write_in_order(path, writes, "lz4")


def write_raw_bag(path, messages):
    """Messages that are bytes already: (stamp_ns, topic, type, bytes), type being a class of messages."""
    with rosbag.Bag(str(path), "w", compression="none", chunk_threshold=1 << 20) as bag:
        for stamp_ns, topic, kind, data in messages:
            bag.write(topic, (kind._type, data, kind._md5sum, kind), t=time_of(stamp_ns), raw=True)
