#include "navigation/row_times.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

constexpr int kRows = 200;
constexpr double kRowReadout_s = 0.02;
constexpr double kRowFrame_s = 0.04;
constexpr double kRowFocal_px = 100;
const Eigen::Vector2d kRowSpeed_px_s(50, -100);

/// One feature of an image that moves evenly, seen when its row is exposed.
struct MovingFeature {
  Eigen::Vector2d start_px;

  [[nodiscard]] Eigen::Vector2d at_px(double t_s) const { return start_px + t_s * kRowSpeed_px_s; }
  /// Where y = y_0 + v (t + readout (y - middle) / height).
  [[nodiscard]] Eigen::Vector2d seen_px(double stamp_s) const {
    const double per_row_s = kRowReadout_s / kRows;
    const double y = (at_px(stamp_s).y() - kRowSpeed_px_s.y() * per_row_s * 0.5 * (kRows - 1)) /
                     (1 - kRowSpeed_px_s.y() * per_row_s);
    return at_px(stamp_s + per_row_s * (y - 0.5 * (kRows - 1)));
  }
};

struct SeenFrame {
  FeatureTracks tracks;
  FeatureBearings bearings;
};

SeenFrame seen_at(const MovingFeature& feature, double stamp_s) {
  const Eigen::Vector2d reference_px = feature.seen_px(0);
  const Eigen::Vector2d current_px = feature.seen_px(stamp_s);
  return {.tracks = {.reference_px = {reference_px.cast<float>()},
                     .current_px = {current_px.cast<float>()},
                     .found = {1},
                     .found_count = 1},
          .bearings = {.pairs = {{reference_px / kRowFocal_px, current_px / kRowFocal_px}},
                       .feature_of_pair = {0},
                       .covariance = {2 * Eigen::Matrix2d::Identity()}}};
}

TEST(RowTimes, AnEvenlyMovingFeatureIsWhereItWasAtTheStamp) {
  const MovingFeature feature{{30, 190}};
  RowTimes row_times(kRowReadout_s, kRows);
  row_times.begin(from_seconds(1));
  for (int i = 1; i <= 3; ++i) {
    const double stamp_s = i * kRowFrame_s;
    const SeenFrame seen = seen_at(feature, stamp_s);
    const FeatureBearings moved =
        row_times.at_stamp(seen.bearings, seen.tracks, from_seconds(1 + stamp_s));
    ASSERT_EQ(moved.pairs.size(), 1U);
    ASSERT_EQ(moved.covariance.size(), 1U);
    EXPECT_EQ(moved.covariance[0], seen.bearings.covariance[0]);
    EXPECT_LT((moved.pairs[0].reference - feature.at_px(0) / kRowFocal_px).norm(), 1e-6);
    EXPECT_LT((moved.pairs[0].current - feature.at_px(stamp_s) / kRowFocal_px).norm(), 1e-6);
    // which it was not: the lowest rows are read 9 ms late
    EXPECT_GT((seen.bearings.pairs[0].current - moved.pairs[0].current).norm() * kRowFocal_px, 0.5);
  }
}

TEST(RowTimes, AGlobalShutterLeavesEverythingAsItIs) {
  RowTimes row_times(0, kRows);
  row_times.begin(from_seconds(0));
  const SeenFrame seen = seen_at({{30, 190}}, kRowFrame_s);
  const FeatureBearings same =
      row_times.at_stamp(seen.bearings, seen.tracks, from_seconds(kRowFrame_s));
  EXPECT_EQ(same.pairs[0].current, seen.bearings.pairs[0].current);
}

// How fast it went when the reference was taken nobody knows any more.
TEST(RowTimes, AFeatureFirstSeenMuchLaterIsLeftOut) {
  RowTimes row_times(kRowReadout_s, kRows);
  row_times.begin(from_seconds(0));
  for (const double stamp_s : {0.4, 0.44}) {
    const SeenFrame seen = seen_at({{30, 190}}, stamp_s);
    EXPECT_TRUE(
        row_times.at_stamp(seen.bearings, seen.tracks, from_seconds(stamp_s)).pairs.empty());
  }
}

}  // namespace
}  // namespace stillkite
