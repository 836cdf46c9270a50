#include "estimation/plane/plane_alignment.hpp"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "estimation/plane/keyframe_pose.hpp"
#include "tests/estimation/plane/plane_views.hpp"

namespace stillkite {
namespace {

using test::align;
using test::kFirst;
using test::kSecond;
using test::lens;
using test::pose;
using test::render;
using test::rotation_error_rad;
using test::translation_error;

// 0.1 px corresponds to 3e-4 rad or 3e-4 heights.
class PlaneAlignmentLens : public testing::TestWithParam<DistortionModel> {};

TEST_P(PlaneAlignmentLens, RecoversMotionFromZeroInitialMotion) {
  const Camera camera = lens(GetParam());
  const PlaneMotion truth = motion_between(kFirst, kSecond);
  const PlaneAlignment alignment = align(camera, render(camera, kFirst), render(camera, kSecond),
                                         motion_between(kFirst, kFirst));
  ASSERT_TRUE(alignment.solvable);
  EXPECT_LT(rotation_error_rad(alignment.motion, truth), 3e-4);
  EXPECT_LT(translation_error(alignment.motion, truth), 3e-4);
  EXPECT_GT(alignment.correlation, 0.98);
}

INSTANTIATE_TEST_SUITE_P(Distortions, PlaneAlignmentLens,
                         testing::Values(DistortionModel::none, DistortionModel::radial_tangential,
                                         DistortionModel::equidistant));

TEST(PlaneAlignment, SwappedImagesGiveInverseMotion) {
  const Camera camera = lens(DistortionModel::none);
  const cv::Mat first = render(camera, kFirst);
  const cv::Mat second = render(camera, kSecond);
  const PlaneAlignment forward = align(camera, first, second, motion_between(kFirst, kFirst));
  const PlaneAlignment backward = align(camera, second, first, motion_between(kSecond, kSecond));
  // unit of length: height of the respective reference camera
  const RigidTransform a{forward.motion.rotation, 1.0 * forward.motion.translation};
  const RigidTransform b{backward.motion.rotation, 1.02 * backward.motion.translation};
  const RigidTransform round_trip = a * b;
  EXPECT_LT(round_trip.translation.norm(), 5e-4);
  EXPECT_LT(so3_log(round_trip.rotation).norm(), 5e-4);
}

TEST(PlaneAlignment, IsInvariantToExposureChange) {
  const Camera camera = lens(DistortionModel::none);
  const PlaneMotion truth = motion_between(kFirst, kSecond);
  const PlaneAlignment alignment =
      align(camera, render(camera, kFirst, 0.7), render(camera, kSecond, 0.9, 10),
            motion_between(kFirst, kFirst));
  ASSERT_TRUE(alignment.solvable);
  EXPECT_LT(translation_error(alignment.motion, truth), 5e-4);
  EXPECT_NEAR(alignment.gain, 0.9 / 0.7, 0.02);
}

TEST(PlaneAlignment, RecoversLargeRotationWithExactWarp) {
  const Camera camera = lens(DistortionModel::radial_tangential);
  const RigidTransform rotated = pose(0.1, 0.05, 1.1, 0.05, -0.1, 0.5);
  const PlaneMotion truth = motion_between(kFirst, rotated);
  const RigidTransform near = pose(0.11, 0.045, 1.09, 0.05, -0.1, 0.49);
  const PlaneAlignment alignment =
      align(camera, render(camera, kFirst), render(camera, rotated), motion_between(kFirst, near));
  ASSERT_TRUE(alignment.solvable);
  EXPECT_LT(rotation_error_rad(alignment.motion, truth), 5e-4);
  EXPECT_LT(translation_error(alignment.motion, truth), 5e-4);
}

TEST(PlaneAlignment, TranslationMakesTiltObservable) {
  const Camera camera = lens(DistortionModel::none);
  const RigidTransform moved = pose(0.25, 0.1, 1.0, 0.1, -0.15, 0.2);
  // attitude error of 1 deg about world x in both poses
  const double tilt_error_rad = 0.0175;
  const Eigen::Quaterniond tilt_error = so3_exp({tilt_error_rad, 0, 0});
  const PoseEstimate keyframe{{tilt_error * kFirst.rotation, kFirst.translation},
                              1e-3 * Matrix6d::Identity()};
  const RigidTransform initial{tilt_error * moved.rotation, moved.translation};
  const LevellingConfig levelling{.ground_slope_sigma_rad = 0};
  const PlaneAlignment alignment =
      align(camera, render(camera, kFirst), render(camera, moved),
            motion_between(keyframe.world_from_camera, initial), tilt_prior(keyframe, levelling));
  const ChainedPose chained = chain(keyframe, alignment, levelling);
  EXPECT_LT(angle_between_rad(chained.keyframe.world_from_camera.rotation, kFirst.rotation),
            0.1 * tilt_error_rad);
  EXPECT_LT(angle_between_rad(chained.camera.world_from_camera.rotation, moved.rotation),
            0.1 * tilt_error_rad);
}

TEST(PlaneAlignment, CompensatesRollingShutter) {
  const Camera camera = lens(DistortionModel::none);
  const double readout_s = 0.03;
  const Eigen::Vector3d velocity(0.5, 0.2, 0.3);
  const auto at = [&](double t_s) {
    return RigidTransform{kFirst.rotation, kFirst.translation + velocity * t_s};
  };
  const auto rolling = [&](double stamp_s) {
    return render(camera,
                  [&, stamp_s](int row) { return at(stamp_s + readout_s * (row - 119.5) / 240); });
  };
  // rest, then motion: only the second image is sheared
  const PlaneMotion truth = motion_between(at(0), at(0.1));
  RollingShutter shutter{.readout_s = readout_s};
  shutter.current_twist.head<3>() = kFirst.rotation.conjugate() * velocity;
  const cv::Mat first = render(camera, at(0));
  const PlaneAlignment with = align(camera, first, rolling(0.1), truth, {}, shutter);
  const PlaneAlignment without = align(camera, first, rolling(0.1), truth);
  EXPECT_LT(translation_error(with.motion, truth), 7e-4);
  EXPECT_GT(translation_error(without.motion, truth), 3 * translation_error(with.motion, truth));
}

// Climb at 2 heights/s with sideways motion, rolling shutter.
struct RollingClimb {
  Camera camera = lens(DistortionModel::none);
  double readout_s = 0.016;
  Eigen::Vector3d velocity{0.8, -0.5, 2.0};
  Eigen::Vector3d rate_rad_s{0.1, 0.2, -0.3};

  [[nodiscard]] RigidTransform at(double t_s) const {
    return {kFirst.rotation * so3_exp(rate_rad_s * t_s), kFirst.translation + velocity * t_s};
  }
  [[nodiscard]] Vector6d twist(double t_s) const {
    Vector6d twist;
    twist << at(t_s).rotation.conjugate() * velocity, rate_rad_s;
    return twist;
  }
  [[nodiscard]] cv::Mat image_at(double stamp_s) const {
    return render(camera, [&](int row) { return at(stamp_s + readout_s * (row - 119.5) / 240); });
  }
  [[nodiscard]] static TiltPrior wide_tilt_prior() {
    return {.axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>(),
            .covariance = Eigen::Matrix2d(Eigen::Matrix2d::Identity())};
  }
  [[nodiscard]] PlaneAlignment align_for(const RollingShutter& shutter) const {
    return align(camera, image_at(0), image_at(kInterval_s), motion_between(at(0), at(kInterval_s)),
                 wide_tilt_prior(), shutter);
  }
  static constexpr double kInterval_s = 0.1;
};

// Both images are stretched equally; the second-order difference resembles a plane tilt.
TEST(PlaneAlignment, CompensatedRollingShutterCausesNoTiltInClimb) {
  const RollingClimb climb;
  const PlaneMotion truth = motion_between(climb.at(0), climb.at(RollingClimb::kInterval_s));
  const PlaneAlignment without = climb.align_for({});
  const PlaneAlignment with =
      climb.align_for({climb.readout_s, climb.twist(0), climb.twist(RollingClimb::kInterval_s)});
  EXPECT_GT(without.tilt_rad.norm(), 0.03);
  EXPECT_LT(with.tilt_rad.norm(), 0.002);
  EXPECT_LT(translation_error(with.motion, truth), 1e-3);
  EXPECT_LT(rotation_error_rad(with.motion, truth), 1e-3);
}

TEST(PlaneAlignment, MotionByTwistPredictsEffectOfTwistError) {
  const RollingClimb climb;
  const auto aligned_with = [&](const Vector6d& change) {
    return climb.align_for(
        {climb.readout_s, climb.twist(0), climb.twist(RollingClimb::kInterval_s) + change});
  };
  const PlaneAlignment alignment = aligned_with(Vector6d::Zero());
  for (int k = 0; k < 6; ++k) {
    const Vector6d change = 0.1 * Vector6d::Unit(k);
    const PlaneMotion slower = aligned_with(-change).motion, faster = aligned_with(change).motion;
    const Eigen::Quaterniond rotation = faster.rotation * slower.rotation.conjugate();
    Vector6d difference;
    difference << faster.translation - rotation * slower.translation, so3_log(rotation);
    const Vector6d predicted = 2 * alignment.motion_by_twist * change;
    EXPECT_LT((difference - predicted).norm(), 0.15 * difference.norm()) << k;
  }
}

TEST(PlaneAlignment, UniformImageIsNotSolvableAndKeepsInitialMotion) {
  const Camera camera = lens(DistortionModel::none);
  const cv::Mat uniform(camera.height_px, camera.width_px, CV_8U, cv::Scalar(90));
  const PlaneMotion initial = motion_between(kFirst, kSecond);
  const PlaneAlignment alignment = align(camera, uniform, uniform, initial);
  EXPECT_FALSE(alignment.solvable);
  EXPECT_EQ(alignment.motion.translation, initial.translation);
  EXPECT_TRUE(alignment.covariance.allFinite());
}

// The correlation is computed from a difference of large sums: rounding errors of either sign.
TEST(PlaneAlignment, UniformImageHasLowCorrelation) {
  const Camera camera = lens(DistortionModel::none);
  cv::Mat keyframe(camera.height_px, camera.width_px, CV_8U);
  for (int seed = 0; seed < 40; ++seed) {
    cv::RNG(static_cast<std::uint64_t>(seed) + 1).fill(keyframe, cv::RNG::NORMAL, 110, 90);
    cv::GaussianBlur(keyframe, keyframe, {}, 1.5);
    for (const int grey : {0, 77, 255}) {
      const cv::Mat uniform(keyframe.size(), CV_8U, cv::Scalar(grey));
      EXPECT_LT(align(camera, keyframe, uniform, {}).correlation, 0.5) << seed << ' ' << grey;
    }
  }
}

TEST(PlaneTiles, JacobianIsDerivativeOfPlacement) {
  for (const auto model :
       {DistortionModel::none, DistortionModel::radial_tangential, DistortionModel::equidistant}) {
    const Camera camera = lens(model);
    const TileGrid grid = make_tile_grid(camera.width_px, camera.height_px, 16, 8);
    const TileRays rays = make_tile_rays(camera, grid);
    const PlaneMotion motion = motion_between(kFirst, kSecond);
    const TiltAxes axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
    TilePlacement centre, plus, minus;
    TileJacobian jacobian, unused;
    place_tiles(camera, rays, motion, axes, centre, jacobian);
    for (int a = 0; a < TileJacobian::kParameters; ++a) {
      const double h = 2e-3;  // placements are single precision
      PlaneMotionStep step = PlaneMotionStep::Zero();
      step[a] = h;
      place_tiles(camera, rays, apply(motion, step, axes), axes, plus, unused);
      place_tiles(camera, rays, apply(motion, -step, axes), axes, minus, unused);
      for (std::size_t i = 0; i < grid.centre_x_px.size(); ++i) {
        if (rays.usable[i] == 0) continue;
        EXPECT_NEAR(jacobian.x(a)[i], (plus.x_px[i] - minus.x_px[i]) / (2 * h), 0.2) << a;
        EXPECT_NEAR(jacobian.y(a)[i], (plus.y_px[i] - minus.y_px[i]) / (2 * h), 0.2) << a;
      }
    }
  }
}

// A common row delay equals the camera motion over that delay.
TEST(PlaneTiles, RowDelayMovesTilesWithCamera) {
  const Camera camera = lens(DistortionModel::radial_tangential);
  const TileGrid grid = make_tile_grid(camera.width_px, camera.height_px, 16, 8);
  const TileRays rays = make_tile_rays(camera, grid);
  const PlaneMotion motion = motion_between(kFirst, kSecond);
  constexpr double kDelay_s = 0.01;
  TileTimes times{.row_delay_s = std::vector<float>(rays.x.size(), static_cast<float>(kDelay_s)),
                  .twist = {}};
  times.twist << 1, -0.5, 2, 0.3, -0.2, 0.4;  // kFirst is at a height of 1 m
  const RigidTransform delayed_pose =
      kSecond *
      RigidTransform{so3_exp(kDelay_s * times.twist.tail<3>()), kDelay_s * times.twist.head<3>()};
  const TiltAxes axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
  TilePlacement delayed, expected;
  TileJacobian unused;
  place_tiles(camera, rays, motion, axes, delayed, unused, &times);
  place_tiles(camera, rays, motion_between(kFirst, delayed_pose), axes, expected, unused);
  for (std::size_t i = 0; i < rays.x.size(); ++i) {
    EXPECT_NEAR(delayed.x_px[i], expected.x_px[i], 0.01) << i;
    EXPECT_NEAR(delayed.y_px[i], expected.y_px[i], 0.01) << i;
  }
}

TEST(PlaneAlignment, MotionIsIndependentOfVectorWidth) {
  const Camera camera = lens(DistortionModel::radial_tangential);
  const cv::Mat first = render(camera, kFirst);
  const cv::Mat second = render(camera, kSecond);
  const PlaneMotion rest = motion_between(kFirst, kFirst);
  const PlaneAlignment wide = align(camera, first, second, rest);
  hwy::SetSupportedTargetsForTest(HWY_STATIC_TARGET);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  const PlaneAlignment narrow = align(camera, first, second, rest);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  // the summation order may change the number of steps of a level at the convergence threshold
  EXPECT_LT(translation_error(wide.motion, narrow.motion), 1e-4);
  EXPECT_LT(rotation_error_rad(wide.motion, narrow.motion), 1e-4);
}

}  // namespace
}  // namespace stillkite
