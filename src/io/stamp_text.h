#pragma once

#include <optional>
#include <string_view>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Seconds since 1970 of a date and a time of day in UTC, `2011-09-26 13:02:25.964389445`; a T may stand between the
/// two. Nothing where it is no such text.
SAW_NDT_EXPORT std::optional<double> stampOfDate(std::string_view text);

/// The stamp (s) that the name of a file is, without its extension: seconds with a fraction behind a dot, or, since
/// 1970, whole seconds, milliseconds, microseconds or nanoseconds (10, 13, 16 or 19 digits), or seconds and nine digits
/// of nanoseconds behind `_` or `-`. Words before the number, as in cloud_1700000000.5, do not matter. Nothing where
/// the name is no stamp.
SAW_NDT_EXPORT std::optional<double> stampOfName(std::string_view stem);

}  // namespace saw_ndt::internal
