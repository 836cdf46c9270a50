#include "estimation/plane/plane_alignment.hpp"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "estimation/plane/keyframe_pose.hpp"
#include "geometry/euler.hpp"

namespace stillkite {
namespace {

constexpr int kLevels = 3;

Camera lens(DistortionModel model) {
  Camera camera{.width_px = 320,
                .height_px = 240,
                .focal_x_px = 300,
                .focal_y_px = 305,
                .centre_x_px = 161,
                .centre_y_px = 118,
                .distortion = model};
  if (model != DistortionModel::none) camera.coefficients = {-0.2, 0.05};
  return camera;
}

RigidTransform pose(double x, double y, double z, double roll, double pitch, double yaw) {
  const Eigen::Quaterniond down(0, 1, 0, 0);  // x of the camera is x of the body, z looks down
  return {to_quaternion({.yaw_rad = yaw, .pitch_rad = pitch, .roll_rad = roll}) * down, {x, y, z}};
}

// Grey of the ground, smooth and known everywhere.
double ground(double x, double y) {
  return 128 + 30 * std::sin(23 * x + 5 * y) + 25 * std::sin(31 * y - 11 * x) +
         20 * std::sin(44 * x + 37 * y) + 15 * std::sin(61 * x - 47 * y);
}

// The image of the ground, each row from a pose of its own.
cv::Mat image(const Camera& camera, const std::function<RigidTransform(int)>& pose_of_row,
              double gain = 1, double offset = 0) {
  cv::Mat image(camera.height_px, camera.width_px, CV_8U);
  for (int row = 0; row < image.rows; ++row) {
    const RigidTransform world_from_camera = pose_of_row(row);
    for (int column = 0; column < image.cols; ++column) {
      const auto bearing = undistort(camera, {column, row});
      const Eigen::Vector3d ray = world_from_camera.rotation * bearing.value().homogeneous();
      const Eigen::Vector3d hit =
          world_from_camera.translation - ray * (world_from_camera.translation.z() / ray.z());
      image.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(gain * ground(hit.x(), hit.y()) + offset);
    }
  }
  return image;
}
cv::Mat image(const Camera& camera, const RigidTransform& at, double gain = 1, double offset = 0) {
  return image(
      camera, [&](int) { return at; }, gain, offset);
}

PlaneAlignment align(const Camera& camera, const cv::Mat& reference, const cv::Mat& current,
                     const PlaneMotion& guess, const TiltPrior& tilt = {},
                     const RollingShutter& shutter = {}) {
  Pyramid a, b;
  a.build(reference, kLevels);
  b.build(current, kLevels);
  PlaneAligner aligner(camera, {.levels = kLevels});
  aligner.set_reference(a);
  return aligner.align(b, guess, tilt, shutter);
}

double turn_error_rad(const PlaneMotion& a, const PlaneMotion& b) {
  return angle_between_rad(a.rotation, b.rotation);
}
double shift_error(const PlaneMotion& a, const PlaneMotion& b) {
  return (a.translation - b.translation).norm();
}

const RigidTransform kFirst = pose(0, 0, 1.0, 0.1, -0.15, 0.2);
const RigidTransform kSecond = pose(0.03, -0.02, 1.02, 0.11, -0.14, 0.22);

// A tenth of a pixel is 3e-4 rad here, or as many heights.
class ThroughLens : public testing::TestWithParam<DistortionModel> {};

TEST_P(ThroughLens, recovers_the_exact_motion_from_a_guess_of_rest) {
  const Camera camera = lens(GetParam());
  const PlaneMotion truth = motion_between(kFirst, kSecond);
  const PlaneAlignment found =
      align(camera, image(camera, kFirst), image(camera, kSecond), motion_between(kFirst, kFirst));
  ASSERT_TRUE(found.solvable);
  EXPECT_LT(turn_error_rad(found.motion, truth), 3e-4);
  EXPECT_LT(shift_error(found.motion, truth), 3e-4);
  EXPECT_GT(found.correlation, 0.98);
}

INSTANTIATE_TEST_SUITE_P(Lenses, ThroughLens,
                         testing::Values(DistortionModel::none, DistortionModel::radial_tangential,
                                         DistortionModel::equidistant));

TEST(PlaneAlignment, swapped_images_give_the_inverse_motion) {
  const Camera camera = lens(DistortionModel::none);
  const cv::Mat first = image(camera, kFirst);
  const cv::Mat second = image(camera, kSecond);
  const PlaneAlignment there = align(camera, first, second, motion_between(kFirst, kFirst));
  const PlaneAlignment back = align(camera, second, first, motion_between(kSecond, kSecond));
  // lengths are in heights of each one's own reference camera
  const RigidTransform a{there.motion.rotation, 1.0 * there.motion.translation};
  const RigidTransform b{back.motion.rotation, 1.02 * back.motion.translation};
  const RigidTransform both = a * b;
  EXPECT_LT(both.translation.norm(), 5e-4);
  EXPECT_LT(so3_log(both.rotation).norm(), 5e-4);
}

TEST(PlaneAlignment, a_change_of_exposure_costs_nothing) {
  const Camera camera = lens(DistortionModel::none);
  const PlaneMotion truth = motion_between(kFirst, kSecond);
  const PlaneAlignment found =
      align(camera, image(camera, kFirst, 0.7), image(camera, kSecond, 0.9, 10),
            motion_between(kFirst, kFirst));
  ASSERT_TRUE(found.solvable);
  EXPECT_LT(shift_error(found.motion, truth), 5e-4);
  EXPECT_NEAR(found.gain, 0.9 / 0.7, 0.02);
}

TEST(PlaneAlignment, a_large_turn_is_warped_exactly) {
  const Camera camera = lens(DistortionModel::radial_tangential);
  const RigidTransform turned = pose(0.1, 0.05, 1.1, 0.05, -0.1, 0.5);
  const PlaneMotion truth = motion_between(kFirst, turned);
  const RigidTransform near = pose(0.11, 0.045, 1.09, 0.05, -0.1, 0.49);
  const PlaneAlignment found =
      align(camera, image(camera, kFirst), image(camera, turned), motion_between(kFirst, near));
  ASSERT_TRUE(found.solvable);
  EXPECT_LT(turn_error_rad(found.motion, truth), 5e-4);
  EXPECT_LT(shift_error(found.motion, truth), 5e-4);
}

TEST(PlaneAlignment, translation_shows_the_tilt_of_the_ground) {
  const Camera camera = lens(DistortionModel::none);
  const RigidTransform moved = pose(0.25, 0.1, 1.0, 0.1, -0.15, 0.2);
  // the attitude of both is believed one degree off about the world's x
  const double wrong = 0.0175;
  const Eigen::Quaterniond off = so3_exp({wrong, 0, 0});
  const PoseEstimate believed{{off * kFirst.rotation, kFirst.translation},
                              1e-3 * Matrix6d::Identity()};
  const RigidTransform guess{off * moved.rotation, moved.translation};
  const LevellingConfig levelling{.ground_slope_sigma_rad = 0, .flow_sigma_rad = 0};
  const PlaneAlignment found =
      align(camera, image(camera, kFirst), image(camera, moved),
            motion_between(believed.world_from_camera, guess), tilt_prior(believed, levelling));
  const ChainedPose chained = chain(believed, found, levelling);
  EXPECT_LT(angle_between_rad(chained.keyframe.world_from_camera.rotation, kFirst.rotation),
            0.1 * wrong);
  EXPECT_LT(angle_between_rad(chained.camera.world_from_camera.rotation, moved.rotation),
            0.1 * wrong);
}

// What the windows say by themselves of ground and motion does not hang on what was believed
// before, nor on how firmly.
TEST(PlaneAlignment, the_windows_alone_know_nothing_of_the_prior) {
  const Camera camera = lens(DistortionModel::none);
  const RigidTransform moved = pose(0.25, 0.1, 1.0, 0.1, -0.15, 0.2);
  const PlaneMotion truth = motion_between(kFirst, moved);
  const cv::Mat first = image(camera, kFirst), second = image(camera, moved);
  TiltPrior prior;
  prior.axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
  PlaneMotion believed = truth;
  believed.normal = so3_exp(prior.axes * Eigen::Vector2d(0.006, -0.008)) * truth.normal;
  const double wrong = (believed.normal - truth.normal).norm();
  for (const double sigma_rad : {1e-4, 1e-3, 0.1}) {
    prior.covariance = sigma_rad * sigma_rad * Eigen::Matrix2d::Identity();
    const PlaneAlignment found = align(camera, first, second, believed, prior);
    ASSERT_TRUE(found.solvable);
    const WindowsAlone& alone = found.windows_alone;
    const Eigen::Vector2d tilt = alone.tilt_information.ldlt().solve(alone.tilt_information_rad);
    PlaneMotionStep step;
    step << alone.motion_by_tilt * tilt, tilt;
    const PlaneMotion by_windows = apply(found.motion, step, prior.axes);
    // the last step's residue counts a prior's worth where the prior is as firm as that
    EXPECT_LT((by_windows.normal - truth.normal).norm(), 0.4 * wrong) << sigma_rad;
    EXPECT_LT(turn_error_rad(by_windows, truth), 0.1 * wrong) << sigma_rad;
    EXPECT_LT(shift_error(by_windows, truth), 0.15 * wrong) << sigma_rad;
  }
}

// A climb differs from a climb under another tilt in second order only: what an error of the lens
// can feign as well must not count as knowledge. Translation along the ground still shows it.
TEST(PlaneAlignment, a_climb_says_little_of_the_tilt_where_the_flow_may_err) {
  const Camera camera = lens(DistortionModel::none);
  const double tilt_sigma = 0.02;
  const auto tilt_sigma_after = [&](const RigidTransform& moved, double flow_sigma_rad) {
    TiltPrior prior;
    prior.axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
    prior.covariance = tilt_sigma * tilt_sigma * Eigen::Matrix2d::Identity();
    prior.flow_sigma_rad = flow_sigma_rad;
    const PlaneAlignment found = align(camera, image(camera, kFirst), image(camera, moved),
                                       motion_between(kFirst, moved), prior);
    EXPECT_LT(shift_error(found.motion, motion_between(kFirst, moved)), 2e-3);
    return std::sqrt(found.covariance.bottomRightCorner<2, 2>().diagonal().maxCoeff());
  };
  RigidTransform higher = kFirst, aside = kFirst;
  higher.translation.z() *= 1.15;
  aside.translation.y() += 0.3 * kFirst.translation.z();
  EXPECT_LT(tilt_sigma_after(higher, 0), 0.7 * tilt_sigma);
  EXPECT_GT(tilt_sigma_after(higher, 1e-3), 0.98 * tilt_sigma);
  EXPECT_LT(tilt_sigma_after(higher, 1e-3), 1.01 * tilt_sigma);
  EXPECT_LT(tilt_sigma_after(aside, 1e-3), 0.9 * tilt_sigma);
}

TEST(PlaneAlignment, a_rolling_shutter_is_undone_by_its_readout_time) {
  const Camera camera = lens(DistortionModel::none);
  const double readout_s = 0.03;
  const Eigen::Vector3d velocity(0.5, 0.2, 0.3);
  const auto at = [&](double t_s) {
    return RigidTransform{kFirst.rotation, kFirst.translation + velocity * t_s};
  };
  const auto rolling = [&](double stamp_s) {
    return image(camera,
                 [&, stamp_s](int row) { return at(stamp_s + readout_s * (row - 119.5) / 240); });
  };
  // at rest, then moving: the second image alone is sheared
  const PlaneMotion truth = motion_between(at(0), at(0.1));
  RollingShutter shutter{.readout_s = readout_s};
  shutter.current_twist.head<3>() = kFirst.rotation.conjugate() * velocity;
  const cv::Mat first = image(camera, at(0));
  const PlaneAlignment with = align(camera, first, rolling(0.1), truth, {}, shutter);
  const PlaneAlignment without = align(camera, first, rolling(0.1), truth);
  EXPECT_LT(shift_error(with.motion, truth), 7e-4);
  EXPECT_GT(shift_error(without.motion, truth), 3 * shift_error(with.motion, truth));
}

// A climb of two heights a second, aside as well, by a camera that exposes row after row.
struct RollingClimb {
  Camera camera = lens(DistortionModel::none);
  double readout_s = 0.016;
  Eigen::Vector3d velocity{0.8, -0.5, 2.0};
  Eigen::Vector3d turn_rad_s{0.1, 0.2, -0.3};

  [[nodiscard]] RigidTransform at(double t_s) const {
    return {kFirst.rotation * so3_exp(turn_rad_s * t_s), kFirst.translation + velocity * t_s};
  }
  [[nodiscard]] Vector6d twist(double t_s) const {
    Vector6d twist;
    twist << at(t_s).rotation.conjugate() * velocity, turn_rad_s;
    return twist;
  }
  [[nodiscard]] cv::Mat seen(double stamp_s) const {
    return image(camera, [&](int row) { return at(stamp_s + readout_s * (row - 119.5) / 240); });
  }
  [[nodiscard]] static TiltPrior vague_tilt() {
    return {.axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>(),
            .covariance = Eigen::Matrix2d(Eigen::Matrix2d::Identity())};
  }
  [[nodiscard]] PlaneAlignment align_for(const RollingShutter& shutter) const {
    return align(camera, seen(0), seen(kLater_s), motion_between(at(0), at(kLater_s)), vague_tilt(),
                 shutter);
  }
  static constexpr double kLater_s = 0.1;
};

// Both images are stretched alike; what is left of it looks like a tilt of the plane.
TEST(PlaneAlignment, a_rolling_shutter_feigns_no_tilt_in_a_climb) {
  const RollingClimb climb;
  const PlaneMotion truth = motion_between(climb.at(0), climb.at(RollingClimb::kLater_s));
  const PlaneAlignment without = climb.align_for({});
  const PlaneAlignment with =
      climb.align_for({climb.readout_s, climb.twist(0), climb.twist(RollingClimb::kLater_s)});
  EXPECT_GT(without.tilt_rad.norm(), 0.03);
  EXPECT_LT(with.tilt_rad.norm(), 0.002);
  EXPECT_LT(shift_error(with.motion, truth), 1e-3);
  EXPECT_LT(turn_error_rad(with.motion, truth), 1e-3);
}

TEST(PlaneAlignment, what_a_rolling_shutter_makes_of_a_false_twist_is_foreseen) {
  const RollingClimb climb;
  const auto found_for = [&](const Vector6d& change) {
    return climb.align_for(
        {climb.readout_s, climb.twist(0), climb.twist(RollingClimb::kLater_s) + change});
  };
  const PlaneAlignment found = found_for(Vector6d::Zero());
  for (int k = 0; k < 6; ++k) {
    const Vector6d change = 0.1 * Vector6d::Unit(k);
    const PlaneMotion slower = found_for(-change).motion, faster = found_for(change).motion;
    const Eigen::Quaterniond turn = faster.rotation * slower.rotation.conjugate();
    Vector6d difference;
    difference << faster.translation - turn * slower.translation, so3_log(turn);
    const Vector6d foreseen = 2 * found.motion_by_twist * change;
    EXPECT_LT((difference - foreseen).norm(), 0.15 * difference.norm()) << k;
  }
}

TEST(PlaneAlignment, a_bare_image_is_not_solvable_and_keeps_the_guess) {
  const Camera camera = lens(DistortionModel::none);
  const cv::Mat bare(camera.height_px, camera.width_px, CV_8U, cv::Scalar(90));
  const PlaneMotion guess = motion_between(kFirst, kSecond);
  const PlaneAlignment found = align(camera, bare, bare, guess);
  EXPECT_FALSE(found.solvable);
  EXPECT_EQ(found.motion.translation, guess.translation);
  EXPECT_TRUE(found.covariance.allFinite());
}

// What is left of sums as large as the keyframe's contrast is rounding, which may well be positive.
TEST(PlaneAlignment, a_bare_image_correlates_with_nothing) {
  const Camera camera = lens(DistortionModel::none);
  cv::Mat keyframe(camera.height_px, camera.width_px, CV_8U);
  for (int seed = 0; seed < 40; ++seed) {
    cv::RNG(static_cast<std::uint64_t>(seed) + 1).fill(keyframe, cv::RNG::NORMAL, 110, 90);
    cv::GaussianBlur(keyframe, keyframe, {}, 1.5);
    for (const int grey : {0, 77, 255}) {
      const cv::Mat bare(keyframe.size(), CV_8U, cv::Scalar(grey));
      EXPECT_LT(align(camera, keyframe, bare, {}).correlation, 0.5) << seed << ' ' << grey;
    }
  }
}

TEST(PlaneTiles, jacobian_is_the_derivative_of_the_placement) {
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

// Where all tiles are seen late, by as much, the camera itself has gone on.
TEST(PlaneTiles, late_tiles_are_where_the_camera_sees_them_by_then) {
  const Camera camera = lens(DistortionModel::radial_tangential);
  const TileGrid grid = make_tile_grid(camera.width_px, camera.height_px, 16, 8);
  const TileRays rays = make_tile_rays(camera, grid);
  const PlaneMotion motion = motion_between(kFirst, kSecond);
  constexpr double kLate_s = 0.01;
  TileTimes times{.later_s = std::vector<float>(rays.x.size(), static_cast<float>(kLate_s)),
                  .twist = {}};
  times.twist << 1, -0.5, 2, 0.3, -0.2, 0.4;  // kFirst is a metre high
  const RigidTransform by_then = kSecond * RigidTransform{so3_exp(kLate_s * times.twist.tail<3>()),
                                                          kLate_s * times.twist.head<3>()};
  const TiltAxes axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
  TilePlacement late, expected;
  TileJacobian unused;
  place_tiles(camera, rays, motion, axes, late, unused, &times);
  place_tiles(camera, rays, motion_between(kFirst, by_then), axes, expected, unused);
  for (std::size_t i = 0; i < rays.x.size(); ++i) {
    EXPECT_NEAR(late.x_px[i], expected.x_px[i], 0.01) << i;
    EXPECT_NEAR(late.y_px[i], expected.y_px[i], 0.01) << i;
  }
}

TEST(PlaneAlignment, narrow_vectors_find_the_same_motion) {
  const Camera camera = lens(DistortionModel::radial_tangential);
  const cv::Mat first = image(camera, kFirst);
  const cv::Mat second = image(camera, kSecond);
  const PlaneMotion rest = motion_between(kFirst, kFirst);
  const PlaneAlignment wide = align(camera, first, second, rest);
  hwy::SetSupportedTargetsForTest(HWY_STATIC_TARGET);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  const PlaneAlignment narrow = align(camera, first, second, rest);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  // sums in another order may end a level a step sooner, when it moves by less than 0.005 px
  EXPECT_LT(shift_error(wide.motion, narrow.motion), 1e-4);
  EXPECT_LT(turn_error_rad(wide.motion, narrow.motion), 1e-4);
}

}  // namespace
}  // namespace stillkite
