#include "io/pcd_header.h"

#include <algorithm>
#include <sstream>

#include "common/input_file.h"
#include "io/number_lines.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

// LZF, the compression of PCD files, makes at most 264 bytes out of 3.
constexpr std::uint64_t kGreatestExpansion = 264;
constexpr std::size_t kLongestHeaderLine = 65536;
constexpr std::uint64_t kGreatestFieldValue = 1U << 20U;

class HeaderReader {
 public:
  explicit HeaderReader(const std::filesystem::path& path) : path_(path), stream_(openInputFile(path)) {}

  PcdHeader read() {
    std::string kind;
    while (kind.empty()) kind = readLine();
    if (header_.fields.empty()) refuse("no FIELDS before DATA");
    if (!has_points_) refuse("no POINTS before DATA");
    checkSize(kind);
    return header_;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(path_.string(), linePlace(line_number_), reason);
  }

  /// Takes one line; returns the kind of data where it is the DATA line, else an empty string.
  std::string readLine() {
    std::string line;
    ++line_number_;
    char c = 0;
    while (stream_.get(c) && c != '\n' && line.size() < kLongestHeaderLine) line += c;
    if (c != '\n') refuse("is no PCD file: the header has no DATA line");
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "DATA") {
      std::string kind;
      words >> kind;
      return kind.empty() ? "nothing" : kind;
    }
    if (key == "FIELDS" || key == "COLUMNS") {
      header_.fields.clear();
      for (std::string name; words >> name;) header_.fields.push_back({name});
    } else if (key == "SIZE") {
      for (PcdField& field : header_.fields) field.size = number(words);
    } else if (key == "COUNT") {
      for (PcdField& field : header_.fields) field.count = number(words);
    } else if (key == "TYPE") {
      for (PcdField& field : header_.fields) words >> field.type;
    } else if (key == "POINTS") {
      has_points_ = static_cast<bool>(words >> header_.points);
      if (!has_points_) refuse("POINTS is no number");
    } else if (!key.empty() && key.front() != '#' && key != "VERSION" && key != "WIDTH" && key != "HEIGHT" &&
               key != "VIEWPOINT") {
      refuse("is no line of a PCD header");
    }
    return "";
  }

  std::uint64_t number(std::istringstream& words) const {
    std::uint64_t value = 0;
    if (!(words >> value) || value > kGreatestFieldValue) refuse("a number for each field is needed");
    return value;
  }

  void checkSize(const std::string& kind) {
    const auto data_offset = static_cast<std::uint64_t>(stream_.tellg());
    const std::uint64_t data_size = std::filesystem::file_size(path_) - data_offset;
    std::uint64_t point_bytes = 0;
    std::uint64_t point_values = 0;
    for (const PcdField& field : header_.fields) {
      point_bytes += field.size * field.count;
      point_values += field.count;
    }
    if (point_bytes == 0) refuse("SIZE and COUNT leave a point without bytes");
    std::uint64_t greatest_points = 0;
    if (kind == "binary") {
      greatest_points = data_size / point_bytes;
    } else if (kind == "binary_compressed") {
      greatest_points = greatestCompressedPoints(data_offset, data_size, point_bytes);
    } else if (kind == "ascii") {
      // A value takes a digit and a blank or line end; the last line may lack its end.
      greatest_points = (data_size + 1) / (2 * point_values);
    } else {
      refuse("DATA must be ascii, binary or binary_compressed");
    }
    if (header_.points > greatest_points) {
      throw Error(path_.string(), "offset " + std::to_string(data_offset),
                  std::to_string(header_.points) + " points are announced, where the file holds at most " +
                      std::to_string(greatest_points));
    }
  }

  std::uint64_t greatestCompressedPoints(std::uint64_t offset, std::uint64_t data_size, std::uint64_t point_bytes) {
    std::uint32_t sizes[2] = {0, 0};
    if (!stream_.read(reinterpret_cast<char*>(sizes), sizeof(sizes)) || sizes[0] > data_size - sizeof(sizes)) {
      throw Error(path_.string(), "offset " + std::to_string(offset), "the compressed data are cut short");
    }
    return std::min<std::uint64_t>(sizes[1], kGreatestExpansion * sizes[0]) / point_bytes;
  }

  std::filesystem::path path_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  PcdHeader header_;
  bool has_points_ = false;
};

}  // namespace

PcdHeader readPcdHeader(const std::filesystem::path& path) { return HeaderReader(path).read(); }

}  // namespace saw_ndt::internal
