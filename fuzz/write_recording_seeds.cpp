#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <stdexcept>

#include "io/mcap_bytes.h"
#include "io/message_bytes.h"
#include "io/ros1_bag_bytes.h"
#include "io/velodyne_sensor.h"
#include "recordings/capture_writer.h"
#include "seeds.h"

namespace saw_ndt {
namespace {

using internal::bytesOf;
using internal::MessageEncoding;
using internal::MessageWriter;

constexpr char kCloudType[] = "sensor_msgs/PointCloud2", kOdometryType[] = "nav_msgs/Odometry";

std::string cloud(MessageEncoding encoding, std::uint32_t seconds) {
  internal::CloudForm form;
  form.width = 4;
  form.row_step = 64;
  return internal::cloudMessage(MessageWriter(encoding), form,
                                internal::floatBytes({1, 0, 0, 9, 0, 2, 0, 8, 0, 0, 3, 7, 4, 4, 4, 6}), seconds);
}

std::string odometry(MessageEncoding encoding, std::uint32_t seconds) {
  MessageWriter writer(encoding);
  writer.addHeader(seconds, 0, "map").addString("lidar").addTransform(seconds % 10, 2.0, 3.0);
  for (int i = 0; i < 36; ++i) writer.add(0.0);
  return writer.bytes();
}

std::string transforms(MessageEncoding encoding) {
  MessageWriter writer(encoding);
  writer.add(std::uint32_t{2});
  writer.addHeader(1600000000, 0, "map").addString("base").addTransform(1.0, 2.0, 3.0);
  writer.addHeader(1600000000, 0, "base").addString("lidar").addTransform(0.0, 0.0, 1.7, true);
  return writer.bytes();
}

void writeMessages(const SeedFolder& seeds) {
  for (const MessageEncoding encoding : {MessageEncoding::ROS1, MessageEncoding::CDR}) {
    const int bit = encoding == MessageEncoding::CDR ? 1 : 0;
    const auto add = [&](int kind, const std::string& name, const std::string& message) {
      seeds.add("ros_message", name + std::to_string(bit), static_cast<char>(2 * kind + bit) + message);
    };
    add(0, "cloud", cloud(encoding, 1600000000));
    for (int kind = 1; kind <= 3; ++kind) add(kind, "pose" + std::to_string(kind), odometry(encoding, 1600000000));
    add(4, "transforms", transforms(encoding));
    add(5, "header", odometry(encoding, 1600000000));
  }
}

void writeBags(const SeedFolder& seeds) {
  constexpr std::uint32_t kStart_s = 1600000000;
  internal::Ros1BagWriter ros1({{"/points", kCloudType}, {"/odometry", kOdometryType}});
  std::vector<internal::McapWriter::Message> messages;
  std::vector<internal::Ros1BagWriter::Message> ros1_messages;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint64_t time_ns = (kStart_s + i) * std::uint64_t{1000000000};
    messages.push_back({1, time_ns, cloud(MessageEncoding::CDR, kStart_s + i)});
    messages.push_back({2, time_ns, odometry(MessageEncoding::CDR, kStart_s + i)});
    ros1_messages.push_back({0, kStart_s + i, 0, cloud(MessageEncoding::ROS1, kStart_s + i)});
    ros1_messages.push_back({1, kStart_s + i, 0, odometry(MessageEncoding::ROS1, kStart_s + i)});
  }
  ros1.addChunk(ros1_messages);
  seeds.add("ros1_bag", "indexed", ros1.bytes());
  seeds.add("ros1_bag", "not_indexed", ros1.bytes(false));

  const std::string channels = internal::McapWriter::channel(1, "/points", "sensor_msgs/msg/PointCloud2") +
                               internal::McapWriter::channel(2, "/odometry", "nav_msgs/msg/Odometry");
  internal::McapWriter chunked, plain;
  chunked.addChunk(channels, messages);
  seeds.add("mcap", "chunked", chunked.whole(channels));
  seeds.add("mcap", "without_summary", chunked.withoutSummary());
  plain.addRecords(channels);
  for (const auto& message : messages) plain.addRecords(internal::McapWriter::message(message));
  seeds.add("mcap", "plain", plain.whole(channels));
}

void writeDatabase(const SeedFolder& seeds) {
  const auto path = seeds.fileFor("rosbag2_database", "database");
  std::filesystem::remove(path);
  sqlite3* database = nullptr;
  std::string statements =
      "PRAGMA page_size=512;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
      "INSERT INTO topics VALUES(1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr');"
      "INSERT INTO topics VALUES(2, '/odometry', 'nav_msgs/msg/Odometry', 'cdr');";
  const auto insert = [&](int topic, std::uint32_t seconds, const std::string& data) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string hexadecimal;
    for (const char byte : data) {
      hexadecimal += kDigits[static_cast<unsigned char>(byte) >> 4U];
      hexadecimal += kDigits[static_cast<unsigned char>(byte) & 15U];
    }
    statements += "INSERT INTO messages(topic_id, timestamp, data) VALUES(" + std::to_string(topic) + ", " +
                  std::to_string(seconds) + "000000000, x'" + hexadecimal + "');";
  };
  for (std::uint32_t seconds = 1600000000; seconds < 1600000002; ++seconds) {
    insert(1, seconds, cloud(MessageEncoding::CDR, seconds));
    insert(2, seconds, odometry(MessageEncoding::CDR, seconds));
  }
  const bool written = sqlite3_open(path.c_str(), &database) == SQLITE_OK &&
                       sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
  sqlite3_close(database);
  if (!written) throw std::runtime_error(path.string() + " could not be written");
}

/// A turn in two packets, whose blocks are 15 degrees apart.
std::vector<std::string> fastTurn(VelodynePacket packet, int turns) {
  std::vector<std::string> packets;
  for (int number = 0; number < 2 * turns; ++number) {
    for (std::size_t block = 0; block < 12; ++block) {
      packet.setAzimuth(block, static_cast<unsigned>((static_cast<std::size_t>(number % 2) * 12 + block) * 1500));
      for (std::size_t channel = 0; channel < 32; ++channel) packet.setReturn(block, channel, 4000, 50);
    }
    packet.setTimestamp(static_cast<std::uint32_t>(number) * 50000);
    packets.emplace_back(reinterpret_cast<const char*>(packet.data()), VelodynePacket::size());
  }
  return packets;
}

void writePackets(const SeedFolder& seeds) {
  const std::pair<const char*, VelodynePacket> sensors[] = {{"vlp16", VelodynePacket::ofVlp16()},
                                                            {"hdl32e", VelodynePacket::ofHdl32e()},
                                                            {"hdl64e", VelodynePacket::ofHdl64e()}};
  for (const auto& [name, packet] : sensors) {
    CaptureWriter capture(101), capture_ng(101, CaptureWriter::Format::PCAPNG);  // 101: bare IP
    std::string stream;
    double time_s = 1.6e9;
    for (const std::string& payload : fastTurn(packet, 3)) {
      capture.add(ipPacket(payload), time_s);
      capture_ng.add(ipPacket(payload), time_s);
      time_s += 0.05;
      stream += payload;
    }
    seeds.add("capture", name, capture.content());
    seeds.add("capture", std::string(name) + "_ng", capture_ng.content() + '\1');
    // Lengths and times are taken from the end: zeros, an ordinary length and 0 s.
    seeds.add("velodyne_stream", name, stream + std::string(19, '\0') + '\1');
    seeds.add("udp_payload", name, '\4' + ipPacket(fastTurn(packet, 1).front().substr(0, 40)));
  }
}

void writeCompressed(const SeedFolder& seeds) {
  const std::string text(3000, 'a');
  std::string packed(LZ4F_compressFrameBound(text.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), text.data(), text.size(), nullptr));
  seeds.add("decompression", "lz4", '\0' + packed);
  packed.resize(ZSTD_compressBound(text.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 3));
  seeds.add("decompression", "zstd", '\1' + packed);
  packed.resize(text.size() + 1000);
  auto size = static_cast<unsigned>(packed.size());
  std::string source = text;
  if (BZ2_bzBuffToBuffCompress(packed.data(), &size, source.data(), static_cast<unsigned>(source.size()), 1, 0, 0) !=
      BZ_OK) {
    throw std::runtime_error("bzip2 failed");
  }
  packed.resize(size);
  seeds.add("decompression", "bz2", '\2' + packed);
}

}  // namespace

void writeRecordingSeeds(const SeedFolder& seeds) {
  writeMessages(seeds);
  writeBags(seeds);
  writeDatabase(seeds);
  writePackets(seeds);
  writeCompressed(seeds);
}

}  // namespace saw_ndt
