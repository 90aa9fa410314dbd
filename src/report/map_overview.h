#pragma once

#include <string>
#include <vector>

#include "report/gnuplot.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// A voxel of a map, of whatever kind the map is, as it is shown in pictures.
struct OverviewVoxel {
  VoxelCoordinate voxel = VoxelCoordinate::Zero();
  double height_m = 0.0;  ///< z of its mean, map frame
  StructuralLabel label = StructuralLabel::NON_GROUND;
  StructureClass structure_class = StructureClass::VOLUMETRIC;
  double weight = 0.0;
};

/// The voxels that have a distribution with the default weighting, in map order.
std::vector<OverviewVoxel> overviewVoxels(const WeightedVoxelMap& map);

/// What the colour of a voxel tells.
enum class OverviewColour { LABEL, CLASS, WEIGHT, HEIGHT };

/// "label", "class", "weight" or "height"
std::string toString(OverviewColour colour);

/// A map seen from above: the colour of the topmost voxel at every place, with axes in metres of one scale.
/// @param title  of the picture
GnuplotPicture overviewPicture(const std::vector<OverviewVoxel>& voxels, double resolution_m, OverviewColour colour,
                               const std::string& title);

}  // namespace saw_ndt
