#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {

/// A file that holds one input after the other. Memory serves where TMPDIR says so, such as /dev/shm.
class FuzzedFile {
 public:
  /// @param name  which readers tell the kind of file by
  explicit FuzzedFile(const std::string& name);
  ~FuzzedFile();
  FuzzedFile(const FuzzedFile&) = delete;
  FuzzedFile& operator=(const FuzzedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Calls read(path) with a file of these bytes. It may throw an Error of one printable line that names the file, and
  /// nothing else.
  template <typename Read>
  void tryReading(const std::uint8_t* bytes, std::size_t size, Read read) {
    write(bytes, size);
    try {
      read(path_);
    } catch (const Error& error) {
      requireUsefulMessage(error.what());
    }
  }

 private:
  void write(const std::uint8_t* bytes, std::size_t size);
  void requireUsefulMessage(const std::string& message) const;

  TemporaryFolder folder_;
  std::filesystem::path path_;
  int descriptor_;
};

/// Ends the process where a property does not hold, so that the fuzzer keeps the input.
void require(bool holds, const char* property);

}  // namespace saw_ndt
