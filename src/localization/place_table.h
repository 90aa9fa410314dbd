#pragma once

#include <string>
#include <string_view>

#include "localization/place_index.h"

namespace saw_ndt::internal {

/// A tile of a place index as the search table of a localization map: compressed by zlib, heights to a centimetre.
std::string encodedPlaceTile(const PlaceIndex::Tile& tile);

/// Sets all of a tile but where it lies and its repeated rows. @return false where the bytes are no such table
bool decodePlaceTile(std::string_view bytes, PlaceIndex::Tile& tile);

}  // namespace saw_ndt::internal
