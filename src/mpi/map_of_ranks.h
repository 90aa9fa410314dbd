#pragma once

#include <boost/mpi/communicator.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "drives/drive_plan.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/recording.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt::internal {

/// What a rank has done for a map.
struct RankWork {
  std::uint64_t scans = 0;       ///< added
  std::uint64_t bytes_sent = 0;  ///< of sums, to other ranks
};

/// A map, each tile of which one rank keeps.
struct MapOfRanks {
  WeightedMapBuilder owned;  ///< the tiles of this rank
  /// Of the whole map. Like the rest, on rank 0 alone.
  MapOrigin origin;
  std::vector<std::string> left_out;  ///< reasons of scans that were left out, in the order of the alphabet
  std::vector<RankWork> work;         ///< of each rank
};

/// Tells the plans of all drives, which are those of rank 0, to the other ranks, but for the numbers of scans.
/// @throws Error where a rank is of another version of this program
std::vector<DrivePlan> toldPlans(const boost::mpi::communicator& ranks, std::vector<DrivePlan> plans);

/// Builds the map of several drives with all ranks of a communicator: rank 0 deals out the scans, every rank reads
/// those that it is given, and their sums go to the ranks that own their tiles. To be called by all ranks; `plans` are
/// those of toldPlans(). The sums do not depend on the ranks.
/// @param open       every rank must be able to open every drive; called by a thread of its own
/// @param common     as for buildDriveMap(), the same for all drives; where scan_left_out is set, its place is taken by
///                   MapOfRanks::left_out
/// @param spill_folder  where a rank keeps what is more than kMostEntriesInMemory of its tiles in a temporary file
/// @param scan_done  called on rank 0 after each scan of any rank; may be empty
/// @throws whatever goes wrong on this rank; others do not learn of it. Error on rank 0 where no scan is left
MapOfRanks buildMapOfRanks(const boost::mpi::communicator& ranks, const std::vector<DrivePlan>& plans,
                           const DriveOpener& open, const DriveMapOptions& common,
                           const std::filesystem::path& spill_folder, const std::function<void()>& scan_done);

}  // namespace saw_ndt::internal
