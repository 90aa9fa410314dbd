#include "report/segmentation_score.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace saw_ndt {
namespace {

double ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

bool isSemanticKittiGround(std::uint16_t semantic_class) {
  switch (semantic_class) {
    case 40:
    case 44:
    case 48:
    case 49:
    case 60:
    case 72:
      return true;
    default:
      return false;
  }
}

double GroundScore::precision() const { return ratio(true_positives, true_positives + false_positives); }
double GroundScore::recall() const { return ratio(true_positives, true_positives + false_negatives); }
double GroundScore::f1() const {
  return ratio(2 * true_positives, 2 * true_positives + false_positives + false_negatives);
}
double GroundScore::iou() const { return ratio(true_positives, true_positives + false_positives + false_negatives); }
double GroundScore::noiseShare() const { return ratio(noise_points, points); }

GroundScore& GroundScore::operator+=(const GroundScore& other) {
  points += other.points;
  noise_points += other.noise_points;
  true_positives += other.true_positives;
  false_positives += other.false_positives;
  false_negatives += other.false_negatives;
  true_negatives += other.true_negatives;
  return *this;
}

GroundScore scoreGround(const std::vector<StructuralLabel>& labels,
                        const std::vector<std::uint16_t>& semantic_classes) {
  if (labels.size() != semantic_classes.size()) {
    throw std::invalid_argument(std::to_string(semantic_classes.size()) + " classes for " +
                                std::to_string(labels.size()) + " points");
  }
  GroundScore score;
  score.points = labels.size();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == StructuralLabel::NOISE) ++score.noise_points;
    if (semantic_classes[i] <= 1) continue;
    const bool found = labels[i] == StructuralLabel::GROUND;
    if (isSemanticKittiGround(semantic_classes[i])) {
      ++(found ? score.true_positives : score.false_negatives);
    } else {
      ++(found ? score.false_positives : score.true_negatives);
    }
  }
  return score;
}

std::string toJsonText(const GroundScore& score) {
  const nlohmann::ordered_json json{{"precision", score.precision()},
                                    {"recall", score.recall()},
                                    {"f1", score.f1()},
                                    {"iou", score.iou()},
                                    {"noise_share", score.noiseShare()},
                                    {"points", score.points},
                                    {"noise_points", score.noise_points},
                                    {"true_positives", score.true_positives},
                                    {"false_positives", score.false_positives},
                                    {"false_negatives", score.false_negatives},
                                    {"true_negatives", score.true_negatives}};
  return json.dump(2) + "\n";
}

}  // namespace saw_ndt
