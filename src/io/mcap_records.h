#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "io/byte_reader.h"
#include "io/message_file.h"

namespace saw_ndt::internal {

/// The kinds of records of an .mcap file that tell where messages lie.
enum class McapKind : std::uint8_t {
  FOOTER = 2,
  SCHEMA = 3,
  CHANNEL = 4,
  MESSAGE = 5,
  CHUNK = 6,
  MESSAGE_INDEX = 7,
  CHUNK_INDEX = 8,
};

constexpr std::uint64_t kMcapMagicBytes = 8;
constexpr std::uint64_t kMcapHeadBytes = 9;  ///< in front of every record: its kind and length
constexpr std::uint64_t kMcapFooterBytes = 20;
constexpr std::uint64_t kMcapMessageHeadBytes = 22;  ///< in front of the data within a message's record
constexpr std::uint64_t kMcapIndexHeadBytes = 6;     ///< in front of the entries within an index
constexpr std::uint64_t kMcapIndexEntryBytes = 16;
constexpr std::uint64_t kMcapGreatestChunkHead = 128;  ///< in front of the records within a chunk

/// What a channel says of its messages.
struct McapChannel {
  std::uint16_t schema = 0;  ///< 0: none
  std::string topic;
  MessageEncoding encoding = MessageEncoding::OTHER;
};

/// The schemas and channels of a file by their numbers.
struct McapChannels {
  std::map<std::uint16_t, std::string> types;  ///< by the number of the schema
  std::map<std::uint16_t, McapChannel> channels;

  /// Takes the content of a record, what is neither schema nor channel is left out. Throws DamagedData.
  void add(McapKind kind, ByteView content);
  /// Whether a channel and its type are known.
  bool know(std::uint16_t channel) const;
};

/// The head of a message's record.
struct McapMessageHead {
  std::uint16_t channel = 0;
  std::int64_t log_time_ns = 0;
};
/// Throws DamagedData.
McapMessageHead readMcapMessageHead(ByteReader& reader);

/// A chunk of an .mcap file.
struct McapChunk {
  enum class Compression { NONE, LZ4, ZSTD, UNKNOWN };
  Compression compression = Compression::UNKNOWN;
  std::uint64_t unpacked_size = 0;
  std::uint32_t crc = 0;      ///< of the unpacked bytes; 0: not known
  std::uint64_t records = 0;  ///< offset in the file
  std::uint64_t size = 0;     ///< of the records, as they are in the file
  bool cut = false;           ///< the file ends within them
};
/// Reads the head of the content of a chunk.
/// @param content  its first bytes
/// @param offset   where it lies
/// @param size     all bytes of it that are in the file
McapChunk readMcapChunkHead(ByteView content, std::uint64_t offset, std::uint64_t size);

/// Unpacks a chunk, whose bytes in the file are `packed`, and checks it; one that is cut as far as it can be. Throws
/// DamagedData.
void unpackMcapChunk(const McapChunk& chunk, ByteView packed, std::vector<unsigned char>& bytes);

/// Calls take(kind, content, offset) with every record within a chunk. Throws DamagedData behind the last one where
/// there is more.
template <typename Take>
void forEachMcapRecord(ByteView records, Take take) {
  ByteReader reader(records);
  while (reader.remaining() > 0) {
    const std::size_t offset = reader.position();
    const auto kind = static_cast<McapKind>(reader.read<std::uint8_t>());
    take(kind, reader.bytes(reader.read<std::uint64_t>()), offset);
  }
}

}  // namespace saw_ndt::internal
