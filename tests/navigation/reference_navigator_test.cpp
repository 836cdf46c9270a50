#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "flow/frame.hpp"
#include "geometry/angle.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite {
namespace {

const RigidTransform kMount = camera_raised_forward(80);

/// Images of a room from a level body.
class RoomView {
 public:
  RoomView() : scene_(make_room(5)), renderer_(small_camera(), 2) {}

  [[nodiscard]] cv::Mat image(const RigidTransform& world_from_body, int seed) const {
    return develop(renderer_.render(scene_, world_from_body * kMount), {.noise_grey = 1.5}, seed);
  }

 private:
  PatchScene scene_;
  PatchRenderer renderer_;
};

const RoomView& room() {
  static const RoomView view;
  return view;
}

RigidTransform at(const Eigen::Vector3d& position_m, double yaw_deg) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_deg * kDegree, Eigen::Vector3d::UnitZ())),
          position_m};
}

const Eigen::Vector3d kReference_m(0, 0, 1.8);

Frame frame_of(const cv::Mat& image, int index) {
  return {.stamp = from_seconds(index / 30.0), .index = index, .grey = image};
}

Navigator make_reference_navigator(Mode mode = Mode::recommended,
                                   const ReferenceConfig& reference = {}) {
  NavigatorConfig config;
  config.reference = reference;
  return {small_camera(),
          kMount,
          config,
          {.world_from_body = at(kReference_m, 0)},
          {.policy = Policy::reference, .mode = mode}};
}

// Errors of the rotation and of the displacement direction since the reference.
struct ReferenceErrors {
  double rotation_deg;
  double direction_deg;
};
ReferenceErrors errors_of(const NavigationEstimate& estimate, const RigidTransform& truth) {
  const RigidTransform reference_from_camera =
      (at(kReference_m, 0) * kMount).inverse() * (truth * kMount);
  const MotionEstimate& motion = estimate.reference->motion;
  return {angle_between_rad(motion.reference_from_camera, reference_from_camera.rotation) / kDegree,
          angle_between_rad(motion.displacement_in_reference, reference_from_camera.translation) /
              kDegree};
}

TEST(ReferenceNavigator, EstimatesRotationAndDirectionFromFixedReference) {
  Navigator navigator = make_reference_navigator();
  EXPECT_EQ(navigator.step(frame_of(room().image(at(kReference_m, 0), 0), 0)).verdict,
            Verdict::first_frame);
  for (int i = 1; i <= 10; ++i) {
    const RigidTransform truth = at(kReference_m + Eigen::Vector3d(0.02, -0.05, 0.03) * i, 0.4 * i);
    const NavigationEstimate estimate = navigator.step(frame_of(room().image(truth, i), i));
    ASSERT_EQ(estimate.verdict, Verdict::ok) << i;
    EXPECT_EQ(estimate.scale, ScaleSource::none);
    if (i < 4) continue;
    EXPECT_EQ(estimate.reference->motion.displacement_kind, DisplacementKind::direction) << i;
    EXPECT_LT(errors_of(estimate, truth).rotation_deg, 0.2) << i;
    EXPECT_LT(errors_of(estimate, truth).direction_deg, 3) << i;
  }
}

// Mean squared rotation error over the trace of its covariance: 1 if consistent. The navigator's
// lens differs from the camera's by 0.2 px RMS.
double rotation_error_ratio_with_lens_error(double lens_sigma_px) {
  Camera camera = small_camera();
  camera.coefficients[0] += 0.003;
  NavigatorConfig config;
  config.lens_sigma_px = lens_sigma_px;
  Navigator navigator(camera, kMount, config, {.world_from_body = at(kReference_m, 0)},
                      {.policy = Policy::reference});
  (void)navigator.step(frame_of(room().image(at(kReference_m, 0), 0), 0));
  double sum = 0;
  constexpr int kPoses = 10;
  for (int i = 1; i <= kPoses; ++i) {
    const RigidTransform truth = at(kReference_m + Eigen::Vector3d(0.02, -0.05, 0.03) * i, 0.8 * i);
    const NavigationEstimate estimate = navigator.step(frame_of(room().image(truth, i), i));
    EXPECT_EQ(estimate.verdict, Verdict::ok) << i;
    const double error_rad = errors_of(estimate, truth).rotation_deg * kDegree;
    sum += error_rad * error_rad / estimate.reference->motion.rotation_covariance.trace();
  }
  return sum / kPoses;
}

TEST(ReferenceNavigator, CovarianceContainsTheLensError) {
  EXPECT_GT(rotation_error_ratio_with_lens_error(0), 4);
  EXPECT_LT(rotation_error_ratio_with_lens_error(0.2), 2);
}

TEST(ReferenceNavigator, HoldPaperChainIsLessAccurate) {
  ReferenceConfig paper;
  paper.detector = DetectorConfig{};
  paper.association = Association::opencv;
  paper.solver = PoseSolver::opencv;
  Navigator navigator = make_reference_navigator(Mode::paper, paper);
  (void)navigator.step(frame_of(room().image(at(kReference_m, 0), 0), 0));
  const RigidTransform truth = at(kReference_m + Eigen::Vector3d(0.2, -0.4, 0.1), 2);
  const NavigationEstimate estimate = navigator.step(frame_of(room().image(truth, 1), 1));
  ASSERT_EQ(estimate.verdict, Verdict::ok);
  EXPECT_LT(errors_of(estimate, truth).rotation_deg, 2);
  EXPECT_LT(errors_of(estimate, truth).direction_deg, 20);
}

TEST(ReferenceNavigator, StationaryCameraHasZeroDisplacement) {
  Navigator navigator = make_reference_navigator();
  for (int i = 0; i < 8; ++i) {
    const NavigationEstimate estimate =
        navigator.step(frame_of(room().image(at(kReference_m, 0), i), i));
    if (i == 0) continue;
    EXPECT_EQ(estimate.verdict, Verdict::ok) << i;
    EXPECT_EQ(estimate.reference->motion.displacement_kind, DisplacementKind::zero) << i;
    EXPECT_LT(errors_of(estimate, at(kReference_m, 0)).rotation_deg, 0.1) << i;
  }
}

TEST(ReferenceNavigator, PureRotationHasZeroDisplacement) {
  Navigator navigator = make_reference_navigator();
  for (int i = 0; i < 6; ++i) {
    const RigidTransform truth = at(kReference_m, 1.5 * i);
    const NavigationEstimate estimate = navigator.step(frame_of(room().image(truth, i), i));
    if (i == 0) continue;
    ASSERT_EQ(estimate.verdict, Verdict::ok) << i;
    EXPECT_LT(errors_of(estimate, truth).rotation_deg, 0.2) << i;
    EXPECT_EQ(estimate.reference->motion.displacement_kind, DisplacementKind::zero) << i;
  }
}

TEST(ReferenceNavigator, RejectsRotationJumpThreeTimes) {
  Navigator navigator = make_reference_navigator();
  (void)navigator.step(frame_of(room().image(at(kReference_m, 0), 0), 0));
  (void)navigator.step(frame_of(room().image(at(kReference_m, 0.2), 1), 1));
  for (int i = 2; i < 8; ++i) {
    const NavigationEstimate estimate =
        navigator.step(frame_of(room().image(at(kReference_m, 9 + 0.3 * i), i), i));
    EXPECT_EQ(estimate.verdict, i < 5 ? Verdict::gated : Verdict::ok) << i;
  }
}

TEST(ReferenceNavigator, KeepsReferenceThroughOcclusion) {
  Navigator navigator = make_reference_navigator();
  (void)navigator.step(frame_of(room().image(at(kReference_m, 0), 0), 0));
  double occluded_variance = 0;
  for (int i = 1; i < 30; ++i) {
    const bool is_occluded = i >= 8 && i < 25;
    const cv::Mat image =
        is_occluded
            ? cv::Mat(240, 400, CV_8UC1, cv::Scalar(i))
            : room().image(at(kReference_m + i * 0.01 * kReference_m.unitOrthogonal(), 0), i);
    const NavigationEstimate estimate = navigator.step(frame_of(image, i));
    ASSERT_TRUE(estimate.pose_covariance.allFinite());
    EXPECT_EQ(estimate.verdict == Verdict::ok, !is_occluded) << i;
    if (is_occluded) {
      EXPECT_EQ(estimate.reference->motion.status, EstimateStatus::lost);
      EXPECT_GT(estimate.pose_covariance(5, 5), occluded_variance);
      occluded_variance = estimate.pose_covariance(5, 5);
    } else {
      EXPECT_TRUE(estimate.reference->on_first_reference);
    }
  }
}

TEST(ReferenceNavigator, ChainsRotationToNewReference) {
  ReferenceConfig config;
  config.renew_every_frames = 3;
  Navigator navigator = make_reference_navigator(Mode::recommended, config);
  for (int i = 0; i <= 12; ++i) {
    const RigidTransform truth = at(kReference_m + Eigen::Vector3d(0, 0.03, 0.01) * i, 1.0 * i);
    const NavigationEstimate estimate = navigator.step(frame_of(room().image(truth, i), i));
    EXPECT_LT(angle_between_rad(estimate.world_from_body.rotation, truth.rotation) / kDegree, 0.3)
        << i;
    EXPECT_EQ(estimate.reference->new_reference, i % 3 == 0) << i;
    EXPECT_EQ(estimate.reference->on_first_reference, i <= 3) << i;
  }
}

// Yaw of 1.5 degrees per frame. Features tracked into the new reference stay the same points: the
// attitude is chained to a tenth of a degree.
TEST(ReferenceNavigator, RenewsReferenceBelowFeatureRatio) {
  ReferenceConfig config;
  config.renew_below_ratio = 0.6;
  Navigator early = make_reference_navigator(Mode::recommended, config);
  Navigator late = make_reference_navigator();
  int max_features = 0;
  int renewed_at = 0;
  for (int i = 0; i <= 20 && renewed_at == 0; ++i) {
    const RigidTransform truth = at(kReference_m, 1.5 * i);
    const Frame frame = frame_of(room().image(truth, i), i);
    const NavigationEstimate estimate = early.step(frame);
    const int features = estimate.reference->features;
    max_features = std::max(max_features, features);
    EXPECT_FALSE(late.step(frame).reference->new_reference && i > 0) << i;
    EXPECT_EQ(estimate.reference->new_reference,
              i == 0 || features < static_cast<int>(0.6 * max_features))
        << i;
    if (i > 0 && estimate.reference->new_reference) renewed_at = i;
  }
  ASSERT_GT(renewed_at, 3);
  for (int i = renewed_at + 1; i <= renewed_at + 3; ++i) {
    const RigidTransform truth = at(kReference_m, 1.5 * i);
    const NavigationEstimate estimate = early.step(frame_of(room().image(truth, i), i));
    EXPECT_FALSE(estimate.reference->on_first_reference);
    EXPECT_EQ(estimate.verdict, Verdict::ok);
    EXPECT_LT(angle_between_rad(estimate.world_from_body.rotation, truth.rotation), 0.1 * kDegree);
  }
}

// Yaw of 60 degrees, out of view of the first image, and back.
TEST(ReferenceNavigator, RelocalizesOnFirstReference) {
  Navigator navigator = make_reference_navigator();
  int relocalized_at = -1;
  for (int i = 0; i <= 60; ++i) {
    const double yaw_deg = 3.0 * std::clamp(30 - std::abs(i - 25), 5, 25) - 15 + 0.3 * (i % 2);
    const RigidTransform truth = at(kReference_m + Eigen::Vector3d(0, 0.002, 0) * i, yaw_deg);
    const NavigationEstimate estimate = navigator.step(frame_of(room().image(truth, i), i));
    const ReferenceReport& reference = *estimate.reference;
    EXPECT_TRUE(i != 25 || !reference.on_first_reference);
    if (reference.relocalized) relocalized_at = i;
    if (i < 50) continue;
    ASSERT_EQ(estimate.verdict, Verdict::ok) << i;
    EXPECT_TRUE(reference.on_first_reference) << i;
    EXPECT_LT(errors_of(estimate, truth).rotation_deg, 0.2) << i;
    EXPECT_LT(estimate.twist_in_camera.angular_rate_rad_s.norm(), 4 * kDegree * 30) << i;
  }
  EXPECT_GT(relocalized_at, 30);
}

TEST(ReferenceNavigator, RejectsDarkImageAsReference) {
  Navigator navigator = make_reference_navigator();
  (void)navigator.step(frame_of(room().image(at(kReference_m, 0), 0), 0));
  for (int i = 1; i < 20; ++i) {
    const cv::Mat dark = develop(cv::Mat(240, 400, CV_32FC1, cv::Scalar(0)), {.noise_grey = 2}, i);
    EXPECT_FALSE(navigator.step(frame_of(dark, i)).reference->new_reference) << i;
  }
}

TEST(ReferenceNavigator, RejectsFrozenImage) {
  Navigator navigator = make_reference_navigator();
  const cv::Mat image = room().image(at(kReference_m, 0), 0);
  (void)navigator.step(frame_of(image, 0));
  const NavigationEstimate estimate = navigator.step(frame_of(image.clone(), 1));
  EXPECT_EQ(estimate.verdict, Verdict::frozen);
  EXPECT_EQ(estimate.reference->motion.status, EstimateStatus::lost);
}

TEST(ReferenceNavigator, WaitsForTexturedImage) {
  Navigator navigator = make_reference_navigator();
  for (int i = 0; i < 3; ++i) {
    const cv::Mat grey(240, 400, CV_8UC1, cv::Scalar(10 * i));
    EXPECT_EQ(navigator.step(frame_of(grey, i)).verdict, Verdict::too_little_texture);
  }
  EXPECT_TRUE(
      navigator.step(frame_of(room().image(at(kReference_m, 0), 3), 3)).reference->new_reference);
  const NavigationEstimate next =
      navigator.step(frame_of(room().image(at(kReference_m, 0.5), 4), 4));
  EXPECT_EQ(next.verdict, Verdict::ok);
  EXPECT_NEAR(next.twist_in_camera.angular_rate_rad_s.norm(), 0.5 * kDegree * 30, 0.02)
      << "rate since the reference, not since the first frame";
  EXPECT_GT(std::sqrt(next.pose_covariance(5, 5)), 1 * kDegree)
      << "rotation before the reference is not measured";
}

}  // namespace
}  // namespace stillkite
