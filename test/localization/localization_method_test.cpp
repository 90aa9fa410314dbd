#include "saw_ndt/localization/localization_method.h"

#include <gtest/gtest.h>

#include <limits>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

TEST(LocalizationMethod, NamesAreTheContracts) {
  EXPECT_EQ(LocalizationMethod::names(),
            (std::vector<std::string>{"weighted", "weighted-s50", "weighted-s100", "unweighted-s50", "classical"}));
  for (const std::string& name : LocalizationMethod::names()) {
    EXPECT_EQ(LocalizationMethod::named(name).name, name);
    EXPECT_NO_THROW(LocalizationMethod::named(name).check());
  }
}

TEST(LocalizationMethod, AnUnknownNameListsTheKnownOnes) {
  expectThrows<std::invalid_argument>(
      [] { LocalizationMethod::named("weighted-s75"); },
      {"weighted-s75", "weighted ", "weighted-s50", "weighted-s100", "unweighted-s50", "classical"});
}

TEST(LocalizationMethod, ThePapersMethodsHaveThePapersValues) {
  const struct {
    std::string name;
    bool segment, use_weights;
    double ground_ratio;
  } expected[] = {{"weighted-s50", true, true, 0.5},
                  {"weighted-s100", true, true, 1.0},
                  {"unweighted-s50", true, false, 0.5},
                  {"classical", false, false, 1.0}};
  for (const auto& e : expected) {
    SCOPED_TRACE(e.name);
    const LocalizationMethod method = LocalizationMethod::named(e.name);
    EXPECT_EQ(method.segment, e.segment);
    EXPECT_EQ(method.use_weights, e.use_weights);
    EXPECT_EQ(method.ground_ratio, e.ground_ratio);
    EXPECT_EQ(method.mismatch_penalty, 0.1);
    EXPECT_EQ(method.outlier_ratio, 0.55);
    EXPECT_EQ(method.voxels.confidence.noise, e.segment ? 0.0 : 1.0);
    EXPECT_EQ(method.voxels.confidence.ground, e.segment ? 0.5 : 1.0);
    EXPECT_EQ(method.voxels.confidence.non_ground, 1.0);
    EXPECT_EQ(method.voxels.min_eigenvalue_ratio, 0.01);
    EXPECT_FALSE(method.voxels.unbounded_ground);
    EXPECT_FALSE(method.ground_in_own_column);
    EXPECT_EQ(method.voxels.sizes.finest_m, 1.0);
    EXPECT_EQ(method.voxels.sizes.coarsest_m, 0.0);
  }
}

TEST(LocalizationMethod, ChecksNameTheField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const std::string& field, double LocalizationMethod::*member, double value) {
    LocalizationMethod method = LocalizationMethod::named("weighted");
    method.*member = value;
    expectThrows<std::invalid_argument>([&] { method.check(); }, {field + " = "});
  };
  for (const double value : {-0.1, 1.1, nan}) {
    refused("ground_ratio", &LocalizationMethod::ground_ratio, value);
    refused("mismatch_penalty", &LocalizationMethod::mismatch_penalty, value);
    refused("outlier_ratio", &LocalizationMethod::outlier_ratio, value);
  }
  refused("coarse_settled_voxels", &LocalizationMethod::coarse_settled_voxels, 0.0);
  refused("outlier_ratio", &LocalizationMethod::outlier_ratio, 0.0);
  refused("outlier_ratio", &LocalizationMethod::outlier_ratio, 1.0);
  LocalizationMethod method;
  method.voxels.confidence.ground = 2.0;
  expectThrows<std::invalid_argument>([&] { method.check(); }, {"ground", "2"});
}

}  // namespace
}  // namespace saw_ndt
