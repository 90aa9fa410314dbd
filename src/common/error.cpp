#include "saw_ndt/common/error.h"

#include "common/printable.h"

namespace saw_ndt {
namespace {

// What is quoted from a file may be of any length; the name of the file is never cut.
std::string shortened(const std::string& reason) {
  constexpr std::size_t kLongestReason = 500;
  const std::string text = internal::printableLine(reason);
  return text.size() <= kLongestReason ? text : text.substr(0, kLongestReason) + "...";
}

}  // namespace

Error::Error(const std::string& file, const std::string& place, const std::string& reason)
    : std::runtime_error(
          internal::printableLine(file + ": " + (place.empty() ? "" : place + ": ") + shortened(reason))) {}

Error::Error(const std::string& what) : std::runtime_error(internal::printableLine(what)) {}

}  // namespace saw_ndt
