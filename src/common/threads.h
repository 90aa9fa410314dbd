#pragma once

namespace saw_ndt {

/// The number of threads that an option asks for: itself, or all cores for 0.
int threadCount(int requested);

}  // namespace saw_ndt
