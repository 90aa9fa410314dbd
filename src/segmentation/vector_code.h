#pragma once

// Marks a loop over plain arrays that is compiled twice, for AVX2 and for the baseline, and chosen between when the
// program starts. Neither uses fused multiply-add, so both give the same bits. Sanitizers do not bear such a choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SAW_NDT_VECTOR_CODE __attribute__((target_clones("avx2", "default")))
#else
#define SAW_NDT_VECTOR_CODE
#endif
