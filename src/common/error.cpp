#include "saw_ndt/common/error.h"

#include "common/printable.h"

namespace saw_ndt {

Error::Error(const std::string& file, const std::string& place, const std::string& reason)
    : Error(file + ": " + (place.empty() ? "" : place + ": ") + reason) {}

Error::Error(const std::string& what) : std::runtime_error(internal::printable(what)) {}

}  // namespace saw_ndt
