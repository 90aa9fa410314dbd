#include "localization/place_table.h"

#include <zlib.h>

#include <algorithm>
#include <boost/endian/buffers.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <new>

namespace saw_ndt::internal {
namespace {

constexpr double kHeightStep_m = 0.01;

// What is compressed.
struct PlaceTable {
  boost::endian::little_int32_buf_t ground_cm[kPlaceTileSize * kPlaceTileSize];
  boost::endian::little_uint64_buf_t allowed[kPlaceTileSize];
  boost::endian::little_uint64_buf_t words[kPlaceLayers][kPlaceTileSize];
};

}  // namespace

std::string encodedPlaceTile(const PlaceIndex::Tile& tile) {
  const auto table = std::make_unique<PlaceTable>();
  constexpr double kGreatest = std::numeric_limits<std::int32_t>::max();
  for (std::size_t i = 0; i < tile.ground_m.size(); ++i) {
    table->ground_cm[i] = static_cast<std::int32_t>(
        std::clamp(std::round(static_cast<double>(tile.ground_m[i]) / kHeightStep_m), -kGreatest, kGreatest));
  }
  for (std::size_t row = 0; row < tile.allowed.size(); ++row) table->allowed[row] = tile.allowed[row];
  for (int layer = 0; layer < kPlaceLayers; ++layer) {
    for (int row = 0; row < kPlaceTileSize; ++row) {
      table->words[layer][row] = tile.words[static_cast<std::size_t>(layer * kPlaceTileRows + row)];
    }
  }
  uLongf size = compressBound(sizeof(PlaceTable));
  std::string bytes(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(bytes.data()), &size,
                               reinterpret_cast<const Bytef*>(table.get()), sizeof(PlaceTable), Z_BEST_COMPRESSION);
  if (status != Z_OK) throw std::bad_alloc();  // the room is enough whatever is compressed
  bytes.resize(size);
  return bytes;
}

bool decodePlaceTile(std::string_view bytes, PlaceIndex::Tile& tile) {
  const auto table = std::make_unique<PlaceTable>();
  uLongf size = sizeof(PlaceTable);
  if (uncompress(reinterpret_cast<Bytef*>(table.get()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 static_cast<uLong>(bytes.size())) != Z_OK ||
      size != sizeof(PlaceTable)) {
    return false;
  }
  for (std::size_t i = 0; i < tile.ground_m.size(); ++i) {
    tile.ground_m[i] = static_cast<float>(table->ground_cm[i].value() * kHeightStep_m);
  }
  for (std::size_t row = 0; row < tile.allowed.size(); ++row) tile.allowed[row] = table->allowed[row].value();
  for (int layer = 0; layer < kPlaceLayers; ++layer) {
    for (int row = 0; row < kPlaceTileSize; ++row) {
      tile.words[static_cast<std::size_t>(layer * kPlaceTileRows + row)] = table->words[layer][row].value();
    }
  }
  return true;
}

}  // namespace saw_ndt::internal
