#pragma once

#include <string>

#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// What a Localizer of one method registers of the benchmarks' scan.
struct RegistrationCase {
  NdtTarget target;
  SourcePoints source;
  AlignmentOptions options;
};

/// The case of a method, made at first use. @throws std::invalid_argument for a name that is none
const RegistrationCase& registrationCase(const std::string& method_name);

}  // namespace saw_ndt
