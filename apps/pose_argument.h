#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace saw_ndt {

/// How the help of an app calls a pose on the command line.
constexpr char kPosePlaceholder[] = "X,Y,Z,ROLL,PITCH,YAW";

/// The transform that a pose on the command line states: x y z in metres, roll pitch yaw in degrees,
/// R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Isometry3d transformOf(const std::vector<double>& xyz_rpy_deg);

/// The inverse of transformOf().
std::vector<double> poseArgumentOf(const Eigen::Isometry3d& T);

}  // namespace saw_ndt
