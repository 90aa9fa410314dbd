#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "io/pcd_header.h"

namespace saw_ndt::internal {

/// A field of a cloud in memory and where its values lie.
struct PcdColumn {
  PcdField field;
  std::size_t offset = 0;        ///< of the first point's first value in PcdCloud::bytes
  std::size_t stride_bytes = 0;  ///< from one point's first value to the next one's
};

/// The points of a PCD file with all fields, as the file has them.
struct PcdCloud {
  std::size_t points = 0, width = 0, height = 1;  ///< width times height is points
  std::array<float, 7> viewpoint = PcdHeader().viewpoint;
  std::vector<PcdColumn> columns;
  std::vector<unsigned char> bytes;

  /// The first column of one of these names, the first name first, whatever the case of letters; null where none is.
  const PcdColumn* find(const std::vector<std::string_view>& names) const;

  /// Calls take(point, number) with the first value of every point, as a double.
  template <typename Take>
  void forEach(const PcdColumn& column, Take take) const {
    const char type = column.field.type;
    switch (column.field.size) {
      case 1:
        return type == 'U' ? forEachOf<std::uint8_t>(column, take) : forEachOf<std::int8_t>(column, take);
      case 2:
        return type == 'U' ? forEachOf<std::uint16_t>(column, take) : forEachOf<std::int16_t>(column, take);
      case 4:
        if (type == 'F') return forEachOf<float>(column, take);
        return type == 'U' ? forEachOf<std::uint32_t>(column, take) : forEachOf<std::int32_t>(column, take);
      default:
        if (type == 'F') return forEachOf<double>(column, take);
        return type == 'U' ? forEachOf<std::uint64_t>(column, take) : forEachOf<std::int64_t>(column, take);
    }
  }

  /// Adds a field of one value a point, instead of those of the same name.
  template <typename Number>
  void set(const std::string& name, char type, const std::vector<Number>& values) {
    remove(name);
    columns.push_back({{name, sizeof(Number), type, 1}, bytes.size(), sizeof(Number)});
    const auto* first = reinterpret_cast<const unsigned char*>(values.data());
    bytes.insert(bytes.end(), first, first + values.size() * sizeof(Number));
  }
  /// Takes the fields of a name away.
  void remove(const std::string& name);

 private:
  template <typename Number, typename Take>
  void forEachOf(const PcdColumn& column, Take& take) const {
    if (points == 0) return;  // and no bytes perhaps
    const unsigned char* at = bytes.data() + column.offset;
    for (std::size_t point = 0; point < points; ++point, at += column.stride_bytes) {
      Number number;
      std::memcpy(&number, at, sizeof(Number));  // fields lie at any address
      take(point, static_cast<double>(number));
    }
  }
};

/// The fields that a head announces and where their values will lie, before bytes are read.
PcdCloud cloudWithoutBytes(const PcdHeader& header);
/// Bytes from where a stream stands. Throws Error where there are fewer.
std::vector<unsigned char> readCloudBytes(const std::filesystem::path& path, std::istream& stream, std::uint64_t size);

/// Reads a PCD file. Throws Error that names the line or the offset.
PcdCloud readPcdCloud(const std::filesystem::path& path);

/// The points that lie one after the other, ASCII or binary, from where a stream stands. Throws Error as above.
PcdCloud cloudOfRows(const std::filesystem::path& path, const PcdHeader& header, std::istream& stream);

/// Writes a compressed binary PCD file without padding (fields named `_`), whole or not at all. Throws Error, also for
/// a cloud without points, which the format cannot hold.
void writePcdCloud(const std::filesystem::path& path, const PcdCloud& cloud);

}  // namespace saw_ndt::internal
