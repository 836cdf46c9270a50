#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>

#include "geometry/angle.hpp"
#include "navigation/navigator.hpp"
#include "rendered_flight.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/develop.hpp"
#include "simulation/patch_renderer.hpp"
#include "simulation/room_scene.hpp"
#include "small_camera.hpp"

namespace stillkite {
namespace {

constexpr double kFramesPerSecond = 30;
constexpr int kReadingsPerFrame = 7;
const RigidTransform kForwardMount = camera_raised_forward(75);

/// A level body that sways across the view and turns a little; at rest at time 0.
struct Sway {
  static constexpr double kReach_m = 0.25;
  static constexpr double kRate_rad_s = 2.0;
  static constexpr double kTurn_rad = 0.05;

  [[nodiscard]] static RigidTransform pose(double t_s) {
    const double phase = kRate_rad_s * t_s;
    const double yaw_rad = kTurn_rad * (1 - std::cos(phase));
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())),
            Eigen::Vector3d(0, kReach_m * (1 - std::cos(phase)), 3)};
  }
  [[nodiscard]] static Eigen::Vector3d velocity_in_world_m_s(double t_s) {
    return {0, kReach_m * kRate_rad_s * std::sin(kRate_rad_s * t_s), 0};
  }
  /// About the vertical, over the frame's interval that ends then.
  [[nodiscard]] static double mean_rate_rad_s(double t_s) {
    const double before_s = t_s - 1 / kFramesPerSecond;
    return kTurn_rad * (std::cos(kRate_rad_s * before_s) - std::cos(kRate_rad_s * t_s)) *
           kFramesPerSecond;
  }
  [[nodiscard]] static InertialReading reading(double t_s) {
    const double phase = kRate_rad_s * t_s;
    const Eigen::Vector3d force(0, kReach_m * kRate_rad_s * kRate_rad_s * std::cos(phase), 9.80665);
    return {.stamp = from_seconds(t_s),
            .angular_rate_in_body_rad_s = {0, 0, kTurn_rad * kRate_rad_s * std::sin(phase)},
            .specific_force_in_body_m_s2 = pose(t_s).rotation.conjugate() * force};
  }
};

/// The pictures of the sway, with the readings of the IMU before each.
class FusedFlight {
 public:
  explicit FusedFlight(double known_height_m = 3, Policy policy = Policy::fused,
                       ScaleSource scale = ScaleSource::initial_height,
                       const Camera& told = small_camera())
      : scene_(make_room(5)),
        renderer_(small_camera(), 2),
        navigator_(told, kForwardMount, {},
                   {.world_from_body = {Eigen::Quaterniond::Identity(), {0, 0, known_height_m}},
                    .scale = scale},
                   {.policy = policy}) {}

  NavigationEstimate step(const cv::Mat& picture, const InertialReading& bad = {}) {
    SensorReadings readings;
    if (!bad.specific_force_in_body_m_s2.isZero()) readings.inertial.push_back(bad);
    readings.attitude = Sway::pose(time_s()).rotation;
    for (int i = 1; index_ > 0 && i <= kReadingsPerFrame; ++i) {
      const double since = (i - 0.5) / kReadingsPerFrame;
      InertialReading reading = Sway::reading((index_ - 1 + since) / kFramesPerSecond);
      reading.stamp = from_seconds((index_ - 1 + static_cast<double>(i) / kReadingsPerFrame) /
                                   kFramesPerSecond);
      readings.inertial.push_back(reading);
    }
    const NavigationEstimate estimate = navigator_.step(
        {.stamp = from_seconds(time_s()), .index = index_, .grey = picture}, readings);
    ++index_;
    return estimate;
  }
  NavigationEstimate step() { return step(picture()); }
  /// Of the next frame.
  [[nodiscard]] cv::Mat picture() const {
    return develop(renderer_.render(scene_, Sway::pose(time_s()) * kForwardMount),
                   {.noise_grey = 1.5}, static_cast<std::uint64_t>(index_));
  }
  /// Of the next frame.
  [[nodiscard]] double time_s() const { return index_ / kFramesPerSecond; }

 private:
  PatchScene scene_;
  PatchRenderer renderer_;
  Navigator navigator_;
  int index_ = 0;
};

Eigen::Vector3d way_error_m(const NavigationEstimate& first, const NavigationEstimate& now) {
  const double t_s = to_seconds(now.stamp);
  return (now.world_from_body.translation - first.world_from_body.translation) -
         (Sway::pose(t_s).translation - Sway::pose(0).translation);
}

// A room is no flat ground: neither estimator alone knows the way in metres here.
TEST(FusedNavigator, KnowsWayAndVelocityInMetresInARoom) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  EXPECT_EQ(first.verdict, Verdict::first_frame);
  for (int i = 1; i <= 120; ++i) {
    const double t_s = flight.time_s();
    const NavigationEstimate estimate = flight.step();
    ASSERT_EQ(estimate.verdict, Verdict::ok) << "frame " << i;
    EXPECT_EQ(estimate.source, EstimateSource::fused);
    if (i == 1) {
      EXPECT_EQ(estimate.scale, ScaleSource::none) << "nothing has told metres yet";
    }
    if (i < 60) continue;  // within two seconds the depths and the scale have shown
    EXPECT_EQ(estimate.scale, ScaleSource::initial_height);
    EXPECT_LT(way_error_m(first, estimate).norm(), 0.03) << "frame " << i;
    EXPECT_LT((estimate.velocity_in_world_m_s - Sway::velocity_in_world_m_s(t_s)).norm(), 0.05);
    EXPECT_LT(angle_between_rad(estimate.world_from_body.rotation, Sway::pose(t_s).rotation),
              0.2 * kDegree);
  }
}

TEST(FusedNavigator, CoversItsErrors) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  int outside = 0;
  for (int i = 1; i <= 120; ++i) {
    const double t_s = flight.time_s();
    const NavigationEstimate estimate = flight.step();
    const Eigen::Vector3d rate_error =
        kForwardMount.rotation * estimate.twist_in_camera.angular_rate_rad_s -
        Eigen::Vector3d(0, 0, Sway::mean_rate_rad_s(t_s));
    EXPECT_LT(rate_error.norm(),
              3 * std::sqrt(estimate.twist_covariance.bottomRightCorner<3, 3>().trace()));
    const Eigen::Vector3d error = way_error_m(first, estimate);
    const Eigen::Vector3d sigma = estimate.pose_covariance.diagonal().head<3>().cwiseSqrt();
    outside += (error.array().abs() > 3 * sigma.array() + 1e-3).any() ? 1 : 0;
  }
  EXPECT_LE(outside, 6);
}

// By what features are off from their epipolar lines. Of the first frames, before both have gone
// through their starts, nothing follows.
TEST(FusedNavigator, IsLessSureThroughALensThatIsNotAsTold) {
  Camera wrong = small_camera();
  wrong.coefficients[0] += 0.05;
  FusedFlight right;
  FusedFlight astray(3, Policy::fused, ScaleSource::initial_height, wrong);
  const auto turn_variance = [](const NavigationEstimate& estimate) {
    return estimate.pose_covariance.diagonal().tail<3>().sum();
  };
  for (int i = 0; i <= 60; ++i) {
    const double known = turn_variance(right.step());
    const double vague = turn_variance(astray.step());
    if (i < 45) continue;
    EXPECT_GT(vague, 1.5 * known) << "frame " << i;
  }
}

// Frames that show nothing: a verdict, a growing covariance, the IMU's way; then as before. The
// scale is well known by then: what the way is uncertain by for its sake shrinks with the way.
TEST(FusedNavigator, GoesOnByInertiaInTheDark) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  NavigationEstimate before;
  for (int i = 1; i <= 120; ++i) before = flight.step();
  NavigationEstimate dark;
  for (int i = 0; i < 15; ++i) {
    dark = flight.step(cv::Mat::zeros(240, 400, CV_8UC1));
    EXPECT_NE(dark.verdict, Verdict::ok);
  }
  EXPECT_GT(dark.pose_covariance(1, 1), before.pose_covariance(1, 1));
  EXPECT_LT(way_error_m(first, dark).norm(), 0.06);
  NavigationEstimate after;
  for (int i = 0; i < 20; ++i) after = flight.step();
  EXPECT_EQ(after.verdict, Verdict::ok);
  EXPECT_LT(way_error_m(first, after).norm(), 0.03);
}

// A reading that is no number is none; the others carry on.
TEST(FusedNavigator, LeavesOutReadingsThatAreNoNumbers) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  NavigationEstimate estimate;
  for (int i = 1; i <= 90; ++i) {
    const InertialReading bad{.stamp = from_seconds(flight.time_s() - 0.02),
                              .angular_rate_in_body_rad_s = {nan, 0, 0},
                              .specific_force_in_body_m_s2 = {0, nan, 0}};
    estimate = flight.step(flight.picture(), bad);
    ASSERT_TRUE(estimate.world_from_body.translation.allFinite());
    ASSERT_TRUE(estimate.twist_covariance.allFinite());
  }
  EXPECT_EQ(estimate.verdict, Verdict::ok);
  EXPECT_LT(way_error_m(first, estimate).norm(), 0.03);
}

// The accelerometer measures metres where nothing else does: until it has, there are none.
TEST(FusedNavigator, KnowsMetresByTheImuWhereNoHeightIsGiven) {
  FusedFlight flight(1, Policy::fused, ScaleSource::none);
  const NavigationEstimate first = flight.step();
  EXPECT_EQ(flight.step().scale, ScaleSource::none);
  NavigationEstimate estimate;
  for (int i = 2; i <= 360; ++i) estimate = flight.step();
  EXPECT_EQ(estimate.scale, ScaleSource::imu);
  const double error_m = way_error_m(first, estimate).norm();
  EXPECT_LT(error_m, 0.05);
  EXPECT_LT(error_m, 3 * std::sqrt(estimate.pose_covariance.topLeftCorner<3, 3>().trace()));
  EXPECT_EQ(estimate.reference->motion.scale, ScaleSource::imu);
}

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

// By the way between two of its poses alone it would err half as much again.
TEST(FusedNavigator, KnowsTheSpeedOverFlatGroundAsWellAsTheFlow) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const double by_flow = velocity_rms_m_s(flight, Policy::flow);
  const double fused = velocity_rms_m_s(flight, Policy::fused);
  std::printf("flow %.4f, fused %.4f m/s\n", by_flow, fused);
  EXPECT_LT(fused, 1.1 * by_flow);
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

// The world stays the one of the first frame as it was given; what is up in it is told.
TEST(FusedNavigator, TellsWhatIsUpThoughItsStartLeans) {
  const test::RenderedFlight& flight = test::rendered_flight();
  NavigatorConfig config;
  config.fusion.flat_ground = true;
  config.initial_tilt_sigma_rad = 0.1;
  const Eigen::Quaterniond leaning = so3_exp({0.08, -0.05, 0});
  InitialState start = flight.start();
  start.world_from_body.rotation = leaning * start.world_from_body.rotation;
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, config, start,
                      {.policy = Policy::fused});
  NavigationEstimate last;
  for (const Frame& frame : flight.frames) last = navigator.step(frame);
  ASSERT_TRUE(last.up_in_world);
  EXPECT_LT((*last.up_in_world - leaning * Eigen::Vector3d::UnitZ()).norm(), 0.005);
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

TEST(FusedNavigator, FeaturesThatAreNumberedAnewAreAnError) {
  NavigatorConfig config;
  config.reference.association = Association::matching;
  EXPECT_THROW((Navigator(small_camera(), kForwardMount, config, {.world_from_body = Sway::pose(0)},
                          {.policy = Policy::fused})),
               InputError);
}

TEST(FusedNavigator, MoreLandmarksNeededThanThereAreIsAnError) {
  NavigatorConfig config;
  config.fusion.landmarks = 8;
  EXPECT_THROW((Navigator(small_camera(), kForwardMount, config, {.world_from_body = Sway::pose(0)},
                          {.policy = Policy::fused})),
               InputError);
}

}  // namespace
}  // namespace stillkite
