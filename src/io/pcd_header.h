#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt::internal {

/// A field of a PCD file: `count` values of `size` bytes (1, 2, 4 or 8) and type 'F', 'U' or 'I'.
struct PcdField {
  std::string name;
  std::uint64_t size = 0;
  char type = 'F';
  std::uint64_t count = 1;

  /// All values of a point.
  std::uint64_t bytes() const { return size * count; }
};

/// How a PCD file holds its points.
enum class PcdData { ASCII, BINARY, COMPRESSED };

/// What the head of a PCD file states. `width` times `height` is `points`.
struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0, width = 0, height = 1;
  std::array<float, 7> viewpoint = {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F};  ///< x y z qw qx qy qz
  PcdData data = PcdData::BINARY;
  std::uint64_t data_offset = 0;  ///< of the first byte behind the head
  std::size_t lines = 0;          ///< of the head
  bool others_follow = false;     ///< whether something else may stand behind the points

  /// Bytes of a point.
  std::uint64_t pointBytes() const;
};

/// Reads the head of a PCD file, checks all of it and compares its claims with the size of the file, so that a damaged
/// one is refused before memory is taken for it. A width or height of 0 beside points is an unorganized cloud. Throws
/// Error that names the line or the offset.
PcdHeader readPcdHeader(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
