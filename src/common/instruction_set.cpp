#include "common/instruction_set.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "common/instruction_set_limit.h"
#include "hwy/highway.h"

namespace saw_ndt::internal {
namespace {

// Highway's targets beyond a set.
std::int64_t targetsBeyond(InstructionSet most) {
#if HWY_ARCH_X86
  const std::int64_t avx512 = HWY_AVX3 | HWY_AVX3_DL;
  if (most == InstructionSet::BASELINE) return avx512 | HWY_AVX2 | HWY_SSE4 | HWY_SSSE3;
  if (most == InstructionSet::SSE4) return avx512 | HWY_AVX2;
  if (most == InstructionSet::AVX2) return avx512;
#else
  static_cast<void>(most);
#endif
  return 0;
}

struct EnvironmentLimit {
  InstructionSet most = InstructionSet::AVX512;
  std::string error;  // empty where the variable holds what it may
};

// Read once, before the first choice. Loops may make that choice inside a parallel region, which no exception may
// leave: a variable that makes no sense limits nothing there.
const EnvironmentLimit& environmentLimit() {
  static const EnvironmentLimit limit = [] {
    EnvironmentLimit read;
    const char* const name = std::getenv("SAW_NDT_INSTRUCTION_SET");
    if (name == nullptr || *name == '\0') return read;
    try {
      read.most = instructionSetNamed(name);
      hwy::DisableTargets(targetsBeyond(read.most));
    } catch (const std::invalid_argument& error) {
      read.error = "environment variable SAW_NDT_INSTRUCTION_SET: " + std::string(error.what());
    }
    return read;
  }();
  return limit;
}

InstructionSet checkedEnvironmentLimit() {
  if (!environmentLimit().error.empty()) throw std::invalid_argument(environmentLimit().error);
  return environmentLimit().most;
}

}  // namespace

void obeyInstructionSetLimit() { environmentLimit(); }

InstructionSet instructionSet() {
  checkedEnvironmentLimit();
#if HWY_ARCH_X86
  const std::int64_t targets = hwy::SupportedTargets();
  if ((targets & HWY_AVX3) != 0) return InstructionSet::AVX512;
  if ((targets & HWY_AVX2) != 0) return InstructionSet::AVX2;
  if ((targets & HWY_SSE4) != 0) return InstructionSet::SSE4;
#endif
  return InstructionSet::BASELINE;
}

void limitInstructionSet(InstructionSet most) {
  hwy::DisableTargets(targetsBeyond(std::min(most, checkedEnvironmentLimit())));
}

const char* toString(InstructionSet set) {
  switch (set) {
    case InstructionSet::BASELINE:
      return "baseline";
    case InstructionSet::SSE4:
      return "sse4";
    case InstructionSet::AVX2:
      return "avx2";
    case InstructionSet::AVX512:
      return "avx512";
  }
  return "unknown";
}

InstructionSet instructionSetNamed(const std::string& name) {
  for (const InstructionSet set : kInstructionSets) {
    if (name == toString(set)) return set;
  }
  throw std::invalid_argument("instruction set " + name + ": must be one of baseline sse4 avx2 avx512");
}

}  // namespace saw_ndt::internal
