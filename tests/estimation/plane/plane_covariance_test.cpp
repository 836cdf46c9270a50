#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/plane/plane_views.hpp"

namespace stillkite {
namespace {

using test::align;
using test::kFirst;
using test::lens;
using test::pose;
using test::render;
using test::rotation_error_rad;
using test::translation_error;

TEST(PlaneCovariance, LikelihoodIsIndependentOfTiltPrior) {
  const Camera camera = lens(DistortionModel::none);
  const RigidTransform moved = pose(0.25, 0.1, 1.0, 0.1, -0.15, 0.2);
  const PlaneMotion truth = motion_between(kFirst, moved);
  const cv::Mat first = render(camera, kFirst), second = render(camera, moved);
  TiltPrior prior;
  prior.axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
  PlaneMotion initial = truth;
  initial.normal = so3_exp(prior.axes * Eigen::Vector2d(0.006, -0.008)) * truth.normal;
  const double initial_error = (initial.normal - truth.normal).norm();
  for (const double sigma_rad : {1e-4, 1e-3, 0.1}) {
    prior.covariance = sigma_rad * sigma_rad * Eigen::Matrix2d::Identity();
    const PlaneAlignment alignment = align(camera, first, second, initial, prior);
    ASSERT_TRUE(alignment.solvable);
    const PlaneLikelihood& likelihood = alignment.plane_likelihood;
    const Eigen::Vector2d tilt =
        likelihood.tilt_information.ldlt().solve(likelihood.tilt_information_rad);
    PlaneMotionStep step;
    step << likelihood.motion_by_tilt * tilt, tilt;
    const PlaneMotion most_likely = apply(alignment.motion, step, prior.axes);
    // the residual of the last step matters for the smallest prior covariance
    EXPECT_LT((most_likely.normal - truth.normal).norm(), 0.4 * initial_error) << sigma_rad;
    EXPECT_LT(rotation_error_rad(most_likely, truth), 0.1 * initial_error) << sigma_rad;
    EXPECT_LT(translation_error(most_likely, truth), 0.15 * initial_error) << sigma_rad;
  }
}

// In a climb, tilt changes the flow in second order only, as lens errors do: no tilt information.
// Translation along the ground keeps the tilt observable.
TEST(PlaneCovariance, LensErrorRemovesTiltInformationInClimb) {
  const Camera camera = lens(DistortionModel::none);
  const double tilt_sigma = 0.02;
  const auto tilt_sigma_after = [&](const RigidTransform& moved, double lens_sigma_px) {
    TiltPrior prior;
    prior.axes = kFirst.rotation.conjugate().toRotationMatrix().leftCols<2>();
    prior.covariance = tilt_sigma * tilt_sigma * Eigen::Matrix2d::Identity();
    const PlaneAlignment alignment =
        align(camera, render(camera, kFirst), render(camera, moved), motion_between(kFirst, moved),
              prior, {}, {.lens_sigma_px = lens_sigma_px});
    EXPECT_LT(translation_error(alignment.motion, motion_between(kFirst, moved)), 2e-3);
    return std::sqrt(alignment.covariance.bottomRightCorner<2, 2>().diagonal().maxCoeff());
  };
  RigidTransform climbed = kFirst, moved_sideways = kFirst;
  climbed.translation.z() *= 1.15;
  moved_sideways.translation.y() += 0.3 * kFirst.translation.z();
  EXPECT_LT(tilt_sigma_after(climbed, 0), 0.7 * tilt_sigma);
  EXPECT_GT(tilt_sigma_after(climbed, 2), 0.98 * tilt_sigma);
  EXPECT_LT(tilt_sigma_after(climbed, 2), 1.01 * tilt_sigma);
  EXPECT_LT(tilt_sigma_after(moved_sideways, 0.3), 0.9 * tilt_sigma);
}

TEST(PlaneCovariance, IndependentErrorsExcludeTheLensWithoutLevelling) {
  const Camera camera = lens(DistortionModel::none);
  RigidTransform moved = kFirst;
  moved.translation.y() += 0.1 * kFirst.translation.z();
  const PoseEstimate keyframe{kFirst, 1e-6 * Matrix6d::Identity()};
  const LevellingConfig levelling{.enabled = false};
  const auto independent = [&](double lens_sigma_px) {
    const PlaneAlignment alignment =
        align(camera, render(camera, kFirst), render(camera, moved), motion_between(kFirst, moved),
              tilt_prior(keyframe, levelling), {}, {.lens_sigma_px = lens_sigma_px});
    return chain(keyframe, alignment, levelling).relative_covariance;
  };
  const Matrix6d exact = independent(0);
  EXPECT_GT(exact.diagonal().minCoeff(), 0);
  EXPECT_TRUE(independent(1).isApprox(exact, 1e-6));
}

// The lens error is the same in both images: only its change over the displacement counts.
TEST(PlaneCovariance, LensErrorGrowsWithDisplacement) {
  const Camera camera = lens(DistortionModel::none);
  const auto rotation_sigma_px = [&](double displacement_px) {
    RigidTransform moved = kFirst;
    moved.translation.y() += displacement_px / camera.focal_x_px * kFirst.translation.z();
    const PlaneAlignment alignment =
        align(camera, render(camera, kFirst), render(camera, moved), motion_between(kFirst, moved),
              {}, {}, {.lens_sigma_px = 0.5});
    // rotation about the optical axis: not confused with the translation
    return camera.focal_x_px * std::sqrt(alignment.smooth_covariance(5, 5));
  };
  const double at_10_px = rotation_sigma_px(10);
  EXPECT_GT(at_10_px, 0);
  EXPECT_NEAR(rotation_sigma_px(20), 2 * at_10_px, 0.2 * at_10_px);
}

}  // namespace
}  // namespace stillkite
