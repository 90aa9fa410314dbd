#include "io/mcap_records.h"

#include <zlib.h>

#include <algorithm>

#include "io/decompression.h"

namespace saw_ndt::internal {

namespace {

MessageEncoding encodingOf(const std::string& name) {
  if (name == "cdr") return MessageEncoding::CDR;
  return name == "ros1" ? MessageEncoding::ROS1 : MessageEncoding::OTHER;
}

McapChunk::Compression compressionOf(const std::string& name) {
  if (name.empty()) return McapChunk::Compression::NONE;
  if (name == "lz4") return McapChunk::Compression::LZ4;
  return name == "zstd" ? McapChunk::Compression::ZSTD : McapChunk::Compression::UNKNOWN;
}

}  // namespace

void McapChannels::add(McapKind kind, ByteView content) {
  ByteReader reader(content);
  if (kind == McapKind::SCHEMA) {
    const auto number = reader.read<std::uint16_t>();
    types[number] = reader.readString();
  } else if (kind == McapKind::CHANNEL) {
    const auto number = reader.read<std::uint16_t>();
    McapChannel channel;
    channel.schema = reader.read<std::uint16_t>();
    channel.topic = reader.readString();
    channel.encoding = encodingOf(reader.readString());
    channels[number] = channel;
  }
}

bool McapChannels::know(std::uint16_t channel) const {
  const auto known = channels.find(channel);
  return known != channels.end() && (known->second.schema == 0 || types.count(known->second.schema) > 0);
}

McapMessageHead readMcapMessageHead(ByteReader& reader) {
  McapMessageHead head;
  head.channel = reader.read<std::uint16_t>();
  reader.read<std::uint32_t>();  // its number within the channel
  head.log_time_ns = reader.read<std::int64_t>();
  reader.read<std::uint64_t>();  // when it was published
  return head;
}

McapChunk readMcapChunkHead(ByteView content, std::uint64_t offset, std::uint64_t size) {
  ByteReader reader(content);
  McapChunk chunk;
  reader.bytes(2 * sizeof(std::uint64_t));  // from when to when
  chunk.unpacked_size = reader.read<std::uint64_t>();
  chunk.crc = reader.read<std::uint32_t>();
  chunk.compression = compressionOf(reader.readString());
  chunk.size = reader.read<std::uint64_t>();
  chunk.records = offset + reader.position();
  const std::uint64_t there = size - reader.position();
  chunk.cut = chunk.size > there;
  chunk.size = std::min(chunk.size, there);
  return chunk;
}

void unpackMcapChunk(const McapChunk& chunk, ByteView packed, std::vector<unsigned char>& bytes) {
  requireUnpackedSize(chunk.unpacked_size);
  try {
    switch (chunk.compression) {
      case McapChunk::Compression::NONE:
        bytes.assign(packed.data, packed.data + packed.size);
        break;
      case McapChunk::Compression::LZ4:
        decompressLz4(packed, chunk.unpacked_size, bytes);
        break;
      case McapChunk::Compression::ZSTD:
        decompressZstd(packed, chunk.unpacked_size, bytes);
        break;
      case McapChunk::Compression::UNKNOWN:
        throw DamagedData("the compression of the chunk is not known");
    }
  } catch (const DamagedData&) {
    if (!chunk.cut || chunk.compression == McapChunk::Compression::UNKNOWN) throw;
  }
  if (chunk.cut) return;
  requireAllUnpacked(bytes.size(), chunk.unpacked_size);
  if (chunk.crc != 0 && crc32_z(0, bytes.data(), bytes.size()) != chunk.crc) {
    throw DamagedData("the chunk is damaged: its checksum is another");
  }
}

}  // namespace saw_ndt::internal
