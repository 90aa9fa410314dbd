#include "common/threads.h"

#include <omp.h>

namespace saw_ndt {

int threadCount(int requested) { return requested > 0 ? requested : omp_get_num_procs(); }

}  // namespace saw_ndt
