#include "common/large_blocks.h"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace saw_ndt::internal {

void returnLargeBlocks() {
#ifdef __GLIBC__
  constexpr int kLarge_bytes = 512 * 1024;
  mallopt(M_MMAP_THRESHOLD, kLarge_bytes);
#endif
}

}  // namespace saw_ndt::internal
