#include "navigation/rolling_shutter_correction.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

constexpr int kRows = 200;
constexpr double kRowReadout_s = 0.02;
constexpr double kRowFrame_s = 0.04;
constexpr double kRowFocal_px = 100;
const Eigen::Vector2d kRowVelocity_px_s(50, -100);

/// Feature with constant image velocity, observed when its row is exposed.
struct MovingFeature {
  Eigen::Vector2d initial_px;

  [[nodiscard]] Eigen::Vector2d at_px(double t_s) const {
    return initial_px + t_s * kRowVelocity_px_s;
  }
  /// Solves y = y_0 + v (t + readout (y - middle) / height).
  [[nodiscard]] Eigen::Vector2d observed_px(double stamp_s) const {
    const double per_row_s = kRowReadout_s / kRows;
    const double y = (at_px(stamp_s).y() - kRowVelocity_px_s.y() * per_row_s * 0.5 * (kRows - 1)) /
                     (1 - kRowVelocity_px_s.y() * per_row_s);
    return at_px(stamp_s + per_row_s * (y - 0.5 * (kRows - 1)));
  }
};

struct ObservedFrame {
  FeatureTracks tracks;
  FeatureBearings bearings;
};

ObservedFrame observe(const MovingFeature& feature, double stamp_s) {
  const Eigen::Vector2d reference_px = feature.observed_px(0);
  const Eigen::Vector2d current_px = feature.observed_px(stamp_s);
  return {.tracks = {.reference_px = {reference_px.cast<float>()},
                     .current_px = {current_px.cast<float>()},
                     .found = {1},
                     .found_count = 1},
          .bearings = {.pairs = {{reference_px / kRowFocal_px, current_px / kRowFocal_px}},
                       .feature_of_pair = {0},
                       .covariance = {2 * Eigen::Matrix2d::Identity()}}};
}

TEST(RollingShutterCorrection, MovesUniformFeatureToStamp) {
  const MovingFeature feature{{30, 190}};
  RollingShutterCorrection correction(kRowReadout_s, kRows);
  correction.begin(from_seconds(1));
  for (int i = 1; i <= 3; ++i) {
    const double stamp_s = i * kRowFrame_s;
    const ObservedFrame observed = observe(feature, stamp_s);
    const FeatureBearings corrected =
        correction.at_stamp(observed.bearings, observed.tracks, from_seconds(1 + stamp_s));
    ASSERT_EQ(corrected.pairs.size(), 1U);
    ASSERT_EQ(corrected.covariance.size(), 1U);
    EXPECT_EQ(corrected.covariance[0], observed.bearings.covariance[0]);
    EXPECT_LT((corrected.pairs[0].reference - feature.at_px(0) / kRowFocal_px).norm(), 1e-6);
    EXPECT_LT((corrected.pairs[0].current - feature.at_px(stamp_s) / kRowFocal_px).norm(), 1e-6);
    // without correction: the lowest rows are read 9 ms late
    EXPECT_GT(
        (observed.bearings.pairs[0].current - corrected.pairs[0].current).norm() * kRowFocal_px,
        0.5);
  }
}

TEST(RollingShutterCorrection, GlobalShutterChangesNothing) {
  RollingShutterCorrection correction(0, kRows);
  correction.begin(from_seconds(0));
  const ObservedFrame observed = observe({{30, 190}}, kRowFrame_s);
  const FeatureBearings unchanged =
      correction.at_stamp(observed.bearings, observed.tracks, from_seconds(kRowFrame_s));
  EXPECT_EQ(unchanged.pairs[0].current, observed.bearings.pairs[0].current);
}

// Its image velocity at the reference is not observable.
TEST(RollingShutterCorrection, RemovesFeatureFirstObservedLate) {
  RollingShutterCorrection correction(kRowReadout_s, kRows);
  correction.begin(from_seconds(0));
  for (const double stamp_s : {0.4, 0.44}) {
    const ObservedFrame observed = observe({{30, 190}}, stamp_s);
    EXPECT_TRUE(correction.at_stamp(observed.bearings, observed.tracks, from_seconds(stamp_s))
                    .pairs.empty());
  }
}

}  // namespace
}  // namespace stillkite
