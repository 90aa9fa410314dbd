// Writes the drive of write_recordings.py as MCAP bags of ROS 2, by the libraries of MCAP's and ROS's own tools:
//   node write_mcap.mjs RECORDINGS
import rosmsg from "@foxglove/rosmsg";
import definitions from "@foxglove/rosmsg-msgs-common";
import serialization from "@foxglove/rosmsg2-serialization";
import zstd from "@foxglove/wasm-zstd";
import { McapWriter } from "@mcap/core";
import lz4 from "lz4js";
import { mkdirSync, openSync, closeSync, readFileSync, readdirSync, rmSync, writeSync } from "node:fs";
import { join } from "node:path";

const kFrame = "os_lidar";
const kCloud = "sensor_msgs/PointCloud2";
const kOdometry = "nav_msgs/Odometry";
const kText = "std_msgs/String";
// From the start of a turn to the message being recorded.
const kDelayNs = 137_000_000n;
const kTrackDelayNs = 3_000_000n;

// How points lie in memory: Ouster's driver pads them, the others are packed.
const kUint16 = 4, kUint32 = 6, kFloat32 = 7;
const kOuster = { step: 48, fields: { x: [0, kFloat32], y: [4, kFloat32], z: [8, kFloat32], intensity: [16, kFloat32],
                                      t: [20, kUint32], reflectivity: [24, kUint16], ring: [26, kUint16] } };
const kPacked = { step: 22, fields: { x: [0, kFloat32], y: [4, kFloat32], z: [8, kFloat32], intensity: [12, kFloat32],
                                      ring: [16, kUint16], t: [18, kUint32] } };

// What write_recordings.py has in its .bin files, one float32 each.
const kColumns = ["x", "y", "z", "intensity", "ring", "t"];

const timeOf = (stampNs) => ({ sec: Number(stampNs / 1_000_000_000n), nanosec: Number(stampNs % 1_000_000_000n) });
const stampOf = (seconds) => BigInt(seconds.replace(".", ""));  // nine decimals
const linesOf = (path) => readFileSync(path, "utf8").split("\n").filter((line) => line !== "");

function cloudBytes(columns, layout) {
  const count = columns.length / kColumns.length;
  const bytes = new Uint8Array(count * layout.step);
  const view = new DataView(bytes.buffer);
  kColumns.forEach((name, column) => {
    const [offset, datatype] = layout.fields[name];
    for (let i = 0; i < count; ++i) {
      const value = columns[i * kColumns.length + column];
      const at = i * layout.step + offset;
      if (datatype === kFloat32) view.setFloat32(at, value, true);
      if (datatype === kUint32) view.setUint32(at, value, true);
      if (datatype === kUint16) view.setUint16(at, value, true);
    }
  });
  return bytes;
}

function cloudMessage(scan, layout) {
  const data = cloudBytes(scan.columns, layout);
  const fields = Object.entries(layout.fields)
    .map(([name, [offset, datatype]]) => ({ name, offset, datatype, count: 1 }));
  return { header: { stamp: timeOf(scan.stampNs), frame_id: kFrame }, height: 1, width: data.length / layout.step,
           fields, is_bigendian: false, point_step: layout.step, row_step: data.length, data, is_dense: true };
}

function odometryMessage({ stampNs, numbers: [x, y, z, qx, qy, qz, qw] }) {
  const zero = { x: 0, y: 0, z: 0 };
  const covariance = new Float64Array(36);
  return { header: { stamp: timeOf(stampNs), frame_id: "map" }, child_frame_id: kFrame,
           pose: { pose: { position: { x, y, z }, orientation: { x: qx, y: qy, z: qz, w: qw } }, covariance },
           twist: { twist: { linear: zero, angular: zero }, covariance } };
}

// A message type as ROS has it: its text with those of all that it uses, and what turns messages into bytes.
function typeOf(name) {
  const own = definitions.ros2humble;
  const found = new Map([[name, own[name]]]);
  for (const definition of found.values()) {
    for (const field of definition.definitions) {
      if (field.isComplex) found.set(field.type, own[field.type]);
    }
  }
  const ruler = "=".repeat(80);
  const text = [...found].map(([type, definition], i) => {
    const own_text = rosmsg.stringify([definition]);
    return i === 0 ? own_text : `${ruler}\nMSG: ${type}\n${own_text}`;
  }).join("\n");
  const writer = new serialization.MessageWriter(rosmsg.parse(text, { ros2: true }));
  return { name: name.replace("/", "/msg/"), text, writer };
}

function compression(kind) {
  if (kind === "zstd") return (data) => ({ compression: "zstd", compressedData: zstd.compress(data, 3) });
  if (kind === "lz4") return (data) => ({ compression: "lz4", compressedData: lz4.compress(data) });
  return undefined;
}

// Writes messages {topic, type, recordedNs, bytes} in their order.
async function writeBag(path, messages, options) {
  const file = openSync(path, "w");
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => { writeSync(file, bytes); position += BigInt(bytes.length); },
  };
  const writer = new McapWriter({ writable, ...options });
  await writer.start({ profile: "ros2", library: "write_mcap.mjs" });
  const channels = new Map();
  let sequence = 0;
  for (const { topic, type, recordedNs, bytes } of messages) {
    if (!channels.has(topic)) {
      const schemaId = await writer.registerSchema(
        { name: type.name, encoding: "ros2msg", data: new TextEncoder().encode(type.text) });
      channels.set(topic, await writer.registerChannel(
        { topic, schemaId, messageEncoding: "cdr", metadata: new Map([["offered_qos_profiles", ""]]) }));
    }
    await writer.addMessage({ channelId: channels.get(topic), sequence: sequence++, logTime: recordedNs,
                              publishTime: recordedNs, data: bytes });
  }
  await writer.end();
  closeSync(file);
}

function readScans(folder) {
  const files = readdirSync(join(folder, "velodyne")).sort();
  const stamps = linesOf(join(folder, "times.txt"));
  return files.map((name, i) => {
    const bytes = readFileSync(join(folder, "velodyne", name));
    const columns = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
    return { stampNs: stampOf(stamps[i]), columns };
  });
}

function readTrack(path) {
  return linesOf(path).map((line) => {
    const [stamp, ...numbers] = line.split(" ");
    return { stampNs: BigInt(stamp), numbers: numbers.map(Number) };
  });
}

function* damagedMessages(path, cloud, text) {
  const bytes = readFileSync(path);
  for (let at = 0; at < bytes.length;) {
    const recordedNs = bytes.readBigUInt64LE(at);
    const isCloud = bytes.readUInt32LE(at + 8) === 1;
    const size = bytes.readUInt32LE(at + 12);
    at += 16 + size;
    yield { topic: isCloud ? "/points" : "/status", type: isCloud ? cloud : text, recordedNs,
            bytes: bytes.subarray(at - size, at) };
  }
}

const recordings = process.argv[2];
const folder = join(recordings, "mcap");
mkdirSync(folder, { recursive: true });
await zstd.isLoaded;
const cloud = typeOf(kCloud), odometry = typeOf(kOdometry), text = typeOf(kText);
const scans = readScans(join(recordings, "kitti"));
const poses = readTrack(join(recordings, "track.txt")).map((pose) => ({
  topic: "/odometry", type: odometry, recordedNs: pose.stampNs + kTrackDelayNs,
  bytes: odometry.writer.writeMessage(odometryMessage(pose)) }));
const messagesOf = (layout) => scans.map((scan) => ({
  topic: "/points", type: cloud, recordedNs: scan.stampNs + kDelayNs,
  bytes: cloud.writer.writeMessage(cloudMessage(scan, layout)) }))
  .concat(poses).sort((a, b) => Number(a.recordedNs - b.recordedNs));

const padded = messagesOf(kOuster), packed = messagesOf(kPacked);
const chunks = { chunkSize: 2 << 20 };
await writeBag(join(folder, "zstd.mcap"), padded, { ...chunks, compressChunk: compression("zstd") });
await writeBag(join(folder, "lz4.mcap"), packed, { ...chunks, compressChunk: compression("lz4") });
await writeBag(join(folder, "none.mcap"), packed, chunks);
await writeBag(join(folder, "no_chunks.mcap"), packed, { useChunks: false });
const damaged = join(recordings, "damaged", "damaged.messages");
await writeBag(join(recordings, "damaged", "damaged.mcap"), damagedMessages(damaged, cloud, text), chunks);
rmSync(damaged);
