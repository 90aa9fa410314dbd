#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// Work on a file failed. what() reads "file: place: reason", or "file: reason" where no place can be named, control
/// characters written as \x1b and the like.
class SAW_NDT_EXPORT Error : public std::runtime_error {
 public:
  /// @param file    the file as the caller named it
  /// @param place   where in it, such as "line 3" or "offset 128"; may be empty
  /// @param reason  what is wrong, as a clause without a full stop
  Error(const std::string& file, const std::string& place, const std::string& reason);
  /// @param what  of an Error met before
  explicit Error(const std::string& what);
};

/// Throws std::invalid_argument "name = value: must be requirement" unless `valid`; for the check of an options struct.
template <typename Value>
void checkOption(bool valid, const char* name, const Value& value, const char* requirement) {
  if (valid) return;
  std::ostringstream message;
  message << name << " = " << value << ": must be " << requirement;
  throw std::invalid_argument(message.str());
}

}  // namespace saw_ndt
