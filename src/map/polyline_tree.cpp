#include "map/polyline_tree.h"

#include <algorithm>
#include <utility>

namespace saw_ndt::internal {
namespace {

double squaredDistance(const Eigen::Vector2d& position, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double squared_length = along.squaredNorm();
  const double share = squared_length > 0.0 ? std::clamp((position - a).dot(along) / squared_length, 0.0, 1.0) : 0.0;
  return (a + share * along - position).squaredNorm();
}

bool crossesToTheRight(const Eigen::Vector2d& position, Eigen::Vector2d a, Eigen::Vector2d b) {
  if (a.y() > b.y()) std::swap(a, b);
  if (position.y() < a.y() || position.y() >= b.y()) return false;
  return position.x() < a.x() + (position.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

}  // namespace

PolylineTree::PolylineTree(std::vector<Eigen::Vector2d> points) : points_(std::move(points)) {
  if (points_.size() == 1) points_.push_back(points_.front());
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < edgeCount(); ++i) {
    boxes.push_back({points_[i].cwiseMin(points_[i + 1]), points_[i].cwiseMax(points_[i + 1])});
  }
  levels_.push_back(std::move(boxes));
  while (levels_.back().size() > 1) {
    const std::vector<Box>& below = levels_.back();
    std::vector<Box> level;
    for (std::size_t i = 0; i < below.size(); i += 2) {
      const Box& other = below[std::min(i + 1, below.size() - 1)];
      level.push_back({below[i].least.cwiseMin(other.least), below[i].greatest.cwiseMax(other.greatest)});
    }
    levels_.push_back(std::move(level));
  }
}

// Whether visit(edge) is true of an edge in a box; it is called where enters(box) is true of all boxes around.
template <typename Enters, typename Visit>
bool PolylineTree::anyEdge(std::size_t level, std::size_t index, const Enters& enters, const Visit& visit) const {
  if (!enters(levels_[level][index])) return false;
  if (level == 0) return visit(index);
  const std::size_t last = std::min(2 * index + 2, levels_[level - 1].size());
  for (std::size_t below = 2 * index; below < last; ++below) {
    if (anyEdge(level - 1, below, enters, visit)) return true;
  }
  return false;
}

bool PolylineTree::isWithin(const Eigen::Vector2d& position, double distance) const {
  const double most = distance * distance;
  return anyEdge(
      levels_.size() - 1, 0,
      [&](const Box& box) {
        return (position.cwiseMax(box.least).cwiseMin(box.greatest) - position).squaredNorm() <= most;
      },
      [&](std::size_t edge) { return squaredDistance(position, points_[edge], points_[edge + 1]) <= most; });
}

int PolylineTree::crossingsToTheRight(const Eigen::Vector2d& position) const {
  int count = 0;
  anyEdge(
      levels_.size() - 1, 0,
      [&](const Box& box) {
        return position.y() >= box.least.y() && position.y() < box.greatest.y() && position.x() <= box.greatest.x();
      },
      [&](std::size_t edge) {
        if (crossesToTheRight(position, points_[edge], points_[edge + 1])) ++count;
        return false;
      });
  return count;
}

}  // namespace saw_ndt::internal
