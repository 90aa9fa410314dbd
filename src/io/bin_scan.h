#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

constexpr int kKittiFields = 4;

/// Throws std::invalid_argument unless floats a point of a .bin file are 0 (told from the values), 4, 5 or 6.
void requireBinFields(int bin_fields);

/// How many floats a point of a .bin file has, 3 to 8: consecutive points are alike in each of their columns, which
/// numbers so many places apart show and others do not. A sample of the file is looked at.
/// @return none where the values do not say
std::optional<int> tellBinFields(const float* values, std::size_t count);
/// The same of a file; none also where it cannot be read.
std::optional<int> tellBinFields(const std::filesystem::path& path);

/// The same of the scans of a recording: told by the first of ten that says, kKittiFields where none does.
int binFieldsOfScans(const std::vector<std::filesystem::path>& paths);

/// Throws Error unless a sample of the points, `fields` floats each, has coordinates that a scan may have, but for a
/// few. Numbers that are not finite say nothing.
void requireScanCoordinates(const std::filesystem::path& path, const float* values, std::size_t count, int fields);

/// Reads a .bin file as readScanPoints() does; of four floats a point where `bin_fields` is 0 and the values do not
/// say.
void readBinScan(const std::filesystem::path& path, ScanPoints& scan, int bin_fields);

}  // namespace saw_ndt::internal
