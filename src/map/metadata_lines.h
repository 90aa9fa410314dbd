#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "map/map_metadata.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt::internal {

constexpr std::string_view kMetadataBetween = " = ";

/// Appends a line to a text that MetadataLines reads.
inline void appendMetadataLine(std::string_view key, std::string_view value, std::string& text) {
  text.append(key).append(kMetadataBetween).append(value).append("\n");
}

/// The values of a text of lines `key = value` by their keys. The first fault is kept.
class MetadataLines {
 public:
  explicit MetadataLines(std::string_view text) : text_(text) {
    for (std::size_t start = 0; start < text.size();) {
      const std::size_t end = text.find('\n', start);
      const std::string_view line = text.substr(start, end - start);
      const std::size_t between = line.find(kMetadataBetween);
      if (end == std::string_view::npos || between == std::string_view::npos) {
        fail(start, "damaged: the metadata has a line that is not `key = value`");
        return;
      }
      const std::string_view key = line.substr(0, between);
      if (!values_.emplace(key, line.substr(between + kMetadataBetween.size())).second) {
        fail(start, "damaged: the metadata gives " + std::string(key) + " twice");
        return;
      }
      start = end + 1;
    }
  }

  template <typename Value>
  void read(std::string_view key, Value& value) {
    const auto found = values_.find(key);
    if (found == values_.end()) {
      fail(0, "damaged: the metadata does not give " + std::string(key));
    } else if (!parseField(found->second, value)) {
      failAt(key, "damaged: the metadata gives no valid " + std::string(key));
    }
  }

  bool gives(std::string_view key) const { return values_.count(key) != 0; }

  void failAt(std::string_view key, const std::string& reason) {
    fail(static_cast<std::size_t>(values_.at(key).data() - text_.data()), reason);
  }
  void fail(std::size_t offset, const std::string& reason) {
    if (!fault_) fault_ = MetadataFault{offset, reason};
  }
  const std::optional<MetadataFault>& fault() const { return fault_; }

 private:
  std::string_view text_;
  std::map<std::string_view, std::string_view> values_;
  std::optional<MetadataFault> fault_;
};

}  // namespace saw_ndt::internal
