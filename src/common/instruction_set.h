#pragma once

#include <array>
#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// The vector instructions that the inner loops are compiled for, each set holding those before it.
enum class InstructionSet {
  BASELINE,  ///< what every processor of the architecture has
  SSE4,      ///< SSE 4.2 with AES: small processors of robots have no more
  AVX2,      ///< AVX2 with fused multiply-add
  AVX512,    ///< AVX-512 F, BW, CD, DQ and VL
};

/// All of them, from the least on.
constexpr std::array<InstructionSet, 4> kInstructionSets = {InstructionSet::BASELINE, InstructionSet::SSE4,
                                                            InstructionSet::AVX2, InstructionSet::AVX512};

/// The set in use: the best that this processor has, or less where the environment variable SAW_NDT_INSTRUCTION_SET
/// ("baseline", "sse4", "avx2" or "avx512") or limitInstructionSet() says so. Labels, maps and ground do not depend on
/// it; the last digits of a pose do, since a fused multiply-add rounds once.
/// @throws std::invalid_argument where the environment variable holds something else
SAW_NDT_EXPORT InstructionSet instructionSet();

/// Uses no more than `most` from now on, nor more than the environment variable says; AVX512 lifts an earlier limit.
/// For tests and benchmarks: not to be called while other threads compute.
SAW_NDT_EXPORT void limitInstructionSet(InstructionSet most);

/// "baseline", "sse4", "avx2" or "avx512"
SAW_NDT_EXPORT const char* toString(InstructionSet set);
/// The inverse of toString(). @throws std::invalid_argument that lists the names, for another one
SAW_NDT_EXPORT InstructionSet instructionSetNamed(const std::string& name);

}  // namespace saw_ndt::internal
