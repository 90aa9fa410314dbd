"""Bags of ROS 2 in SQLite, as rosbag2_storage_sqlite3 makes them."""

import sqlite3

from cdr import point_cloud, pose_stamped, tf_message
from drive import pose_track
from frames import T_BASE_LIDAR, frame_tree
from point_layouts import FRAME, PACKED

CLOUD, POSE, TF, TEXT = ("sensor_msgs/msg/PointCloud2", "geometry_msgs/msg/PoseStamped", "tf2_msgs/msg/TFMessage",
                         "std_msgs/msg/String")
DELAY_NS = 137_000_000
TRACK_DELAY_NS = 3_000_000

SCHEMA = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT NULL,
                    offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL,data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
INSERT INTO schema(schema_version, ros_distro) VALUES (3, 'humble');
"""


def write_file(path, messages):
    """Messages (recorded_ns, topic, type, bytes) in their order."""
    database = sqlite3.connect(path)
    database.executescript(SCHEMA)
    topics = {}
    for recorded_ns, topic, kind, data in messages:
        if topic not in topics:
            topics[topic] = len(topics) + 1
            database.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", (topics[topic], topic, kind))
        database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                         (topics[topic], recorded_ns, data))
    database.commit()
    database.close()


def metadata_yaml(parts, storage="sqlite3"):
    """metadata.yaml of files and the messages of each."""
    def span(messages):
        first = min(message[0] for message in messages)
        return first, max(message[0] for message in messages) - first

    messages = [message for _, part in parts for message in part]
    first_ns, duration_ns = span(messages)
    lines = ["rosbag2_bagfile_information:", "  version: 5", f"  storage_identifier: {storage}", "  duration:",
             f"    nanoseconds: {duration_ns}", "  starting_time:", f"    nanoseconds_since_epoch: {first_ns}",
             f"  message_count: {len(messages)}", "  topics_with_message_count:"]
    kinds = {topic: kind for _, topic, kind, _ in messages}
    for topic, kind in kinds.items():
        lines += ["    - topic_metadata:", f"        name: {topic}", f"        type: {kind}",
                  "        serialization_format: cdr", "        offered_qos_profiles: \"\"",
                  f"      message_count: {sum(message[1] == topic for message in messages)}"]
    lines += ["  compression_format: \"\"", "  compression_mode: \"\"", "  relative_file_paths:"]
    lines += [f"    - {path}" for path, _ in parts] + ["  files:"]
    for path, part in parts:
        first_ns, duration_ns = span(part)
        lines += [f"    - path: {path}", "      starting_time:", f"        nanoseconds_since_epoch: {first_ns}",
                  "      duration:", f"        nanoseconds: {duration_ns}", f"      message_count: {len(part)}"]
    return "\n".join(lines) + "\n"


def _clouds(scans):
    return [(scan.stamp_ns + DELAY_NS, "/points", CLOUD, point_cloud(scan.stamp_ns, scan.points, PACKED))
            for scan in scans]


def drive_messages(scans):
    """Clouds on /points and poses of the LiDAR on /pose."""
    messages = _clouds(scans)
    messages += [(stamp_ns + TRACK_DELAY_NS, "/pose", POSE, pose_stamped(stamp_ns, T))
                 for stamp_ns, T in pose_track(scans, 4)]
    return sorted(messages, key=lambda message: message[:2])


def tf_messages(scans):
    """Clouds on /points, and their poses by /tf and /tf_static alone."""
    messages = _clouds(scans)
    first_ns = scans[0].stamp_ns
    messages.append((first_ns, "/tf_static", TF, tf_message([(first_ns, "base_link", FRAME, T_BASE_LIDAR)])))
    for stamp_ns, T_map_odom, T_odom_base in frame_tree(scans, 4):
        pair = [(stamp_ns, "map", "odom", T_map_odom), (stamp_ns, "odom", "base_link", T_odom_base)]
        messages.append((stamp_ns + TRACK_DELAY_NS, "/tf", TF, tf_message(pair)))
    return sorted(messages, key=lambda message: message[:2])


def write_bag_folder(folder, messages, files):
    """A folder with metadata.yaml and so many files, into which a recorder has split the bag."""
    folder.mkdir(parents=True)
    ends = [len(messages) * (i + 1) // files for i in range(files)]
    parts = [(f"{folder.name}_{i}.db3", messages[begin:end]) for i, (begin, end) in enumerate(zip([0] + ends, ends))]
    for name, part in parts:
        write_file(folder / name, part)
    (folder / "metadata.yaml").write_text(metadata_yaml(parts))
