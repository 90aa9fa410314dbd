#pragma once

#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// Scan numbers that a Python slice selects from 0 .. scan_count - 1, in the slice's order.
///
/// `text` is "first:last:step", each part optional, negative numbers counting from the end, `last` excluded; or one
/// number, "7" or "-1", for that scan alone. Throws std::invalid_argument that quotes `text` where it is neither, where
/// the step is 0, or where nothing is selected.
SAW_NDT_EXPORT std::vector<int> parseScanSelection(const std::string& text, int scan_count);

/// The scans of one of several jobs that share a selection: `text` is "I/N", I from 1 to N, and selects every N-th one
/// beginning with the I-th. Throws std::invalid_argument that quotes `text` where it is not that, or where nothing is
/// left for that job.
SAW_NDT_EXPORT std::vector<int> parseScanShard(const std::string& text, const std::vector<int>& selected);

}  // namespace saw_ndt
