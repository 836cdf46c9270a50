#include "estimation/sliding_window/window_tracks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/sliding_window/reprojection_errors.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

// Features on edges are known across the edge only.
TEST(WindowTracks, ResidualDoesNotDependOnTheCovariance) {
  constexpr double kError = 2e-3;
  Window window = true_window();
  const std::int64_t newest = window.frames.back().id;
  for (WindowTrack& track : window.tracks) {
    for (WindowObservation& observation : track.observations) {
      if (observation.frame_id != newest) continue;
      const Eigen::Vector2d seen =
          observation.bearing - *ReprojectionErrors(window).residual(track, observation);
      observation.bearing = seen + Eigen::Vector2d(kError, 0);
      observation.information = Eigen::Vector2d(1e6, 1e2).asDiagonal();
    }
  }
  const MeasuredPoints points = reject_outliers(window);
  EXPECT_GT(points.inliers, 10);
  EXPECT_EQ(points.inliers, points.measured);
  EXPECT_NEAR(points.residual, kError / std::sqrt(2), 1e-9);
}

}  // namespace
}  // namespace stillkite
