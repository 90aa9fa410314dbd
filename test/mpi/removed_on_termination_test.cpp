#include "mpi/removed_on_termination.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

// Ends a child process by SIGTERM while it guards a file, or after that; returns how it ended.
int statusAfterTermination(const std::filesystem::path& file, bool still_guarded) {
  const pid_t child = fork();
  if (child == 0) {
    {
      const RemovedOnTermination guard(file);
      if (still_guarded) raise(SIGTERM);
    }
    raise(SIGTERM);
    _exit(3);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(RemovedOnTermination, RemovesTheFileAndEndsTheProcessBySigterm) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a.map.tmp", "half");
  const int status = statusAfterTermination(file, true);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(RemovedOnTermination, LeavesTheFileAloneAfterwards) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a.map", "whole");
  const int status = statusAfterTermination(file, false);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
  EXPECT_TRUE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace saw_ndt::internal
