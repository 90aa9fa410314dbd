#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <future>
#include <optional>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/localization_map.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt {

/// Which tiles of a localization map are kept in memory.
struct SAW_NDT_EXPORT TiledTargetOptions {
  double radius_m = 100.0;     ///< around the vehicle; points of scans that lie farther away are left out
  double hysteresis_m = 20.0;  ///< how far the vehicle goes until others are needed
  double lookahead_s = 3.0;    ///< how long before that they are loaded, no further ahead than hysteresis_m
  /// Bound of the memory of the voxels around one place (bytes); two such sets are there while one is loaded. Where it
  /// would be exceeded the radius is smaller, and points of scans beyond it meet no voxels.
  std::size_t most_bytes = std::size_t{256} << 20U;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// What became of loading tiles.
struct TileLoads {
  std::size_t loads = 0;         ///< sets of tiles that were loaded
  std::size_t wide_loads = 0;    ///< of them, those that reach farther, to compare a pose in doubt; scans waited
  std::size_t waits = 0;         ///< of the others, those that had to be waited for, but for the first
  double longest_wait_ms = 0.0;  ///< but for the first
  double first_load_ms = 0.0;
  double longest_load_ms = 0.0;
  double least_radius_m = 0.0;  ///< the smallest that the bound of memory left; 0: it was not in the way
};

/// The target that scans are registered to as a vehicle moves: of a localization map the tiles around it, of any other
/// target all of it. Every target that it gives out has all voxels that a scan there can meet, so that poses are the
/// same bits as in the whole map, of scans that reach no farther than reach(). Tiles ahead are loaded by a thread of
/// its own. Copies share what is in memory, and then go ways of their own; one object is not to be shared by threads.
class SAW_NDT_EXPORT TiledTarget {
 public:
  /// All of a target, everywhere.
  TiledTarget(const NdtTarget& whole);  // NOLINT(google-explicit-constructor): either serves
  /// @throws std::invalid_argument where an option does not hold
  explicit TiledTarget(const LocalizationMap& map, const TiledTargetOptions& options = {});

  /// The target of a map file of either kind.
  /// @param threads  0: all cores
  /// @throws as NdtTarget::load() and LocalizationMap, Error where that was packed for another weighting
  static TiledTarget open(const std::string& path, const VoxelWeighting& weighting,
                          const TiledTargetOptions& options = {}, int threads = 0);

  const MapOrigin& origin() const;
  const VoxelWeighting& weighting() const;
  bool labelled() const { return origin().labelled; }
  /// The map that tiles are taken from; nothing for a whole target.
  const std::optional<LocalizationMap>& map() const { return map_; }
  /// How far the points of a scan may lie from the base, horizontally (m): infinite for a whole target.
  double reach() const;

  /// What a scan is registered to, taken at a position in the map frame (m) or some metres away from it. Waits for
  /// tiles that are not in memory. @throws Error where a tile is damaged
  /// @param reach_m  greatest horizontal distance of what is asked for; tiles reach as far as reach() in any case
  NdtTarget at(const Eigen::Vector3d& position_m, double reach_m);
  /// Begins to load tiles that will be needed soon, without waiting.
  void loadAhead(const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_mps);

  const TileLoads& loads() const { return loads_; }

 private:
  // Tiles around a centre.
  struct Window {
    Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;         // as asked for
    double loaded_radius_m = 0.0;  // less where memory is bound
    double load_ms = 0.0;
    NdtTarget target;

    bool covers(const Eigen::Vector2d& position_m, double reach_m) const {
      return (position_m - centre_m).norm() + reach_m <= radius_m;
    }
  };
  // One that is being loaded.
  struct Loading {
    Window plan;  // without target
    std::shared_future<Window> window;
  };

  static Window loaded(const LocalizationMap& map, Window plan, std::size_t most_bytes, int threads);
  double neededReach(double reach_m) const;
  Window planAround(const Eigen::Vector2d& centre_m, double needed_m) const;
  void begin(const Window& plan);
  const NdtTarget& take(Window window);

  TiledTargetOptions options_;
  std::optional<NdtTarget> whole_;
  std::optional<LocalizationMap> map_;
  std::optional<Window> window_;  // the one in use
  std::optional<Loading> ahead_;
  double largest_voxel_m_ = 0.0;
  TileLoads loads_;
};

}  // namespace saw_ndt
