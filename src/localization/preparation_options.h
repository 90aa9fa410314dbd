#pragma once

#include "saw_ndt/common/export.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/localization/scan_preparation.h"

namespace saw_ndt::internal {

/// How a Localizer with such options prepares its scans.
SAW_NDT_EXPORT ScanPreparationOptions preparationOptions(const LocalizerOptions& options);
/// The same for scans that are registered to a target.
SAW_NDT_EXPORT ScanPreparationOptions preparationFor(const TiledTarget& target, const LocalizerOptions& options);

}  // namespace saw_ndt::internal
