#pragma once

#include <string>

namespace saw_ndt {

// Makes the checksums of a file agree with its bytes, as far as it has the form of such a map, so that inputs reach
// what lies behind the checks.

void repairMapChecksums(std::string& bytes);
void repairLocalizationMapChecksums(std::string& bytes);

}  // namespace saw_ndt
