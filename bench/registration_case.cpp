#include "registration_case.h"

#include <map>

#include "benchmark_scans.h"

namespace saw_ndt {

const RegistrationCase& registrationCase(const std::string& method_name) {
  static std::map<std::string, RegistrationCase> cases;
  const auto found = cases.find(method_name);
  if (found != cases.end()) return found->second;
  LocalizerOptions options;
  options.method = LocalizationMethod::named(method_name);
  const NdtTarget target(benchmarkMap(), options.method.voxels);
  // A localizer's options are the alignment's as its method sets them.
  const AlignmentOptions alignment = Localizer(target, options).options().alignment;
  return cases
      .emplace(method_name, RegistrationCase{target, benchmarkSource(benchmarkScan(), options.method), alignment})
      .first->second;
}

}  // namespace saw_ndt
