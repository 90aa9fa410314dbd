#pragma once

#include <filesystem>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt {

/// Reads one scan with all that its file tells of the points: a PCD file where the name ends in .pcd, a PLY file where
/// it ends in .ply, rows of little-endian float32 where it ends in .bin. Points at the origin and such as are not
/// finite are kept.
///
/// Of a PCD or PLY file the fields x y z, an intensity (or reflectivity ...), a ring (channel, line ...) and a time (t,
/// timestamp ...) are taken, of any number type and in any order. Times are seconds afterwards, relative or absolute as
/// they were: what is no floating-point number of seconds is told from its span, for a scan takes 0.01 to 1.5 s. Rings
/// that are all the same, or no whole numbers, and times that are all the same say nothing and are left out.
///
/// Of a .bin file the columns are x y z intensity and, with five or six, a ring (whole numbers up to 1023) or a time
/// (rises within the span of a scan).
/// @param bin_fields  floats a point of a .bin file: 4, 5 or 6; 0: told from the values, 4 where they do not say
/// @throws Error where the file is of no such kind, missing or damaged, or holds coordinates that no scan has;
///         std::invalid_argument for other bin_fields
SAW_NDT_EXPORT ScanPoints readScanPoints(const std::filesystem::path& path, int bin_fields = 0);
/// The same into memory that `scan` may bring along.
SAW_NDT_EXPORT void readScanPoints(const std::filesystem::path& path, ScanPoints& scan, int bin_fields = 0);

}  // namespace saw_ndt
