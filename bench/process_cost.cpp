#include "process_cost.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <exception>
#include <iostream>

#include "common/stopwatch.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

ProcessCost costOf(const std::function<void()>& work) {
  std::cout << std::flush;  // not to be written twice
  const internal::Stopwatch stopwatch;
  const pid_t child = fork();
  if (child < 0) throw Error("fork() failed");
  if (child == 0) {
    try {
      work();
    } catch (const std::exception& error) {
      std::cerr << error.what() << '\n';
      _exit(1);
    }
    std::cout << std::flush;
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (status != 0) throw Error("a measurement failed");
  return {1e-3 * stopwatch.milliseconds(), static_cast<double>(usage.ru_maxrss) / 1024.0};
}

void leavePageCache(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw Error(path, "", "cannot be opened");
  fdatasync(descriptor);
  posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  close(descriptor);
}

}  // namespace saw_ndt
