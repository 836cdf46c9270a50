#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "geometry/angle.hpp"
#include "navigation/navigator.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"
#include "tests/navigation/rendered_flight.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite {
namespace {

using test::rendered_flight;

Navigator best_over_ground(Mode mode = Mode::recommended) {
  const test::RenderedFlight& flight = rendered_flight();
  return {flight.record.camera,
          flight.record.body_from_camera,
          {},
          flight.start(),
          {.policy = Policy::best, .mode = mode}};
}

Frame occluded(const Frame& frame) {
  return {frame.stamp, frame.index, cv::Mat::zeros(frame.grey.size(), CV_8UC1)};
}

TEST(BestNavigator, SelectsMetricFlowOverFlatGround) {
  const test::RenderedFlight& flight = rendered_flight();
  Navigator navigator = best_over_ground();
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const NavigationEstimate estimate = navigator.step(flight.frames[i]);
    EXPECT_EQ(estimate.verdict, i == 0 ? Verdict::first_frame : Verdict::ok) << i;
    EXPECT_EQ(estimate.source, EstimateSource::flow) << i;
    EXPECT_EQ(estimate.scale, ScaleSource::initial_height) << i;
    EXPECT_TRUE(estimate.reference) << i;
    const Eigen::Vector3d error =
        estimate.world_from_body.translation - flight.truth(i).translation;
    EXPECT_LT(error.norm(), 0.1) << i;
  }
}

// Both estimators are lost during the occlusion and recover after it.
TEST(BestNavigator, RecoversAfterOcclusion) {
  const test::RenderedFlight& flight = rendered_flight();
  Navigator navigator = best_over_ground();
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const bool is_occluded = i >= 20 && i < 26;
    const NavigationEstimate estimate =
        navigator.step(is_occluded ? occluded(flight.frames[i]) : flight.frames[i]);
    EXPECT_TRUE(estimate.world_from_body.translation.allFinite());
    if (i > 0 && i < 26) {
      EXPECT_EQ(estimate.verdict == Verdict::ok, !is_occluded) << i;
    }
    if (i < 28) continue;
    EXPECT_EQ(estimate.verdict, Verdict::ok) << i;
    const Eigen::Vector3d error =
        estimate.world_from_body.translation - flight.truth(i).translation;
    EXPECT_LT(error.norm(), 0.5) << i;
    EXPECT_LT(
        angle_between_rad(estimate.world_from_body.rotation, flight.truth(i).rotation) / kDegree,
        0.5)
        << i;
  }
}

TEST(BestNavigator, RunsPaperFlowInPaperMode) {
  Navigator navigator = best_over_ground(Mode::paper);
  for (std::size_t i = 0; i < 4; ++i) {
    const NavigationEstimate estimate = navigator.step(rendered_flight().frames[i]);
    EXPECT_EQ(estimate.source, EstimateSource::flow) << i;
    EXPECT_EQ(estimate.measured_twist.has_value(), i > 0) << "set in mode paper only";
  }
}

/// Level body swaying laterally in a room, with a small yaw.
class SwayInRoom {
 public:
  [[nodiscard]] static RigidTransform pose(int frame) {
    const double phase = frame / 15.0;
    const double yaw_rad = 0.05 * (1 - std::cos(phase));
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())),
            Eigen::Vector3d(0, 0.25 * (1 - std::cos(phase)), 3)};
  }

  NavigationEstimate step(bool is_occluded = false) {
    cv::Mat image = cv::Mat::zeros(240, 400, CV_8UC1);
    if (!is_occluded) {
      image = develop(renderer_.render(scene_, pose(index_) * mount_), {.noise_grey = 1.5},
                      static_cast<std::uint64_t>(index_));
    }
    const Frame frame{.stamp = from_seconds(index_ / 30.0), .index = index_, .grey = image};
    ++index_;
    return navigator_.step(frame);
  }

 private:
  RigidTransform mount_ = camera_raised_forward(75);
  PatchScene scene_ = make_room(5);
  PatchRenderer renderer_{small_camera(), 2};
  Navigator navigator_{small_camera(),
                       mount_,
                       {},
                       {.world_from_body = pose(0), .scale = ScaleSource::initial_height},
                       {.policy = Policy::best}};
  int index_ = 0;
};

double attitude_error_deg(const NavigationEstimate& estimate) {
  const RigidTransform truth = SwayInRoom::pose(static_cast<int>(estimate.frame_index));
  return angle_between_rad(estimate.world_from_body.rotation, truth.rotation) / kDegree;
}

TEST(BestNavigator, SelectsReferenceInRoom) {
  SwayInRoom flight;
  for (int i = 0; i < 60; ++i) {
    const NavigationEstimate estimate = flight.step();
    if (i < 25) continue;
    EXPECT_EQ(estimate.source, EstimateSource::reference) << i;
    EXPECT_EQ(estimate.scale, ScaleSource::none) << i;
    EXPECT_LT(attitude_error_deg(estimate), 0.3) << i;
  }
}

// Until depth is observed, the displacement error may be as large as the displacement.
TEST(BestNavigator, InflatesCovarianceUntilRoomDepthIsObserved) {
  constexpr double kHeight_m = 3;
  SwayInRoom flight;
  const auto sigma = [](const Matrix6d& covariance, int first) {
    return std::sqrt(covariance.diagonal().segment<3>(first).minCoeff());
  };
  int by_flow = 0;
  for (int i = 0; i < 25; ++i) {
    const NavigationEstimate estimate = flight.step();
    if (i == 0 || estimate.source != EstimateSource::flow) continue;
    ++by_flow;
    const RigidTransform truth = SwayInRoom::pose(i);
    const double displacement_m =
        (estimate.world_from_body.translation - SwayInRoom::pose(0).translation).norm();
    const double speed_m_s = estimate.twist_in_camera.velocity_m_s.norm();
    EXPECT_GE(sigma(estimate.pose_covariance, 0), displacement_m) << i;
    EXPECT_GE(sigma(estimate.pose_covariance, 3), displacement_m / kHeight_m) << i;
    EXPECT_GE(sigma(estimate.twist_covariance, 0), speed_m_s) << i;
    EXPECT_GE(sigma(estimate.twist_covariance, 3), speed_m_s / kHeight_m) << i;
    const double rotation_error_rad =
        angle_between_rad(estimate.world_from_body.rotation, truth.rotation);
    EXPECT_LT(rotation_error_rad, 3 * sigma(estimate.pose_covariance, 3)) << i;
  }
  EXPECT_GT(by_flow, 3);
}

TEST(BestNavigator, OcclusionInRoomLeavesNoAttitudeJump) {
  SwayInRoom flight;
  for (int i = 0; i < 30; ++i) (void)flight.step();
  for (int i = 0; i < 6; ++i) {
    const NavigationEstimate occluded_estimate = flight.step(true);
    EXPECT_NE(occluded_estimate.verdict, Verdict::ok);
    EXPECT_LT(attitude_error_deg(occluded_estimate), 3);
  }
  for (int i = 0; i < 10; ++i) {
    const NavigationEstimate estimate = flight.step();
    EXPECT_EQ(estimate.verdict, Verdict::ok) << i;
    EXPECT_LT(attitude_error_deg(estimate), 0.3) << i;
  }
}

}  // namespace
}  // namespace stillkite
