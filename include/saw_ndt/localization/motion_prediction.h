#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace saw_ndt {

struct MotionPredictionOptions {
  double max_speed_mps = 60.0;       ///< a predicted speed is cut to this (m/s)
  double max_turn_rate_radps = 1.5;  ///< a predicted turn rate is cut to this (rad/s)

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Predicts the next pose from the last two accepted ones and their stamps (Section III.C of the paper): constant
/// velocity and turn rate in the vehicle's own frame, a circle where it turns, both bounded. Before there are two, the
/// last pose.
class MotionPrediction {
 public:
  explicit MotionPrediction(const MotionPredictionOptions& options = {});

  /// Forgets all poses and starts from one whose stamp is not known. Here and below what is not finite throws
  /// std::invalid_argument.
  void reset(const Eigen::Isometry3d& T_map_base);
  /// Adds an accepted pose. Stamps (s) that do not grow leave the velocity unknown.
  void accept(const Eigen::Isometry3d& T_map_base, double stamp_s);

  /// The pose expected at a stamp.
  Eigen::Isometry3d predict(double stamp_s) const;
  /// Whether two poses with growing stamps are known.
  bool velocityKnown() const { return velocity_known_; }
  /// Seconds since the last accepted pose; nothing where its stamp is not known.
  std::optional<double> timeSinceLast(double stamp_s) const;

 private:
  MotionPredictionOptions options_;
  Eigen::Isometry3d T_map_last_ = Eigen::Isometry3d::Identity();
  std::optional<double> last_stamp_s_;
  bool velocity_known_ = false;
  Eigen::Vector3d velocity_base_mps_ = Eigen::Vector3d::Zero();  // in the frame of the moving base
  Eigen::Vector3d turn_rate_base_radps_ = Eigen::Vector3d::Zero();
};

}  // namespace saw_ndt
