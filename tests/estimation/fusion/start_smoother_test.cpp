#include "estimation/fusion/start_smoother.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "estimation/fusion/fusion_filter.hpp"

namespace stillkite {
namespace {

FeatureView view_of(int feature) {
  return {.feature = feature,
          .bearing = {0.1 * feature, 0.2},
          .covariance = 1e-6 * Eigen::Matrix2d::Identity()};
}

// All landmarks are given up, and those of another reference come: what was told before is not
// told again, as it would be of one anchor alone.
TEST(StartSmoother, ForgetsAStartWhoseAnchorIsLeft) {
  const auto count_told_again = [](bool leaves_anchor) {
    int told_again = 0;
    StartSmoother start(FusionConfig{}, FusionStart{});
    start.take_anchor();
    for (int frame = 0; frame < 60; ++frame) {
      if (leaves_anchor && frame == 1) start.take_anchor();
      const int feature = frame == 0 ? 0 : 1;
      start.begin_frame();
      start.remember([&](FusionFilter& filter) {
        filter.begin_step();
        ++told_again;
      });
      start.offer({.reference = view_of(feature), .guess = 0.3});
      start.see(std::vector<FeatureView>{view_of(feature)});
      EXPECT_TRUE(start.go_on({}, {}) == nullptr || !leaves_anchor);
    }
    return told_again;
  };
  EXPECT_GT(count_told_again(false), 0);
  EXPECT_EQ(count_told_again(true), 0);
}

}  // namespace
}  // namespace stillkite
