#include "common/claimed_name.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>
#include <system_error>
#include <thread>
#include <vector>

#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

namespace fs = std::filesystem;

class ClaimedNameTest : public ::testing::Test {
 protected:
  fs::path stem() const { return folder.path() / "a.tmp"; }

  /// Lets a child process claim names and kills it.
  void claimInAKilledProcess(int files, bool a_folder) const {
    const pid_t child = fork();
    if (child == 0) {
      std::vector<ClaimedName> names;
      for (int i = 0; i < files; ++i) names.push_back(ClaimedName::ofFile(stem(), 0666));
      if (a_folder) names.push_back(ClaimedName::ofFolder(folder.path() / ".staged"));
      if (a_folder) std::ofstream(names.back().path() / "within") << "half";
      raise(SIGKILL);
    }
    waitpid(child, nullptr, 0);
  }

  TemporaryFolder folder;
};

TEST_F(ClaimedNameTest, EachIsAnother) {
  const ClaimedName a = ClaimedName::ofFile(stem(), 0666), b = ClaimedName::ofFile(stem(), 0666);
  EXPECT_NE(a.path(), b.path());
  EXPECT_TRUE(fs::exists(a.path()) && fs::exists(b.path()));
}

TEST_F(ClaimedNameTest, WhatAKilledProcessLeftGoesAndWhatIsInUseStays) {
  const ClaimedName in_use = ClaimedName::ofFile(stem(), 0666);
  claimInAKilledProcess(3, false);
  ASSERT_EQ(folder.entryCount(), 4U);
  const ClaimedName next = ClaimedName::ofFile(stem(), 0666);
  EXPECT_EQ(folder.entryCount(), 2U);
  EXPECT_TRUE(fs::exists(in_use.path()));
  EXPECT_NE(in_use.path(), next.path());
}

TEST_F(ClaimedNameTest, AFolderThatAKilledProcessLeftGoesWithAllThatIsInIt) {
  claimInAKilledProcess(0, true);
  ASSERT_EQ(folder.entryCount(), 1U);
  const ClaimedName next = ClaimedName::ofFolder(folder.path() / ".staged");
  EXPECT_EQ(folder.entryCount(), 1U);
  EXPECT_TRUE(fs::is_empty(next.path()));
}

TEST_F(ClaimedNameTest, WhatIsNoFileOfAWriterStays) {
  fs::create_directory(folder.path() / "a.tmp-0");
  fs::create_symlink("/dev/null", folder.path() / "a.tmp-1");
  folder.write(".staged-0", "a file");
  const ClaimedName file = ClaimedName::ofFile(stem(), 0666);
  const ClaimedName staged = ClaimedName::ofFolder(folder.path() / ".staged");
  EXPECT_EQ(folder.entryCount(), 5U);
}

TEST_F(ClaimedNameTest, ManyAtOnceGetNamesOfTheirOwn) {
  constexpr int kThreads = 8, kNames = 25;
  std::vector<std::vector<ClaimedName>> names(kThreads);
  std::vector<std::thread> threads;
  for (std::vector<ClaimedName>& own : names) {
    threads.emplace_back([&] {
      for (int i = 0; i < kNames; ++i) own.push_back(ClaimedName::ofFile(stem(), 0666));
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<fs::path> paths;
  for (const std::vector<ClaimedName>& own : names) {
    for (const ClaimedName& name : own) {
      EXPECT_TRUE(paths.insert(name.path()).second) << name.path();
      EXPECT_TRUE(fs::exists(name.path())) << name.path();
    }
  }
}

TEST_F(ClaimedNameTest, TellsTheReasonOfTheSystem) {
  EXPECT_THROW(ClaimedName::ofFile(folder.path() / "none" / "a", 0666), std::system_error);
  EXPECT_THROW(ClaimedName::ofFolder(folder.path() / "none" / "a"), std::system_error);
}

}  // namespace
}  // namespace saw_ndt::internal
