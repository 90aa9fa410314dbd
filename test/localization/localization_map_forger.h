#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "map/localization_map_layout.h"
#include "map/map_file_bytes.h"

namespace saw_ndt {

using internal::LocalizationMapHeader;
using internal::LocalizationTileRecord;

template <typename Layout>
void putLayout(std::string& bytes, std::size_t offset, const Layout& layout) {
  std::memcpy(bytes.data() + offset, &layout, sizeof layout);
}

/// Changes a file and makes its checksums right again.
class Forger {
 public:
  explicit Forger(std::string bytes) : bytes_(std::move(bytes)) {}

  template <typename Change>
  Forger header(const Change& change) const {
    Forger forged = *this;
    auto header = valueAt<LocalizationMapHeader>(bytes_, 0);
    change(header);
    forged.putHeader(header);
    return forged;
  }

  template <typename Change>
  Forger record(std::size_t number, const Change& change) const {
    Forger forged = *this;
    auto record = recordOf(number);
    change(record);
    forged.putRecord(number, record);
    return forged;
  }

  /// What stands in the place of the cells of a tile, or of its table, may have another size: it is put at the end.
  template <typename Change>
  Forger cells(std::size_t number, const Change& change) const {
    return tile(number, [&](std::string& cells, std::string&) { change(cells); });
  }
  template <typename Change>
  Forger table(std::size_t number, const Change& change) const {
    return tile(number, [&](std::string&, std::string& table) { change(table); });
  }

  /// The same bytes with another directory.
  Forger directory(const std::vector<std::size_t>& numbers) const {
    Forger forged = *this;
    const std::size_t begin = directoryOffset();
    forged.bytes_.resize(begin);
    for (const std::size_t number : numbers) {
      forged.bytes_ += bytes_.substr(begin + number * sizeof(LocalizationTileRecord), sizeof(LocalizationTileRecord));
    }
    auto header = valueAt<LocalizationMapHeader>(bytes_, 0);
    header.tile_count = numbers.size();
    header.file_bytes = forged.bytes_.size();
    forged.putHeader(header);
    return forged;
  }

  std::size_t tileCount() const { return (bytes_.size() - directoryOffset()) / sizeof(LocalizationTileRecord); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::size_t directoryOffset() const {
    return static_cast<std::size_t>(valueAt<LocalizationMapHeader>(bytes_, 0).directory_offset.value());
  }
  LocalizationTileRecord recordOf(std::size_t number) const {
    return valueAt<LocalizationTileRecord>(bytes_, directoryOffset() + number * sizeof(LocalizationTileRecord));
  }
  void putHeader(LocalizationMapHeader header) {
    header.checksum = crc32({reinterpret_cast<const char*>(&header), sizeof header - 4});
    putLayout(bytes_, 0, header);
  }
  void putRecord(std::size_t number, LocalizationTileRecord record) {
    record.checksum = crc32({reinterpret_cast<const char*>(&record), sizeof record - 4});
    putLayout(bytes_, directoryOffset() + number * sizeof(LocalizationTileRecord), record);
  }

  template <typename Change>
  Forger tile(std::size_t number, const Change& change) const {
    auto record = recordOf(number);
    const auto offset = static_cast<std::size_t>(record.offset.value());
    std::string cells = bytes_.substr(offset, record.cell_bytes.value());
    std::string table = bytes_.substr(offset + record.cell_bytes.value(), record.table_bytes.value());
    change(cells, table);
    Forger forged = *this;
    const std::string directory = bytes_.substr(directoryOffset());
    auto header = valueAt<LocalizationMapHeader>(bytes_, 0);
    record.offset = directoryOffset();
    record.cell_bytes = static_cast<std::uint32_t>(cells.size());
    record.cell_checksum = crc32(cells);
    record.table_bytes = static_cast<std::uint32_t>(table.size());
    record.table_checksum = crc32(table);
    forged.bytes_ = bytes_.substr(0, directoryOffset()) + cells + table + directory;
    header.directory_offset = forged.bytes_.size() - directory.size();
    header.file_bytes = forged.bytes_.size();
    forged.putHeader(header);
    forged.putRecord(number, record);
    return forged;
  }

  std::string bytes_;
};

}  // namespace saw_ndt
