#pragma once

#include <boost/mpi/communicator.hpp>
#include <cstdint>
#include <string>

#include "mpi/map_of_ranks.h"

namespace saw_ndt::internal {

/// Writes the map that ranks keep together into one file, each rank its own tiles at their places: the same bytes as
/// those of one builder with all sums. To be called by all ranks, which must see the same folder. The file appears when
/// it is whole; where a rank fails, or is ended by a signal
/// and the program asked for that (see handleProgramSignals()), nothing is left behind.
/// @return how many voxels of this rank's tiles have a distribution
/// @throws Error where this rank cannot write; others do not learn of it
std::uint64_t writeMapOfRanks(const boost::mpi::communicator& ranks, const std::string& path, const MapOfRanks& map);

}  // namespace saw_ndt::internal
