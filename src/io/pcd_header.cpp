#include "io/pcd_header.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>
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
  explicit HeaderReader(const std::filesystem::path& path) : path_(path), stream_(openTextFile(path)) {}

  PcdHeader read() {
    std::string kind;
    while (kind.empty()) kind = readLine();
    if (header_.fields.empty()) refuse("no FIELDS before DATA");
    for (const char* key : {"SIZE", "TYPE", "POINTS"}) {
      if (seen_.count(key) == 0) refuse(std::string("no ") + key + " before DATA");
    }
    for (const PcdField& field : header_.fields) checkField(field);
    header_.lines = line_number_;
    header_.data_offset = static_cast<std::uint64_t>(stream_.tellg());
    checkSize(kind);
    checkShape();
    return header_;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(path_.string(), linePlace(line_number_), reason);
  }
  [[noreturn]] void refuseData(const std::string& reason) const {
    throw Error(path_.string(), "offset " + std::to_string(header_.data_offset), reason);
  }

  /// Takes one line; returns the kind of data where it is the DATA line, else an empty string.
  std::string readLine() {
    std::string line;
    ++line_number_;
    char c = 0;
    while (stream_.get(c) && c != '\n' && line.size() < kLongestHeaderLine) line += c;
    if (c != '\n') refuse("is no PCD file: the header has no DATA line");
    if (line.empty()) return "";
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key.empty()) refuse("a line of blanks within the header");
    if (key.front() == '#') return "";
    if (key == "COLUMNS") key = "FIELDS";
    if (!seen_.insert(key).second) refuse(key + " is given twice");
    if ((key == "SIZE" || key == "TYPE" || key == "COUNT") && header_.fields.empty()) refuse(key + " before FIELDS");
    if (key == "DATA") {
      std::string kind;
      words >> kind;
      return kind.empty() ? "nothing" : kind;
    }
    if (key == "FIELDS") {
      for (std::string name; words >> name;) header_.fields.push_back({name});
    } else if (key == "SIZE") {
      for (PcdField& field : header_.fields) field.size = numberOfField(words);
    } else if (key == "COUNT") {
      for (PcdField& field : header_.fields) field.count = numberOfField(words);
    } else if (key == "TYPE") {
      for (PcdField& field : header_.fields) {
        if (!(words >> field.type)) refuse("a type for each field is needed");
      }
    } else if (key == "POINTS") {
      header_.points = wholeNumber(words, key);
    } else if (key == "WIDTH") {
      header_.width = wholeNumber(words, key);
    } else if (key == "HEIGHT") {
      header_.height = wholeNumber(words, key);
    } else if (key == "VIEWPOINT") {
      for (float& value : header_.viewpoint) {
        if (!(words >> value)) refuse("VIEWPOINT needs 7 numbers");
      }
    } else if (key == "VERSION") {
      words >> key;
    } else {
      refuse("is no line of a PCD header");
    }
    if (words >> key) refuse("more words than there are fields or values");
    return "";
  }

  std::uint64_t wholeNumber(std::istringstream& words, const std::string& key) const {
    std::string word;
    words >> word;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) refuse(key + " is no whole number of 0 or more");
    return value;
  }

  std::uint64_t numberOfField(std::istringstream& words) const {
    std::string word;
    words >> word;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size() || value > kGreatestFieldValue) {
      refuse("a number for each field is needed");
    }
    return value;
  }

  void checkField(const PcdField& field) const {
    const bool is_float = field.type == 'F' && (field.size == 4 || field.size == 8);
    const bool is_integer = (field.type == 'U' || field.type == 'I') &&
                            (field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8);
    if (is_float || is_integer) return;
    refuse("the field " + field.name + " has the type " + std::string(1, field.type) + " of " +
           std::to_string(field.size) + " bytes: F of 4 or 8, U and I of 1, 2, 4 or 8 are known");
  }

  void checkSize(const std::string& kind) {
    const std::uint64_t data_size = std::filesystem::file_size(path_) - header_.data_offset;
    const std::uint64_t point_bytes = header_.pointBytes();
    std::uint64_t point_values = 0;
    for (const PcdField& field : header_.fields) point_values += field.count;
    if (point_bytes == 0) refuse("SIZE and COUNT leave a point without bytes");
    std::uint64_t greatest_points = 0;
    if (kind == "binary") {
      header_.data = PcdData::BINARY;
      greatest_points = data_size / point_bytes;
    } else if (kind == "binary_compressed") {
      header_.data = PcdData::COMPRESSED;
      greatest_points = greatestCompressedPoints(data_size, point_bytes);
    } else if (kind == "ascii") {
      header_.data = PcdData::ASCII;
      // A value takes a digit and a blank or line end; the last line may lack its end.
      greatest_points = (data_size + 1) / (2 * point_values);
    } else {
      refuse("DATA must be ascii, binary or binary_compressed");
    }
    if (header_.points > greatest_points) {
      refuseData(std::to_string(header_.points) + " points are announced, where the file holds at most " +
                 std::to_string(greatest_points));
    }
    if (header_.data == PcdData::COMPRESSED && uncompressed_bytes_ != header_.points * point_bytes) {
      refuseData(std::to_string(uncompressed_bytes_) + " bytes are announced, where " + std::to_string(header_.points) +
                 " points have " + std::to_string(header_.points * point_bytes));
    }
  }

  std::uint64_t greatestCompressedPoints(std::uint64_t data_size, std::uint64_t point_bytes) {
    std::uint32_t sizes[2] = {0, 0};
    if (!stream_.read(reinterpret_cast<char*>(sizes), sizeof(sizes)) || sizes[0] > data_size - sizeof(sizes)) {
      refuseData("the compressed data are cut short");
    }
    uncompressed_bytes_ = sizes[1];
    return std::min<std::uint64_t>(sizes[1], kGreatestExpansion * sizes[0]) / point_bytes;
  }

  void checkShape() {
    const std::uint64_t width = header_.width, height = header_.height;
    const bool overflows = height != 0 && width > std::numeric_limits<std::uint64_t>::max() / height;
    if (seen_.count("WIDTH") != 0 && width != 0 && height != 0 && (overflows || width * height != header_.points)) {
      refuse("WIDTH " + std::to_string(width) + " times HEIGHT " + std::to_string(height) + " is not POINTS " +
             std::to_string(header_.points));
    }
    if (header_.points == 0) refuse("the cloud has no points");
    if (width == 0 || height == 0) {
      header_.width = header_.points;
      header_.height = 1;
    }
  }

  std::filesystem::path path_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  PcdHeader header_;
  std::set<std::string> seen_;
  std::uint64_t uncompressed_bytes_ = 0;
};

}  // namespace

std::uint64_t PcdHeader::pointBytes() const {
  std::uint64_t bytes = 0;
  for (const PcdField& field : fields) bytes += field.bytes();
  return bytes;
}

PcdHeader readPcdHeader(const std::filesystem::path& path) { return HeaderReader(path).read(); }

}  // namespace saw_ndt::internal
