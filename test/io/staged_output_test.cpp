#include "io/staged_output.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class StagedOutputTest : public ::testing::Test {
 protected:
  /// Two files, one of them in folders of its own.
  static void fill(const StagedOutput& staged) {
    std::ofstream(staged.folder() / "a.txt") << "new";
    fs::create_directories(staged.folder() / "b" / "c");
    std::ofstream(staged.folder() / "b" / "c" / "d.txt") << "deep";
  }

  TemporaryFolder folder;
};

TEST_F(StagedOutputTest, FilesAppearTogetherAndOthersStay) {
  folder.write("a.txt", "old");
  folder.write("b/other.txt", "other");
  {
    StagedOutput staged(folder.path());
    fill(staged);
    EXPECT_EQ(contentOf(folder.path() / "a.txt"), "old");
    staged.commit();
  }
  EXPECT_EQ(contentOf(folder.path() / "a.txt"), "new");
  EXPECT_EQ(contentOf(folder.path() / "b" / "c" / "d.txt"), "deep");
  EXPECT_EQ(contentOf(folder.path() / "b" / "other.txt"), "other");
  EXPECT_EQ(folder.entryCount(), 2U);
}

TEST_F(StagedOutputTest, LeavesNothingWithoutCommit) {
  fill(StagedOutput(folder.path()));
  EXPECT_EQ(folder.entryCount(), 0U);
}

TEST_F(StagedOutputTest, NothingIsMovedWhereANameIsTaken) {
  fs::create_directories(folder.path() / "b" / "c" / "d.txt");
  {
    StagedOutput staged(folder.path());
    fill(staged);
    expectThrows<Error>([&] { staged.commit(); }, {"d.txt: is a folder"});
  }
  EXPECT_FALSE(fs::exists(folder.path() / "a.txt"));
  fs::remove_all(folder.path() / "b");
  folder.write("b", "a file");
  {
    StagedOutput staged(folder.path());
    fill(staged);
    expectThrows<Error>([&] { staged.commit(); }, {"b: Not a directory"});
  }
  EXPECT_FALSE(fs::exists(folder.path() / "a.txt"));
  EXPECT_EQ(folder.entryCount(), 1U);
}

TEST_F(StagedOutputTest, FilesThatAreReplacedLeaveTheirModes) {
  folder.write("a.txt", "old");
  fs::permissions(folder.path() / "a.txt", fs::perms(0600));
  StagedOutput staged(folder.path());
  fill(staged);
  staged.commit();
  EXPECT_EQ(contentOf(folder.path() / "a.txt"), "new");
  EXPECT_EQ(fs::status(folder.path() / "a.txt").permissions(), fs::perms(0600));
}

TEST_F(StagedOutputTest, WhatAKilledProcessLeftGoesWithTheNextOne) {
  const pid_t child = fork();
  if (child == 0) {
    StagedOutput staged(folder.path());
    fill(staged);
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ASSERT_EQ(folder.entryCount(), 1U);
  {
    StagedOutput staged(folder.path());
    EXPECT_EQ(folder.entryCount(), 1U);
    fill(staged);
    staged.commit();
  }
  EXPECT_EQ(folder.entryCount(), 2U);
}

TEST_F(StagedOutputTest, AFolderThatIsMissingIsNamed) {
  expectThrows<Error>([&] { const StagedOutput staged(folder.path() / "none"); }, {"none: No such file"});
}

}  // namespace
}  // namespace saw_ndt
