#include "common/unfinished_output.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <stdexcept>

#include "common/program_signals.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

namespace fs = std::filesystem;

class UnfinishedOutputTest : public ::testing::Test {
 protected:
  /// How a child process ends that gets a signal, where it asked for unfinished outputs to go with it.
  template <typename Work>
  static int statusAfter(int signal_number, bool asked, const Work& work) {
    const pid_t child = fork();
    if (child == 0) {
      if (asked) handleProgramSignals();
      work([&] {
        kill(getpid(), signal_number);
        pause();
      });
      _exit(3);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  }
  fs::path half() const { return folder.path() / "half"; }
  std::function<fs::path()> making(const std::string& name) const {
    return [this, name] { return folder.write(name, "half"); };
  }

  TemporaryFolder folder;
};

TEST_F(UnfinishedOutputTest, IsRemovedUnlessItIsFinished) {
  { const UnfinishedOutput output(making("half")); }
  EXPECT_EQ(folder.entryCount(), 0U);
  {
    UnfinishedOutput output(making("half"));
    EXPECT_THROW(output.finish([] { throw std::runtime_error("no"); }), std::runtime_error);
  }
  EXPECT_EQ(folder.entryCount(), 0U);
  {
    UnfinishedOutput output(making("half"));
    output.finish([&] { fs::rename(half(), folder.path() / "whole"); });
  }
  EXPECT_TRUE(fs::exists(folder.path() / "whole"));
  EXPECT_THROW(UnfinishedOutput([]() -> fs::path { throw std::runtime_error("no"); }), std::runtime_error);
}

TEST_F(UnfinishedOutputTest, ASignalRemovesItAndEndsTheProcess) {
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = statusAfter(signal_number, true, [&](const auto& interrupt) {
      const UnfinishedOutput output(making("half"));
      const UnfinishedOutput with_files([&] {
        folder.write("folder/a/b", "half");
        return folder.path() / "folder";
      });
      UnfinishedOutput finished(making("whole"));
      finished.finish();
      interrupt();
    });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal_number);
    EXPECT_EQ(folder.entryCount(), 1U);
    EXPECT_TRUE(fs::exists(folder.path() / "whole"));
  }
}

TEST_F(UnfinishedOutputTest, ASignalWaitsUntilSomethingIsFinished) {
  const int status = statusAfter(SIGTERM, true, [&](const auto& interrupt) {
    UnfinishedOutput output(making("half"));
    output.finish([&] {
      kill(getpid(), SIGTERM);
      usleep(50000);
      fs::rename(half(), folder.path() / "whole");
    });
    interrupt();
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(fs::exists(folder.path() / "whole"));
  EXPECT_EQ(folder.entryCount(), 1U);
}

TEST_F(UnfinishedOutputTest, SignalsAreLeftAloneUnlessAProgramAsks) {
  const int status = statusAfter(SIGTERM, false, [&](const auto& interrupt) {
    const UnfinishedOutput output(making("half"));
    interrupt();
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(fs::exists(half()));
}

TEST_F(UnfinishedOutputTest, ASignalThatIsIgnoredStaysSo) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGHUP, SIG_IGN);
    handleProgramSignals();
    UnfinishedOutput output(making("whole"));
    raise(SIGHUP);
    usleep(20000);
    output.finish();
    _exit(3);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 3);
  EXPECT_TRUE(fs::exists(folder.path() / "whole"));
}

TEST_F(UnfinishedOutputTest, AChildProcessIsEndedAlone) {
  const int status = statusAfter(SIGKILL, true, [&](const auto&) {
    UnfinishedOutput output(making("whole"));
    const pid_t grandchild = fork();
    if (grandchild == 0) {
      raise(SIGTERM);
      _exit(4);
    }
    int ended = 0;
    waitpid(grandchild, &ended, 0);
    if (!WIFSIGNALED(ended) || WTERMSIG(ended) != SIGTERM) _exit(5);
    output.finish();
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 3);
  EXPECT_TRUE(fs::exists(folder.path() / "whole"));
}

}  // namespace
}  // namespace saw_ndt::internal
