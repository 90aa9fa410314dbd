#include "io/pcd_cloud.h"

#include <pcl/io/lzf.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <new>

#include "common/atomic_output.h"
#include "common/input_file.h"
#include "io/pcd_ascii.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr char kPadding[] = "_";
constexpr char kTooLarge[] = "is damaged, or too large for the memory";

bool equalButForCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

std::vector<unsigned char> readCompressed(const std::filesystem::path& path, std::istream& stream) {
  std::uint32_t sizes[2] = {0, 0};
  stream.read(reinterpret_cast<char*>(sizes), sizeof(sizes));
  const std::vector<unsigned char> compressed = readCloudBytes(path, stream, sizes[0]);
  std::vector<unsigned char> bytes(sizes[1]);
  if (pcl::lzfDecompress(compressed.data(), sizes[0], bytes.data(), sizes[1]) != sizes[1]) {
    throw Error(path.string(), "", "is damaged: the compressed data do not give the bytes that they should");
  }
  return bytes;
}

std::string headerText(const PcdCloud& cloud, const std::vector<PcdColumn>& columns) {
  std::ostringstream names, sizes, types, counts, text;
  for (const PcdColumn& column : columns) {
    names << ' ' << column.field.name;
    sizes << ' ' << column.field.size;
    types << ' ' << column.field.type;
    counts << ' ' << column.field.count;
  }
  text.precision(std::numeric_limits<float>::max_digits10);
  text << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" << names.str() << "\nSIZE" << sizes.str()
       << "\nTYPE" << types.str() << "\nCOUNT" << counts.str() << "\nWIDTH " << cloud.width << "\nHEIGHT "
       << cloud.height << "\nVIEWPOINT";
  for (const float value : cloud.viewpoint) text << ' ' << value;
  text << "\nPOINTS " << cloud.points << "\nDATA binary_compressed\n";
  return text.str();
}

}  // namespace

const PcdColumn* PcdCloud::find(const std::vector<std::string_view>& names) const {
  for (const std::string_view name : names) {
    for (const PcdColumn& column : columns) {
      if (column.field.count > 0 && equalButForCase(column.field.name, name)) return &column;
    }
  }
  return nullptr;
}

void PcdCloud::remove(const std::string& name) {
  columns.erase(std::remove_if(columns.begin(), columns.end(),
                               [&](const PcdColumn& column) { return column.field.name == name; }),
                columns.end());
}

PcdCloud cloudWithoutBytes(const PcdHeader& header) {
  PcdCloud cloud;
  cloud.points = header.points;
  cloud.width = header.width;
  cloud.height = header.height;
  cloud.viewpoint = header.viewpoint;
  // Compressed files have one field after the other, the others one point after the other.
  const bool by_field = header.data == PcdData::COMPRESSED;
  const std::size_t point_bytes = header.pointBytes();
  std::size_t offset = 0;
  for (const PcdField& field : header.fields) {
    cloud.columns.push_back({field, offset, by_field ? field.bytes() : point_bytes});
    offset += field.bytes() * (by_field ? cloud.points : 1);
  }
  return cloud;
}

std::vector<unsigned char> readCloudBytes(const std::filesystem::path& path, std::istream& stream, std::uint64_t size) {
  std::vector<unsigned char> bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream) throw Error(path.string(), "", "could not be read on");
  return bytes;
}

PcdCloud cloudOfRows(const std::filesystem::path& path, const PcdHeader& header, std::istream& stream) {
  PcdCloud cloud = cloudWithoutBytes(header);
  try {
    cloud.bytes = header.data == PcdData::ASCII ? readPcdAscii(path, header, stream)
                                                : readCloudBytes(path, stream, cloud.points * header.pointBytes());
  } catch (const std::bad_alloc&) {
    throw Error(path.string(), "", kTooLarge);
  }
  return cloud;
}

PcdCloud readPcdCloud(const std::filesystem::path& path) {
  const PcdHeader header = readPcdHeader(path);
  std::ifstream stream = openInputFile(path);
  stream.seekg(static_cast<std::streamoff>(header.data_offset));
  if (header.data != PcdData::COMPRESSED) return cloudOfRows(path, header, stream);
  PcdCloud cloud = cloudWithoutBytes(header);
  try {
    cloud.bytes = readCompressed(path, stream);
  } catch (const std::bad_alloc&) {
    throw Error(path.string(), "", kTooLarge);
  }
  return cloud;
}

void writePcdCloud(const std::filesystem::path& path, const PcdCloud& cloud) {
  std::vector<PcdColumn> columns;
  std::uint64_t point_bytes = 0;
  for (const PcdColumn& column : cloud.columns) {
    if (column.field.name == kPadding || column.field.count == 0) continue;
    columns.push_back(column);
    point_bytes += column.field.bytes();
  }
  if (cloud.points == 0) throw Error(path.string(), "", "a cloud without points cannot be written as PCD");
  constexpr std::uint64_t kGreatestBytes = std::numeric_limits<std::uint32_t>::max() / 2;
  const std::uint64_t size = cloud.points * point_bytes;
  if (size > kGreatestBytes) throw Error(path.string(), "", "the cloud is too large for a compressed PCD file");

  std::vector<unsigned char> planes;
  planes.reserve(size);
  for (const PcdColumn& column : columns) {
    const unsigned char* at = cloud.bytes.data() + column.offset;
    for (std::size_t point = 0; point < cloud.points; ++point, at += column.stride_bytes) {
      planes.insert(planes.end(), at, at + column.field.bytes());
    }
  }
  // What cannot be compressed grows by a byte in 32.
  std::vector<unsigned char> compressed(size + size / 16 + 64);
  const unsigned int compressed_size = pcl::lzfCompress(
      planes.data(), static_cast<unsigned int>(size), compressed.data(), static_cast<unsigned int>(compressed.size()));
  if (compressed_size == 0) throw Error(path.string(), "", "the cloud could not be compressed");
  const std::uint32_t sizes[2] = {compressed_size, static_cast<std::uint32_t>(size)};

  AtomicOutput output(path);
  output.stream() << headerText(cloud, columns);
  output.stream().write(reinterpret_cast<const char*>(sizes), sizeof(sizes));
  output.stream().write(reinterpret_cast<const char*>(compressed.data()), compressed_size);
  output.commit();
}

}  // namespace saw_ndt::internal
