#include "estimation/start_smoother.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "estimation/fusion_filter.hpp"

namespace stillkite {
namespace {

FeatureView view_of(int feature) {
  return {.feature = feature,
          .bearing = {0.1 * feature, 0.2},
          .covariance = 1e-6 * Eigen::Matrix2d::Identity()};
}

// All landmarks are given up, and those of another reference come.
TEST(StartSmoother, ForgetsAStartWhoseAnchorIsLeft) {
  StartSmoother start(FusionConfig{}, FusionStart{});
  const auto see = [&](int feature) {
    start.begin_frame();
    start.offer({.reference = view_of(feature), .guess = 0.3});
    start.see(std::vector<FeatureView>{view_of(feature)});
    return start.go_on({}, {});
  };
  start.take_anchor();
  EXPECT_EQ(see(0), nullptr);
  start.take_anchor();
  for (int frame = 0; frame < 200; ++frame) EXPECT_EQ(see(1), nullptr) << frame;
}

// What the main filter has given up is no landmark of the start.
TEST(StartSmoother, LeavesOutWhatWasGivenUp) {
  FusionConfig config;
  config.landmarks = 2;
  StartSmoother start(config, FusionStart{});
  start.take_anchor();
  for (int feature = 0; feature < 4; ++feature) {
    start.offer({.reference = view_of(feature), .guess = 0.3});
  }
  for (int frame = 0; frame < 200; ++frame) {
    start.begin_frame();
    start.see(std::vector<FeatureView>{view_of(0), view_of(1), view_of(2), view_of(3)});
    EXPECT_EQ(start.go_on({}, {0, 1, 2, 3}), nullptr) << frame;
  }
}

}  // namespace
}  // namespace stillkite
