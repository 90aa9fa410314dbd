#include "io/ply_header.h"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>

#include "common/input_file.h"
#include "io/number_lines.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr std::size_t kLongestHeaderLine = 65536;
constexpr std::uint64_t kGreatestElements = 1ULL << 40U;
constexpr std::string_view kScalarPrefix = "scalar_";

struct NumberType {
  std::string_view name;
  std::uint64_t size;
  char type;
};
constexpr NumberType kNumberTypes[] = {{"char", 1, 'I'},  {"int8", 1, 'I'},    {"uchar", 1, 'U'},  {"uint8", 1, 'U'},
                                       {"short", 2, 'I'}, {"int16", 2, 'I'},   {"ushort", 2, 'U'}, {"uint16", 2, 'U'},
                                       {"int", 4, 'I'},   {"int32", 4, 'I'},   {"uint", 4, 'U'},   {"uint32", 4, 'U'},
                                       {"float", 4, 'F'}, {"float32", 4, 'F'}, {"double", 8, 'F'}, {"float64", 8, 'F'}};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PcdField> fields;
  bool has_lists = false;

  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const PcdField& field : fields) sum += field.bytes();
    return sum;
  }
};

class HeaderReader {
 public:
  explicit HeaderReader(const std::filesystem::path& path) : path_(path), stream_(openInputFile(path)) {}

  PlyHeader read() {
    if (readLine() != "ply") refuse("is no PLY file: the first line is not `ply`");
    while (takeLine(readLine())) {
    }
    if (format_.empty()) refuse("no line `format` in the header");
    header_.big_endian = format_ == "binary_big_endian";
    header_.cloud.data = format_ == "ascii" ? PcdData::ASCII : PcdData::BINARY;
    header_.cloud.data_offset = static_cast<std::uint64_t>(stream_.tellg());
    takeVertices();
    return header_;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(path_.string(), linePlace(line_number_), reason);
  }

  std::string readLine() {
    std::string line;
    ++line_number_;
    char c = 0;
    while (stream_.get(c) && c != '\n' && line.size() < kLongestHeaderLine) line += c;
    if (c != '\n') refuse("is no PLY file: the header has no end");
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

  /// Returns false at the end of the header.
  bool takeLine(const std::string& line) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "end_header") return false;
    if (key.empty() || key == "comment" || key == "obj_info") return true;
    if (key == "format") {
      words >> format_;
      if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian") {
        refuse("the format '" + format_ + "' is none of ascii, binary_little_endian, binary_big_endian");
      }
    } else if (key == "element") {
      takeElement(words);
    } else if (key == "property") {
      takeProperty(words);
    } else {
      refuse("'" + key.substr(0, 40) + "' is no line of a PLY header");
    }
    return true;
  }

  void takeElement(std::istringstream& words) {
    Element& element = elements_.emplace_back();
    std::string count;
    words >> element.name >> count;
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || end != count.data() + count.size() || element.count > kGreatestElements) {
      refuse("the number of elements '" + count.substr(0, 40) + "' is no whole number of 0 or more");
    }
  }

  void takeProperty(std::istringstream& words) {
    if (elements_.empty()) refuse("a property before any element");
    std::string type, name;
    words >> type >> name;
    if (type == "list") {
      elements_.back().has_lists = true;
      return;
    }
    const auto* known = std::find_if(std::begin(kNumberTypes), std::end(kNumberTypes),
                                     [&](const NumberType& number) { return number.name == type; });
    if (known == std::end(kNumberTypes) || name.empty()) {
      refuse("a property needs a type of number that PLY files have, and a name");
    }
    if (name.compare(0, kScalarPrefix.size(), kScalarPrefix) == 0) name.erase(0, kScalarPrefix.size());
    elements_.back().fields.push_back({name, known->size, known->type});
  }

  void takeVertices() {
    const auto vertices =
        std::find_if(elements_.begin(), elements_.end(), [](const Element& e) { return e.name == "vertex"; });
    if (vertices == elements_.end()) refuse("no element `vertex` in the header");
    if (vertices->has_lists) refuse("the vertices have lists of numbers");
    if (vertices->count == 0 || vertices->fields.empty()) refuse("the cloud has no points");
    const bool is_ascii = header_.cloud.data == PcdData::ASCII;
    std::uint64_t data_size = std::filesystem::file_size(path_) - header_.cloud.data_offset;
    for (auto element = elements_.begin(); element != vertices; ++element) {
      if (element->has_lists) refuse("lists of numbers stand before the vertices");
      if (is_ascii) {
        for (std::uint64_t i = 0; i < element->count; ++i) readLine();
        header_.cloud.data_offset = static_cast<std::uint64_t>(stream_.tellg());
        data_size = std::filesystem::file_size(path_) - header_.cloud.data_offset;
        continue;
      }
      const std::uint64_t bytes = element->bytes();
      if (bytes > 0 && element->count > data_size / bytes) refuse("the file ends before its vertices");
      header_.cloud.data_offset += element->count * bytes;
      data_size -= element->count * bytes;
    }
    header_.cloud.fields = vertices->fields;
    header_.cloud.points = header_.cloud.width = vertices->count;
    header_.cloud.lines = line_number_;
    header_.cloud.others_follow = vertices + 1 != elements_.end();
    // A number in ASCII takes a digit and a blank or line end; the last line may lack its end.
    const std::uint64_t greatest =
        is_ascii ? (data_size + 1) / (2 * vertices->fields.size()) : data_size / header_.cloud.pointBytes();
    if (vertices->count > greatest) {
      throw Error(path_.string(), "offset " + std::to_string(header_.cloud.data_offset),
                  std::to_string(vertices->count) + " points are announced, where the file holds at most " +
                      std::to_string(greatest));
    }
  }

  std::filesystem::path path_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  std::string format_;
  std::vector<Element> elements_;
  PlyHeader header_;
};

}  // namespace

PlyHeader readPlyHeader(const std::filesystem::path& path) { return HeaderReader(path).read(); }

}  // namespace saw_ndt::internal
