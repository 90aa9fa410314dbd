#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"

namespace saw_ndt {

// What goes wrong within a scan. Each of these changes the points of one.

/// Something hides all that lies in a sector.
/// @param start_rad  azimuth of its beginning, counter-clockwise
/// @param share      of the full turn
void blockSector(std::vector<LidarPoint>& points, double start_rad, double share);

/// A share of the rays ends at droplets, whose ranges are exponentially distributed with a mean of 4 m.
void rainOn(std::vector<LidarPoint>& points, double share, std::uint64_t seed);

/// A share of the rays comes back not at all.
void loseReturns(std::vector<LidarPoint>& points, double share, std::uint64_t seed);

/// The sensor moved: points that it saw from T_old_new are seen from there.
void moveSensor(std::vector<LidarPoint>& points, const Eigen::Isometry3d& T_old_new);

void makeZeros(std::vector<LidarPoint>& points);       ///< every point is the origin
void makeOnePoint(std::vector<LidarPoint>& points);    ///< every point is the same one
void makeFewPoints(std::vector<LidarPoint>& points);   ///< 200 points are left, all others are the origin
void makeEmpty(std::vector<LidarPoint>& points);       ///< no point at all
void makeNotANumber(std::vector<LidarPoint>& points);  ///< no coordinate is a number

}  // namespace saw_ndt
