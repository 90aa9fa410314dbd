#include "fuzzed_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace saw_ndt {

FuzzedFile::FuzzedFile(const std::string& name)
    : path_(folder_.path() / name), descriptor_(open(path_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600)) {
  require(descriptor_ >= 0, "the file of inputs can be written");
}

FuzzedFile::~FuzzedFile() { close(descriptor_); }

void FuzzedFile::write(const std::uint8_t* bytes, std::size_t size) {
  require(ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, bytes, size, 0) == static_cast<ssize_t>(size),
          "the input can be written");
}

void FuzzedFile::requireUsefulMessage(const std::string& message) const {
  constexpr std::size_t kLongestMessage = 2000;
  require(message.find(path_.filename().string()) != std::string::npos, "an error names the file");
  require(message.size() < kLongestMessage, "an error is not too long to read");
  for (const char character : message) {
    const auto code = static_cast<unsigned char>(character);
    require(code >= 0x20 && code != 0x7F, "an error is one line of printable text");
  }
}

void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", property);
  std::abort();
}

}  // namespace saw_ndt
