#include "common/atomic_output.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

std::string contentOf(const std::filesystem::path& path) {
  std::ostringstream content;
  content << std::ifstream(path).rdbuf();
  return content.str();
}

TEST(AtomicOutput, AppearsWholeOnCommit) {
  const TemporaryFolder folder;
  const auto target = folder.write("out.txt", "old");
  AtomicOutput output(target);
  output.stream() << "new " << 1234567 << '\n';
  output.stream().flush();
  EXPECT_EQ(contentOf(target), "old");
  output.commit();
  EXPECT_EQ(contentOf(target), "new 1234567\n");
  EXPECT_EQ(folder.entryCount(), 1U);
}

TEST(AtomicOutput, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  { AtomicOutput(folder.path() / "out.txt").stream() << "lost"; }
  EXPECT_EQ(folder.entryCount(), 0U);
}

TEST(AtomicOutput, ReplacesWhatASymbolicLinkPointsTo) {
  const TemporaryFolder folder;
  const auto target = folder.write("real.txt", "old");
  const auto link = folder.path() / "link.txt";
  std::filesystem::create_symlink("real.txt", link);
  AtomicOutput output(link);
  output.stream() << "new";
  output.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(contentOf(target), "new");
}

TEST(AtomicOutput, NamesTargetAndReasonOfFailure) {
  const TemporaryFolder folder;
  const auto missing = folder.path() / "missing" / "out.txt";
  expectThrows<Error>([&] { AtomicOutput output(missing); }, {missing.string(), "No such file or directory"});
  expectThrows<Error>([&] { AtomicOutput output(folder.path()); }, {folder.path().string(), "Is a directory"});
  expectThrows<Error>([&] { AtomicOutput output("/dev/null"); }, {"/dev/null", "no regular file"});
}

TEST(AtomicOutput, ReportsAFailedWriteAndKeepsTheOldFile) {
  const TemporaryFolder folder;
  const auto target = folder.write("out.txt", "old");
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit = old_limit;
  limit.rlim_cur = 1 << 16;
  setrlimit(RLIMIT_FSIZE, &limit);
  expectThrows<Error>(
      [&] {
        AtomicOutput output(target);
        output.stream() << std::string(1 << 20, 'x');
        errno = 0;
        output.commit();
      },
      {target.string(), "File too large"});
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(contentOf(target), "old");
  EXPECT_EQ(folder.entryCount(), 1U);
}

TEST(AtomicOutput, KeepsTheModeOfWhatItReplaces) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const auto target = folder.write("out.txt", "old");
  for (const auto mode : {fs::perms::owner_read | fs::perms::owner_write, fs::perms(0640), fs::perms(0666)}) {
    fs::permissions(target, mode);
    AtomicOutput output(target);
    EXPECT_EQ(fs::status(output.temporary()).permissions(), mode);  // nobody else can look on either
    output.stream() << "new";
    output.commit();
    EXPECT_EQ(fs::status(target).permissions(), mode);
  }
  EXPECT_EQ(contentOf(target), "new");
}

TEST(AtomicOutput, TakesNamesOfAnyLengthThatFilesMayHave) {
  const TemporaryFolder folder;
  const std::string letters = "\u00fc\u4e2d";  // of two and three bytes
  std::string of_letters = "x";
  while (of_letters.size() + letters.size() <= 250) of_letters += letters;
  for (const std::string& name : {std::string(250, 'a'), std::string(255, 'b'), of_letters}) {
    AtomicOutput output(folder.path() / name);
    output.stream() << "new";
    output.commit();
    EXPECT_EQ(contentOf(folder.path() / name), "new");
  }
  // Two names that begin alike are not taken for each other.
  AtomicOutput a(folder.path() / (std::string(249, 'c') + "1")), b(folder.path() / (std::string(249, 'c') + "2"));
  EXPECT_NE(a.temporary(), b.temporary());
  expectThrows<Error>([&] { AtomicOutput output(folder.path() / std::string(256, 'd')); }, {"File name too long"});
}

TEST(AtomicOutput, OfTheSameTargetAtOnceTheLastOneStays) {
  const TemporaryFolder folder;
  const auto target = folder.path() / "out.txt";
  AtomicOutput first(target), second(target);
  first.stream() << "first";
  second.stream() << "second";
  second.commit();
  EXPECT_EQ(contentOf(target), "second");
  first.commit();
  EXPECT_EQ(contentOf(target), "first");
  EXPECT_EQ(folder.entryCount(), 1U);
}

TEST(AtomicOutput, WritesAtAnyPlace) {
  const TemporaryFolder folder;
  AtomicOutput output(folder.path() / "out.txt");
  output.stream().seekp(5);
  output.stream() << std::string(200000, 'x') << "end";
  EXPECT_EQ(output.stream().tellp(), 200008);
  output.stream().seekp(0);
  output.stream() << "begin";
  output.commit();
  EXPECT_EQ(contentOf(folder.path() / "out.txt"), "begin" + std::string(200000, 'x') + "end");
}

TEST(AtomicOutput, NamesNoFileIsRefusedBeforeAnythingIsWritten) {
  expectThrows<Error>([] { AtomicOutput output(""); }, {"No such file"});
}

}  // namespace
}  // namespace saw_ndt
