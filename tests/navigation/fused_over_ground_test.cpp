#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <optional>

#include "geometry/angle.hpp"
#include "navigation/navigator.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

// Nothing but a camera and the height at the start: over flat ground both say the same.
TEST(FusedNavigator, FollowsTheFlowOverFlatGround) {
  const test::RenderedFlight& flight = test::rendered_flight();
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                      {.policy = Policy::fused});
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const NavigationEstimate estimate = navigator.step(flight.frames[i]);
    EXPECT_EQ(estimate.verdict, i == 0 ? Verdict::first_frame : Verdict::ok) << i;
    const Eigen::Vector3d error =
        estimate.world_from_body.translation - flight.truth(i).translation;
    if (i < 15) continue;  // until the features have shown flat ground
    EXPECT_EQ(estimate.scale, ScaleSource::initial_height) << i;
    EXPECT_LT(error.norm(), 0.1) << i;
    EXPECT_LT(
        angle_between_rad(estimate.world_from_body.rotation, flight.truth(i).rotation) / kDegree,
        0.2)
        << i;
  }
}

// Slabs of 24 x 48 texels in bond.
cv::Mat pavement() {
  cv::Mat image(1056, 1056, CV_8UC1, cv::Scalar(150));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const bool is_joint = y % 24 < 3 || (x + y / 24 % 2 * 24) % 48 < 3;
      if (is_joint) image.at<uchar>(y, x) = 60;
    }
  }
  cv::Mat grain(image.size(), CV_8SC1);
  cv::RNG random(1);
  random.fill(grain, cv::RNG::NORMAL, 0, 6);
  cv::add(image, grain, image, cv::noArray(), CV_8UC1);
  return image;
}

// The place that it started from looks like many others, and each image like itself one slab on.
TEST(Pavement, IsFollowedSlabBySlab) {
  SimulationConfig config = test::small_flight(1);
  config.flight.duration_s = 3;
  config.flight.height_m = 20;
  config.flight.forward_m = 20;
  config.flight.climb_m = 0;
  const test::RenderedFlight flight = test::render_flight(config, pavement());
  for (const Policy policy : {Policy::flow, Policy::fused}) {
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = policy});
    double farthest_m = 0;
    for (std::size_t i = 0; i < flight.frames.size(); ++i) {
      const Frame& frame = flight.frames[i];
      const bool is_dark = policy == Policy::flow && i >= 30 && i < 36;
      const Frame black{frame.stamp, frame.index, cv::Mat::zeros(frame.grey.size(), CV_8UC1)};
      const NavigationEstimate estimate = navigator.step(is_dark ? black : frame);
      farthest_m = std::max(
          farthest_m, (estimate.world_from_body.translation - flight.truth(i).translation).norm());
    }
    std::printf("%s at most %.3f m off\n", name_of(policy).data(), farthest_m);
    EXPECT_LT(farthest_m, 0.5) << name_of(policy);
  }
}

double velocity_rms_m_s(const test::RenderedFlight& flight, Policy policy) {
  NavigatorConfig config;
  config.fusion.flat_ground = true;
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, config, flight.start(),
                      {.policy = policy});
  constexpr std::size_t kSettled = 10;
  double sum = 0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const NavigationEstimate estimate = navigator.step(flight.frames[i]);
    if (i < kSettled) continue;
    sum += (estimate.twist_in_camera.velocity_m_s -
            flight.record.twists_in_camera[i - 1].twist.velocity_m_s)
               .squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(flight.frames.size() - kSettled));
}

// The flow alone: 0.0125 m/s.
TEST(FusedNavigator, MeasuresTheVelocityOverFlatGround) {
  EXPECT_LT(velocity_rms_m_s(test::rendered_flight(), Policy::fused), 0.027);
}

Navigator told_no_height(const test::RenderedFlight& flight) {
  InitialState start = flight.start();
  start.world_from_body.translation.z() = 1;
  start.scale = ScaleSource::none;
  return {
      flight.record.camera, flight.record.body_from_camera, {}, start, {.policy = Policy::fused}};
}

// No height at the start, but a range finder: the flight is known as if there had been one.
TEST(FusedNavigator, KnowsMetresByARangeFinder) {
  const test::RenderedFlight& flight = test::rendered_flight();
  Navigator navigator = told_no_height(flight);
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const RigidTransform& truth = flight.truth(i);
    SensorReadings readings;
    // dumb for a while: its age tells
    if (i % 10 < 8) {
      const double along = (truth.rotation * Eigen::Vector3d::UnitZ()).z();
      readings.height_m = truth.translation.z() / along;
    }
    const NavigationEstimate estimate = navigator.step(flight.frames[i], readings);
    if (i < 15) continue;  // until the features have shown flat ground
    EXPECT_EQ(estimate.scale, ScaleSource::range) << i;
    EXPECT_EQ(estimate.scale_age_s > 0, !readings.height_m) << i;
    EXPECT_LT((estimate.world_from_body.translation - truth.translation).norm(), 0.1) << i;
  }
}

// The flow's unit is another from its first reading on; what it saw before is to stay where it was.
TEST(FusedNavigator, BelievesFlatGroundAlsoWhereTheFirstHeightIsLate) {
  const test::RenderedFlight& flight = test::rendered_flight();
  Navigator navigator = told_no_height(flight);
  constexpr std::size_t kFirstReading = 10;
  constexpr std::size_t kSettled = 30;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const RigidTransform& truth = flight.truth(i);
    SensorReadings readings;
    if (i >= kFirstReading) {
      readings.height_m = truth.translation.z() / (truth.rotation * Eigen::Vector3d::UnitZ()).z();
    }
    const NavigationEstimate estimate = navigator.step(flight.frames[i], readings);
    if (i < kSettled) continue;
    EXPECT_EQ(estimate.scale, ScaleSource::range) << i;
    EXPECT_EQ(estimate.scale_age_s, 0) << i;
    EXPECT_LT((estimate.world_from_body.translation - truth.translation).norm(), 0.3) << i;
  }
}

// A start that is wrong by what it was said to be good to: the speed over the ground is no surer.
TEST(FusedNavigator, KnowsTheSpeedNoBetterThanItsHeight) {
  const test::RenderedFlight& flight = test::rendered_flight();
  NavigatorConfig config;
  config.fusion.flat_ground = true;
  double nees = 0;
  int count = 0;
  for (const double wrong_by : {-1.5, -1.0, -0.5, 0.5, 1.0, 1.5}) {
    InitialState start = flight.start();
    start.world_from_body.translation.z() *= 1 + wrong_by * config.fusion.height_sigma_ratio;
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, config, start,
                        {.policy = Policy::fused});
    for (std::size_t i = 0; i < flight.frames.size(); ++i) {
      const NavigationEstimate estimate = navigator.step(flight.frames[i]);
      if (i < 10) continue;
      const Eigen::Vector3d error = estimate.twist_in_camera.velocity_m_s -
                                    flight.record.twists_in_camera[i - 1].twist.velocity_m_s;
      const Eigen::Matrix3d P = estimate.twist_covariance.topLeftCorner<3, 3>();
      nees += error.dot(P.ldlt().solve(error));
      ++count;
    }
  }
  std::printf("NEES %.2f of 3\n", nees / count);
  EXPECT_LT(nees / count, 4.5);
}

// A range finder that sees nothing tells 0.
TEST(FusedNavigator, AHeightOfZeroIsNoReading) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const auto told = [&](std::optional<double> height_m) {
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = Policy::fused});
    NavigationEstimate estimate;
    for (std::size_t i = 0; i < 10; ++i) {
      SensorReadings readings;
      readings.height_m = height_m;
      estimate = navigator.step(flight.frames[i], readings);
    }
    return estimate;
  };
  EXPECT_TRUE(told(0.0).pose_covariance.isApprox(told({}).pose_covariance, 1e-9));
}

// OpenCV's solver does not say how good its turns are.
TEST(FusedNavigator, ATurnOfUnknownCovarianceIsNotBelievedExactly) {
  const test::RenderedFlight& flight = test::rendered_flight();
  NavigatorConfig config;
  config.reference.solver = PoseSolver::opencv;
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, config, flight.start(),
                      {.policy = Policy::fused});
  navigator.step(flight.frames[0]);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(std::sqrt(navigator.step(flight.frames[i]).pose_covariance(5, 5)), 1e-5) << i;
  }
}
}  // namespace
}  // namespace stillkite
