#include "map/map_file.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "common/atomic_output.h"
#include "map/crc32.h"
#include "map/map_tile.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

constexpr char kMagic[9] = "SAWNDTM\n";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 96;
constexpr std::size_t kReservedBytes = 24;
constexpr std::size_t kTileRecordBytes = 40;
constexpr std::size_t kEntryBytes = 84;
constexpr std::uint32_t kLabelledFlag = 1;

class Encoder {
 public:
  template <typename Integer>
  void put(Integer value) {
    using Unsigned = std::make_unsigned_t<Integer>;
    const auto bits = static_cast<std::uint64_t>(static_cast<Unsigned>(value));
    char bytes[sizeof(Integer)];
    for (std::size_t i = 0; i < sizeof(Integer); ++i) bytes[i] = static_cast<char>(bits >> (8 * i));
    put(bytes, sizeof bytes);
  }
  void put(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    put(bits);
  }
  void put(const char* bytes, std::size_t size) { bytes_.insert(bytes_.end(), bytes, bytes + size); }
  void putZeros(std::size_t count) { bytes_.insert(bytes_.end(), count, '\0'); }

  const std::vector<char>& bytes() const { return bytes_; }
  std::uint32_t checksum() const { return crc32(bytes_.data(), bytes_.size()); }

 private:
  std::vector<char> bytes_;
};

class Decoder {
 public:
  explicit Decoder(const char* bytes) : at_(reinterpret_cast<const unsigned char*>(bytes)) {}

  template <typename Integer>
  Integer take() {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) bits |= static_cast<std::uint64_t>(*at_++) << (8 * i);
    return static_cast<Integer>(bits);
  }
  double takeDouble() {
    const auto bits = take<std::uint64_t>();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  void skip(std::size_t count) { at_ += count; }

 private:
  const unsigned char* at_;
};

struct Tile {
  Eigen::Vector3i coordinate;
  std::uint32_t checksum = 0;
  std::uint64_t entry_count = 0;
  std::uint64_t offset = 0;
};

struct Header {
  MapOrigin origin;
  std::uint64_t entry_count = 0;
  std::uint64_t tile_count = 0;
  std::uint32_t directory_checksum = 0;
};

void encodeEntry(const LabelledVoxelSums& entry, Encoder& encoder) {
  const Eigen::Vector3i local = entry.voxel - kTileSize * tileOf(entry.voxel);
  for (const int axis : {0, 1, 2}) encoder.put(static_cast<std::uint8_t>(local[axis]));
  encoder.put(static_cast<std::uint8_t>(entry.label));
  encoder.put(entry.sums.count);
  for (const std::int64_t value : entry.sums.sum) encoder.put(value);
  for (const std::int64_t value : entry.sums.product) encoder.put(value);
}

// Reads a file piece by piece; every failure names the file, the offset and the reason.
class MapReader {
 public:
  explicit MapReader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) throw Error(path, "", "is a folder, not a map file");
    if (!stream_) throw Error(path, "", std::string("cannot be opened: ") + std::strerror(errno));
    size_ = std::filesystem::file_size(path, error);
    if (error) throw Error(path, "", error.message());
  }

  std::uint64_t size() const { return size_; }

  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason) const {
    throw Error(path_, "offset " + std::to_string(offset), reason);
  }

  void read(std::uint64_t offset, std::size_t count, std::vector<char>& bytes) {
    if (offset > size_ || count > size_ - offset) {
      fail(size_, "truncated: " + std::to_string(offset + count) + " bytes expected");
    }
    bytes.resize(count);
    stream_.seekg(static_cast<std::streamoff>(offset));
    if (!stream_.read(bytes.data(), static_cast<std::streamsize>(count))) fail(offset, "cannot be read");
  }

 private:
  std::string path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

Header readHeader(MapReader& reader) {
  std::vector<char> bytes;
  const std::size_t magic_size = sizeof kMagic - 1;
  if (reader.size() < magic_size) reader.fail(0, "not a saw_ndt map: too short");
  reader.read(0, magic_size, bytes);
  if (std::memcmp(bytes.data(), kMagic, magic_size) != 0) reader.fail(0, "not a saw_ndt map");
  reader.read(magic_size, 4, bytes);
  const auto version = Decoder(bytes.data()).take<std::uint32_t>();
  if (version != kVersion) {
    reader.fail(magic_size,
                "map version " + std::to_string(version) + ", this program reads version " + std::to_string(kVersion));
  }
  reader.read(0, kHeaderBytes, bytes);
  Decoder decoder(bytes.data() + magic_size + 4);
  Header header;
  const auto header_bytes = decoder.take<std::uint32_t>();
  header.origin.resolution_m = decoder.takeDouble();
  const auto tile_size = decoder.take<std::uint32_t>();
  const auto flags = decoder.take<std::uint32_t>();
  header.origin.labelled = (flags & kLabelledFlag) != 0;
  header.origin.scan_count = decoder.take<std::uint64_t>();
  header.origin.point_count = decoder.take<std::uint64_t>();
  header.entry_count = decoder.take<std::uint64_t>();
  header.tile_count = decoder.take<std::uint64_t>();
  header.directory_checksum = decoder.take<std::uint32_t>();
  decoder.skip(kReservedBytes);
  if (decoder.take<std::uint32_t>() != crc32(bytes.data(), kHeaderBytes - 4)) {
    reader.fail(kHeaderBytes - 4, "damaged: the header's checksum does not match");
  }
  if (header_bytes != kHeaderBytes || tile_size != kTileSize || flags > kLabelledFlag) {
    reader.fail(12, "damaged: the header states an unknown layout");
  }
  if (!(header.origin.resolution_m > 0.0) || !std::isfinite(header.origin.resolution_m)) {
    reader.fail(16, "damaged: the resolution is not a positive number");
  }
  const std::uint64_t body = reader.size() - kHeaderBytes;
  if (header.tile_count > body / kTileRecordBytes || header.entry_count > body / kEntryBytes ||
      header.tile_count * kTileRecordBytes + header.entry_count * kEntryBytes != body) {
    reader.fail(reader.size(), "truncated or damaged: " + std::to_string(header.tile_count) + " tiles and " +
                                   std::to_string(header.entry_count) + " entries do not make this size");
  }
  return header;
}

std::vector<Tile> readDirectory(MapReader& reader, const Header& header) {
  std::vector<char> bytes;
  reader.read(kHeaderBytes, header.tile_count * kTileRecordBytes, bytes);
  if (crc32(bytes.data(), bytes.size()) != header.directory_checksum) {
    reader.fail(kHeaderBytes, "damaged: the directory's checksum does not match");
  }
  std::vector<Tile> tiles(header.tile_count);
  Decoder decoder(bytes.data());
  std::uint64_t offset = kHeaderBytes + bytes.size();
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    Tile& tile = tiles[i];
    for (const int axis : {0, 1, 2}) tile.coordinate[axis] = decoder.take<std::int32_t>();
    tile.checksum = decoder.take<std::uint32_t>();
    tile.entry_count = decoder.take<std::uint64_t>();
    tile.offset = decoder.take<std::uint64_t>();
    decoder.skip(8);
    const std::uint64_t record = kHeaderBytes + i * kTileRecordBytes;
    constexpr int kLimit = 1 << (31 - kTileBits);
    if ((tile.coordinate.array() < -kLimit).any() || (tile.coordinate.array() >= kLimit).any()) {
      reader.fail(record, "damaged: a tile lies outside the coordinates that a map can hold");
    }
    if (tile.offset != offset || tile.entry_count > (reader.size() - offset) / kEntryBytes) {
      reader.fail(record, "damaged: a tile does not follow the one before it");
    }
    offset += tile.entry_count * kEntryBytes;
  }
  return tiles;
}

// Whether points of a voxel can have these sums: none lies further than half a voxel from its centre. Keeps a file that
// was made to mislead from overflowing what is computed with them.
bool canBeSums(const VoxelSums& sums) {
  constexpr std::uint64_t kHalf = kStepsPerVoxel / 2;
  constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 33;
  if (sums.count == 0 || sums.count > kMostPoints) return false;
  const auto within = [](std::int64_t value, std::uint64_t limit) {
    const auto bits = static_cast<std::uint64_t>(value);
    return (value < 0 ? std::uint64_t{0} - bits : bits) <= limit;
  };
  for (const std::int64_t value : sums.sum) {
    if (!within(value, sums.count * kHalf)) return false;
  }
  for (const std::int64_t value : sums.product) {
    if (!within(value, sums.count * kHalf * kHalf)) return false;
  }
  return true;
}

void readTile(MapReader& reader, const Tile& tile, MapFileContent& content) {
  std::vector<char> bytes;
  reader.read(tile.offset, tile.entry_count * kEntryBytes, bytes);
  if (crc32(bytes.data(), bytes.size()) != tile.checksum) {
    reader.fail(tile.offset, "damaged: the checksum of a tile does not match");
  }
  Decoder decoder(bytes.data());
  for (std::uint64_t i = 0; i < tile.entry_count; ++i) {
    LabelledVoxelSums entry;
    bool valid = true;
    for (const int axis : {0, 1, 2}) {
      const int local = decoder.take<std::uint8_t>();
      valid = valid && local < kTileSize;
      entry.voxel[axis] = tile.coordinate[axis] * kTileSize + local;
    }
    const auto label = decoder.take<std::uint8_t>();
    valid = valid && label < kStructuralLabelCount;
    entry.label = static_cast<StructuralLabel>(label);
    entry.sums.count = decoder.take<std::uint64_t>();
    for (std::int64_t& value : entry.sums.sum) value = decoder.take<std::int64_t>();
    for (std::int64_t& value : entry.sums.product) value = decoder.take<std::int64_t>();
    valid = valid && canBeSums(entry.sums) && entry.sums.count <= content.origin.point_count;
    if (!valid || (!content.entries.empty() && !inMapOrder(content.entries.back(), entry))) {
      reader.fail(tile.offset + i * kEntryBytes, "damaged: an entry is out of range or out of order");
    }
    content.entries.push_back(entry);
  }
}

}  // namespace

void writeMapFile(const std::string& path, const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries) {
  struct EncodedTile {
    Tile tile;
    Encoder entries;
  };
  std::vector<EncodedTile> tiles;
  for (const LabelledVoxelSums& entry : entries) {
    const Eigen::Vector3i coordinate = tileOf(entry.voxel);
    if (tiles.empty() || tiles.back().tile.coordinate != coordinate) {
      tiles.emplace_back();
      tiles.back().tile.coordinate = coordinate;
    }
    encodeEntry(entry, tiles.back().entries);
    ++tiles.back().tile.entry_count;
  }

  Encoder directory;
  std::uint64_t offset = kHeaderBytes + tiles.size() * kTileRecordBytes;
  for (const EncodedTile& encoded : tiles) {
    for (const int axis : {0, 1, 2}) directory.put(encoded.tile.coordinate[axis]);
    directory.put(encoded.entries.checksum());
    directory.put(encoded.tile.entry_count);
    directory.put(offset);
    directory.putZeros(8);
    offset += encoded.entries.bytes().size();
  }

  Encoder header;
  header.put(kMagic, sizeof kMagic - 1);
  header.put(kVersion);
  header.put(static_cast<std::uint32_t>(kHeaderBytes));
  header.put(origin.resolution_m);
  header.put(static_cast<std::uint32_t>(kTileSize));
  header.put(origin.labelled ? kLabelledFlag : std::uint32_t{0});
  header.put(origin.scan_count);
  header.put(origin.point_count);
  header.put(static_cast<std::uint64_t>(entries.size()));
  header.put(static_cast<std::uint64_t>(tiles.size()));
  header.put(directory.checksum());
  header.putZeros(kReservedBytes);
  header.put(header.checksum());

  AtomicOutput output(path);
  const auto write = [&output](const Encoder& encoder) {
    output.stream().write(encoder.bytes().data(), static_cast<std::streamsize>(encoder.bytes().size()));
  };
  write(header);
  write(directory);
  for (const EncodedTile& encoded : tiles) write(encoded.entries);
  output.commit();
}

MapFileContent readMapFile(const std::string& path) {
  MapReader reader(path);
  const Header header = readHeader(reader);
  MapFileContent content;
  content.origin = header.origin;
  const std::vector<Tile> tiles = readDirectory(reader, header);
  content.entries.reserve(header.entry_count);
  for (const Tile& tile : tiles) readTile(reader, tile, content);
  if (content.entries.size() != header.entry_count) {
    reader.fail(kHeaderBytes, "damaged: the directory and the header disagree on the number of entries");
  }
  std::uint64_t point_count = 0;
  for (const LabelledVoxelSums& entry : content.entries) point_count += entry.sums.count;
  if (point_count != content.origin.point_count) {
    reader.fail(kHeaderBytes, "damaged: the entries and the header disagree on the number of points");
  }
  return content;
}

}  // namespace saw_ndt
