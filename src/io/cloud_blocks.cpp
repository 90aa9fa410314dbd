#include "io/cloud_blocks.h"

#include <algorithm>
#include <new>

#include "common/input_file.h"
#include "io/ply_cloud.h"
#include "io/ply_header.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

CloudBlocks::CloudBlocks(const std::filesystem::path& path, std::size_t block_points)
    : path_(path), block_points_(block_points) {
  checkOption(block_points >= 1, "block_points", block_points, "1 or more");
  if (isPly(path)) {
    const PlyHeader ply = readPlyHeader(path);
    header_ = ply.cloud;
    big_endian_ = ply.big_endian;
  } else if (path.extension() == ".pcd") {
    header_ = readPcdHeader(path);
  } else {
    throw Error(path.string(), "", "the name of a point cloud must end in .pcd or .ply");
  }
  if (header_.data == PcdData::COMPRESSED) {
    if (header_.points * header_.pointBytes() > kMostUnpackedBytes) {
      throw Error(path.string(), "offset " + std::to_string(header_.data_offset),
                  "compressed points are unpacked as a whole, and " +
                      std::to_string(header_.points * header_.pointBytes()) + " bytes are more than the " +
                      std::to_string(kMostUnpackedBytes) + " allowed: a PCD file of DATA binary may have any size");
    }
    return;
  }
  stream_ = openInputFile(path);
  stream_.seekg(static_cast<std::streamoff>(header_.data_offset));
  if (header_.data == PcdData::ASCII) rows_.emplace(path_, header_, stream_);
}

bool CloudBlocks::next(PcdCloud& block) {
  first_ = read_;
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(block_points_, header_.points - read_));
  if (size == 0) return false;
  if (header_.data == PcdData::COMPRESSED) {
    takeUnpacked(block, size);
  } else {
    PcdHeader part = header_;
    part.points = part.width = size;
    part.height = 1;
    try {
      block = cloudWithoutBytes(part);
      block.bytes = rows_ ? rows_->read(size) : readCloudBytes(path_, stream_, size * header_.pointBytes());
    } catch (const std::bad_alloc&) {
      throw Error(path_.string(), "point " + std::to_string(read_), "is damaged, or too large for the memory");
    }
    if (big_endian_) reverseBytes(block);
  }
  read_ += size;
  if (read_ == header_.points && rows_) rows_->requireEnd();
  return true;
}

void CloudBlocks::takeUnpacked(PcdCloud& block, std::size_t size) {
  if (read_ == 0) unpacked_ = readPcdCloud(path_);
  block = PcdCloud();
  block.points = block.width = size;
  block.viewpoint = unpacked_.viewpoint;
  for (PcdColumn column : unpacked_.columns) {
    const unsigned char* first = unpacked_.bytes.data() + column.offset + read_ * column.stride_bytes;
    column.offset = block.bytes.size();
    block.bytes.insert(block.bytes.end(), first, first + size * column.stride_bytes);
    block.columns.push_back(column);
  }
}

}  // namespace saw_ndt::internal
