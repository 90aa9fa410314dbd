#include <iostream>
#include <optional>

#include "app_options.h"
#include "common/atomic_output.h"
#include "progress_bar.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/localization/map_pack.h"

namespace {

constexpr char kDescription[] =
    "Derives the map that a vehicle carries from the statistics map of saw_ndt_build_map: ready to localize in, some "
    "32 bytes a voxel and 4 for the search, in tiles of 64 m. saw_ndt_localize then holds the tiles around the vehicle "
    "alone, whatever the size of the map. It serves one weighting: the method it is packed for, and others whose "
    "voxels "
    "are weighted alike. It cannot be merged or cropped: keep the statistics map.";

}  // namespace

int main(int argc, char** argv) {
  std::string map_file, packed_file, method = "weighted";
  saw_ndt::AppOptions app("saw_ndt_map_pack", kDescription);
  app.addPositional("MAP", &map_file, "statistics map of saw_ndt_build_map");
  app.addPositional("OUT", &packed_file, "localization map to write");
  app.addChoice("method", &method, saw_ndt::LocalizationMethod::names(), "of saw_ndt_localize that it is for");

  return saw_ndt::runApp(argc, argv, app, [&] {
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    { const saw_ndt::internal::AtomicOutput probe(packed_file); }
    std::optional<saw_ndt::ProgressBar> progress;
    std::size_t shown = 0;
    saw_ndt::packMap(map_file, packed_file, saw_ndt::LocalizationMethod::named(method).voxels, app.threads(),
                     [&](std::size_t done, std::size_t of) {
                       if (!progress) progress.emplace(of);
                       for (; shown < done; ++shown) progress->step();
                     });
    progress.reset();
    const saw_ndt::LocalizationMap packed(packed_file);
    const std::uint64_t voxel_count = packed.voxelCount() + packed.coarseVoxelCount();
    std::cout << packed_file << ": " << packed.voxelCount() << " voxels and " << packed.coarseVoxelCount()
              << " coarse ones in " << packed.tileCount() << " tiles, " << packed.fileSize() << " bytes";
    if (voxel_count > 0) {
      std::cout << ", " << static_cast<double>(packed.fileSize()) / static_cast<double>(voxel_count) << " a voxel";
    }
    std::cout << '\n';
  });
}
