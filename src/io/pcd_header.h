#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt::internal {

/// A field of a PCD file: `count` values of `size` bytes and type 'F', 'U' or 'I'.
struct PcdField {
  std::string name;
  std::uint64_t size = 0;
  char type = 'F';
  std::uint64_t count = 1;
};

/// What the head of a PCD file states.
struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
};

/// Reads the head of a PCD file and compares its claims with the size of the file, so that a damaged one is refused
/// before memory is taken for it. Throws Error that names the line or the offset.
PcdHeader readPcdHeader(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
