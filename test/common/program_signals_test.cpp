#include "common/program_signals.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <iterator>
#include <string>

#include "common/mapped_file.h"
#include "common/unfinished_output.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

/// How a child process ends in which something is done.
template <typename Work>
int statusOf(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    handleProgramSignals();
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(ProgramSignals, AFileThatIsCutShortWhileItIsMappedIsNamed) {
  const TemporaryFolder folder;
  const std::string file = folder.write("mapped file.map", std::string(100000, 'x')).string();
  const std::string errors = (folder.path() / "errors").string();
  const int status = statusOf([&] {
    const UnfinishedOutput output([&] { return folder.write("half", "half"); });
    dup2(open(errors.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    const MappedFile mapped(file);
    std::filesystem::resize_file(file, 10);
    volatile char last = mapped.data()[mapped.size() - 1];
    static_cast<void>(last);
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGBUS);
  std::ifstream stream(errors);
  const std::string told{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(told.find("mapped file.map: cannot be read on: it was cut short"), std::string::npos) << told;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "half"));
}

TEST(ProgramSignals, AFileThatGetsTooLargeIsAnErrorOfTheWrite) {
  const TemporaryFolder folder;
  const int status = statusOf([&] {
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const int descriptor = open((folder.path() / "file").c_str(), O_WRONLY | O_CREAT, 0600);
    const std::string bytes(2000, 'x');
    if (write(descriptor, bytes.data(), bytes.size()) != 1000) _exit(1);
    if (write(descriptor, bytes.data(), bytes.size()) != -1 || errno != EFBIG) _exit(2);
  });
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace saw_ndt::internal
