#pragma once

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A program may ask for this at its beginning, once; a library never does. From then on
///   SIGINT, SIGTERM and SIGHUP, unless they are ignored, remove what is unfinished before they end the process;
///   a file that somebody cuts short while it is mapped into memory is named on stderr before SIGBUS ends the process;
///   a file that gets larger than the system allows is an error of the write, in place of SIGXFSZ.
SAW_NDT_EXPORT void handleProgramSignals();

}  // namespace saw_ndt::internal
