#pragma once

#include <filesystem>

namespace saw_ndt::internal {

/// While it lives, SIGTERM removes a file before it ends the process: launchers send it to the ranks that are left when
/// one has died, rank 0, whose file it is, perhaps. There is one at a time.
class RemovedOnTermination {
 public:
  explicit RemovedOnTermination(const std::filesystem::path& path);
  ~RemovedOnTermination();
  RemovedOnTermination(const RemovedOnTermination&) = delete;
  RemovedOnTermination& operator=(const RemovedOnTermination&) = delete;
};

}  // namespace saw_ndt::internal
