#include "mpi/removed_on_termination.h"

#include <signal.h>
#include <unistd.h>

#include <climits>
#include <cstring>
#include <string>

namespace saw_ndt::internal {
namespace {

char path_to_remove[PATH_MAX];

// The default action follows once this has returned.
void removeAndEnd(int signal_number) {
  unlink(path_to_remove);
  raise(signal_number);
}

}  // namespace

RemovedOnTermination::RemovedOnTermination(const std::filesystem::path& path) {
  const std::string text = std::filesystem::absolute(path).string();
  if (text.size() >= sizeof path_to_remove) return;  // cannot be opened either
  std::memcpy(path_to_remove, text.c_str(), text.size() + 1);
  struct sigaction action = {};
  action.sa_handler = removeAndEnd;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGTERM, &action, nullptr);
}

RemovedOnTermination::~RemovedOnTermination() { signal(SIGTERM, SIG_DFL); }

}  // namespace saw_ndt::internal
