#include "saw_ndt/io/scan_file.h"

#include "io/bin_scan.h"
#include "io/pcd_fields.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

void readScanPoints(const std::filesystem::path& path, ScanPoints& scan, int bin_fields) {
  requireScanExtension(path);
  if (isBinScan(path)) return readBinScan(path, scan, bin_fields);
  requireBinFields(bin_fields);
  scan = scanPointsOf(path, readCloudFile(path));
}

ScanPoints readScanPoints(const std::filesystem::path& path, int bin_fields) {
  ScanPoints scan;
  readScanPoints(path, scan, bin_fields);
  return scan;
}

}  // namespace saw_ndt
