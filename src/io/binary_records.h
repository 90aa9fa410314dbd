#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "common/input_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

/// Throws the Error of a file whose last record is cut short.
inline void requireWholeRecords(const std::filesystem::path& path, std::size_t size, std::size_t record_bytes) {
  if (size % record_bytes == 0) return;
  throw Error(path.string(), "offset " + std::to_string(size - size % record_bytes),
              "the last point is cut short: " + std::to_string(size) + " bytes is no multiple of " +
                  std::to_string(record_bytes));
}

/// Reads the whole records of a binary file without a header, into memory that `values` may bring along. Throws Error
/// where it is missing or empty.
/// @return the size of the file, which may end within a record
template <typename Value>
std::size_t readWholeRecords(const std::filesystem::path& path, std::vector<Value>& values) {
  std::ifstream stream = openInputFile(path);
  stream.seekg(0, std::ios::end);
  const std::streamoff end = stream.tellg();
  if (end < 0) throw Error(path.string(), "", "its size cannot be told");
  const auto size = static_cast<std::size_t>(end);
  if (size == 0) throw Error(path.string(), "offset 0", "the file is empty");
  values.resize(size / sizeof(Value));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(Value)));
  if (!stream) throw Error(path.string(), "offset " + std::to_string(stream.gcount()), "could not be read on");
  return size;
}

/// The same; Error where the last record is cut short.
template <typename Value>
void readRecords(const std::filesystem::path& path, std::vector<Value>& values) {
  requireWholeRecords(path, readWholeRecords(path, values), sizeof(Value));
}

}  // namespace saw_ndt::internal
