#pragma once

#include <cstdint>
#include <filesystem>

#include "io/pcd_header.h"

namespace saw_ndt::internal {

/// What the head of a PLY file states of its vertices.
struct PlyHeader {
  PcdHeader cloud;  ///< as that of a PCD file, ASCII or BINARY, its data offset that of the first vertex
  bool big_endian = false;
};

/// Reads the head of a PLY file, checks all of it and compares its claims with the size of the file. Throws Error that
/// names the line or the offset, also where vertices have lists of numbers or stand behind elements that have.
PlyHeader readPlyHeader(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
