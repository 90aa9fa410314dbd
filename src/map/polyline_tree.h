#pragma once

#include <Eigen/Core>
#include <vector>

namespace saw_ndt::internal {

/// A line through points of the plane, and boxes around its parts: pairs of edges, pairs of these and so on. What is
/// far from a question is not looked at, and no distance between the points takes more memory than another.
class PolylineTree {
 public:
  /// @param points  one or more; one is an edge without length
  explicit PolylineTree(std::vector<Eigen::Vector2d> points);

  /// Whether some point of the line is at most `distance` away.
  bool isWithin(const Eigen::Vector2d& position, double distance) const;
  /// How many edges a line from a position along x crosses, of an edge its lower end included and the upper one not.
  int crossingsToTheRight(const Eigen::Vector2d& position) const;

 private:
  struct Box {
    Eigen::Vector2d least, greatest;
  };

  std::size_t edgeCount() const { return points_.size() - 1; }
  template <typename Enters, typename Visit>
  bool anyEdge(std::size_t level, std::size_t index, const Enters& enters, const Visit& visit) const;

  std::vector<Eigen::Vector2d> points_;
  std::vector<std::vector<Box>> levels_;  // of edges, of two of them, ..., of all
};

}  // namespace saw_ndt::internal
