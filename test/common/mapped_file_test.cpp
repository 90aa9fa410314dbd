#include "common/mapped_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>
#include <string>

#include "common/growing_file.h"
#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

std::string randomBytes(std::size_t size) {
  std::mt19937 random(1);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

std::string contentOf(const MappedFile& file) { return {file.data(), file.size()}; }

TEST(MappedFile, HoldsTheBytesOfTheFile) {
  const TemporaryFolder folder;
  for (const std::size_t size : {std::size_t{1}, std::size_t{4095}, std::size_t{4096}, std::size_t{100001}}) {
    const std::string bytes = randomBytes(size);
    EXPECT_TRUE(contentOf(MappedFile(folder.write("a", bytes).string())) == bytes);
  }
  EXPECT_EQ(MappedFile(folder.write("a", "").string()).size(), 0U);
}

TEST(MappedFile, ForgettingChangesNothingThatIsRead) {
  const TemporaryFolder folder;
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const std::string bytes = randomBytes(20 * page + 7);
  const MappedFile file(folder.write("a", bytes).string());
  for (const std::uint64_t offset : {std::uint64_t{0}, page - 1, page, 3 * page + 5, 20 * page, 20 * page + 6}) {
    for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{1}, page, 2 * page + 1, 100 * page}) {
      file.forget(offset, count);
      ASSERT_TRUE(contentOf(file) == bytes);
    }
  }
  MappedFile(folder.write("empty", "").string()).forget(0, 1);
}

TEST(MappedFile, ErrorsNameTheFile) {
  const TemporaryFolder folder;
  expectThrows<Error>([&] { MappedFile((folder.path() / "none").string()); }, {"none: No such file"});
  expectThrows<Error>([&] { MappedFile(folder.path().string()); }, {folder.path().string() + ": Is a directory"});
}

TEST(MappedFile, OfAFileThatIsReplacedStaysWhatItWas) {
  const TemporaryFolder folder;
  const MappedFile file(folder.write("a", "old").string());
  std::filesystem::rename(folder.write("b", "newer"), folder.path() / "a");
  EXPECT_EQ(contentOf(file), "old");
}

TEST(GrowingFile, WritesAnywhereAndLeavesTheRest) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", "0123456789").string();
  {
    GrowingFile file(path);
    file.write(2, "ab", 2);
    file.write(12, "end", 3);
    file.sync();
    EXPECT_EQ(contentOf(MappedFile(path)), std::string("01ab456789\0\0end", 15));
    file.resize(5);
    file.requireStillThere();
  }
  EXPECT_EQ(contentOf(MappedFile(path)), "01ab4");
}

TEST(GrowingFile, IsForOneAtATime) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", "x").string();
  {
    const GrowingFile file(path);
    expectThrows<Error>([&] { GrowingFile{path}; }, {"a: is being changed by another process"});
  }
  GrowingFile file(path);
  folder.write("b", "y");
  std::filesystem::rename(folder.path() / "b", path);
  expectThrows<Error>([&] { file.requireStillThere(); }, {"a: was replaced by another process"});
}

}  // namespace
}  // namespace saw_ndt::internal
