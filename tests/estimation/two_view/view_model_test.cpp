#include "estimation/two_view/view_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "estimation/two_view/relative_pose_estimator.hpp"
#include "tests/estimation/two_view/two_view_scene.hpp"

namespace stillkite {
namespace {

RelativePoseHints vertical_of(const TwoViews& views) {
  return {.up_in_reference = -views.normal,
          .up_in_current = views.truth.current_from_reference * -views.normal};
}

TEST(ViewModelTest, SelectsTheSimulatedModel) {
  for (const ViewModel content :
       {ViewModel::still, ViewModel::rotation_only, ViewModel::plane, ViewModel::general}) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      const TwoViews views =
          make_two_views({.content = content, .points = 300, .outliers = 0.2}, seed);
      const RelativePoseEstimate found =
          estimate_relative_pose(views.pairs, kFocal_px, {}, vertical_of(views));
      EXPECT_EQ(found.model, content) << name_of(content) << ' ' << seed;
      EXPECT_LT(rotation_error_deg(found.pose, views.truth), 0.2)
          << name_of(content) << ' ' << seed;
      const bool moves = content == ViewModel::plane || content == ViewModel::general;
      EXPECT_EQ(found.pose.direction.norm() > 0, moves);
      if (moves) {
        EXPECT_LT(direction_error_deg(found.pose, views.truth), 3) << seed;
      } else {
        EXPECT_EQ((found.covariance.bottomRightCorner<3, 3>().norm()), 0);
      }
    }
  }
}

// Exact pairs: the noise estimate is 0, only the systematic-error floor remains.
TEST(ViewModelTest, EqualPairsAreStill) {
  const TwoViews views = make_two_views({.content = ViewModel::still, .noise_px = 0}, 1);
  const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {});
  EXPECT_EQ(found.model, ViewModel::still);
  EXPECT_LT(rotation_error_deg(found.pose, {}), 1e-6);
  EXPECT_EQ(found.inlier_count, 1000);
}

TEST(ViewModelTest, IsRobustToWrongPrior) {
  for (const ViewModel content : {ViewModel::rotation_only, ViewModel::plane, ViewModel::general}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      const TwoViews views = make_two_views({.content = content, .outliers = 0.3}, seed);
      RelativePoseHints hints = vertical_of(views);
      hints.prior = RelativePose{so3_exp({0.3, 0.2, -0.4}), Eigen::Vector3d(1, 2, 3)};
      const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {}, hints);
      EXPECT_EQ(found.model, content) << seed;
      EXPECT_LT(rotation_error_deg(found.pose, views.truth), 0.2) << seed;
    }
  }
}

TEST(Homography, DecompositionContainsTheTrueMotion) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const TwoViews views = make_two_views({.content = ViewModel::plane, .points = 1}, seed);
    const PlaneMotion truth{views.truth.current_from_reference, 0.3 * views.truth.direction,
                            views.normal};
    double nearest = 1;
    for (const PlaneMotion& view : decompose_homography(-2.5 * truth.homography())) {
      EXPECT_LT((view.homography() - truth.homography()).norm(), 1e-12) << seed;
      EXPECT_NEAR(view.normal.norm(), 1, 1e-12);
      nearest = std::min(nearest, (view.translation - truth.translation).norm());
    }
    EXPECT_LT(nearest, 1e-7) << seed;
  }
}

TEST(Homography, DecomposesPureRotation) {
  const Eigen::Quaterniond rotation = so3_exp({0.1, -0.2, 0.3});
  for (const PlaneMotion& view : decompose_homography(3 * rotation.toRotationMatrix())) {
    EXPECT_LT(angle_between_rad(view.rotation, rotation), 1e-7);
    EXPECT_LT(view.translation.norm(), 1e-7);
  }
}

// Forward flight towards a tilted plane: both motions have all pairs in front.
TEST(PlaneViews, AmbiguousMotionsAreUndecided) {
  int undecided = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const TwoViews views = make_two_views({.content = ViewModel::plane, .points = 300}, seed);
    const RelativePoseEstimate without_prior = estimate_relative_pose(views.pairs, kFocal_px, {});
    if (without_prior.model == ViewModel::undecided) {
      ++undecided;
      EXPECT_EQ(without_prior.pose.direction.norm(), 0);
      EXPECT_GT(without_prior.inlier_count, 200);
    } else {
      EXPECT_LT(rotation_error_deg(without_prior.pose, views.truth), 0.3) << seed;
    }
    const RelativePoseEstimate with_prior =
        estimate_relative_pose(views.pairs, kFocal_px, {}, {.prior = views.truth});
    if (with_prior.model == ViewModel::plane) {
      EXPECT_LT(rotation_error_deg(with_prior.pose, views.truth), 0.3) << seed;
    }
  }
  EXPECT_GT(undecided, 3);
}

// Wrong vertical, as after propagation by an estimator biased by moving objects.
TEST(Homography, LevelPlaneAndPriorOverrideWrongVertical) {
  const TwoViewScene scene{.content = ViewModel::plane, .points = 300, .baseline = 0.3};
  int decided = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const TwoViews views = make_two_views(scene, seed);
    const PlaneMotion truth{views.truth.current_from_reference,
                            scene.baseline * views.truth.direction, views.normal};
    for (const PlaneMotion& hypothesis : decompose_homography(truth.homography())) {
      const double separation_rad = angle_between_rad(hypothesis.rotation, truth.rotation);
      // true motion, or too close to resolve by the prior
      if (separation_rad < 3 * kDegree) continue;
      RelativePoseHints hints = vertical_of(views);
      hints.up_in_current = hypothesis.rotation * *hints.up_in_reference;
      hints.prior = views.truth;
      const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {}, hints);
      if (found.model != ViewModel::plane) continue;
      ++decided;
      EXPECT_LT(rotation_error_deg(found.pose, views.truth), 0.3) << seed;
    }
  }
  EXPECT_GT(decided, 10);
}

// Spatially correlated errors, as of a lens distortion model, mimic depth; an essential matrix near
// the plane's other pose can have the lower cost.
TEST(PlaneViews, LevelGroundResolvesPoseDespiteLensDistortionError) {
  const TwoViewScene scene{
      .content = ViewModel::plane, .points = 300, .noise_px = 0.05, .patch_px = 0.6};
  int general = 0;
  int undecided = 0;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    const TwoViews views = make_two_views(scene, seed);
    const RelativePoseEstimate found =
        estimate_relative_pose(views.pairs, kFocal_px, {}, {.up_in_reference = views.normal});
    general += found.model == ViewModel::general ? 1 : 0;
    undecided += found.model == ViewModel::undecided ? 1 : 0;
    if (found.model == ViewModel::undecided) continue;
    EXPECT_LT(direction_error_deg(found.pose, views.truth), 15) << seed;
  }
  EXPECT_GT(general, 10);
  EXPECT_LT(undecided, 5);
}

// 70 pairs on an object in a corner of the image that moves by 8 to 20 px across the epipolar lines
// of the plane, and by half of that along them.
void add_moving_object(TwoViews& views, double baseline, std::uint32_t seed) {
  const RigidTransform motion{views.truth.current_from_reference, baseline * views.truth.direction};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 70; ++i) {
    const double x_px = 220 + 180 * unit(random);
    const double y_px = -240 + 120 * unit(random);
    const Eigen::Vector2d a = Eigen::Vector2d(x_px, y_px) / kFocal_px;
    const double depth = views.normal.z() / views.normal.dot(a.homogeneous());
    const Eigen::Vector3d on_plane = motion * Eigen::Vector3d(depth * a.homogeneous());
    const Eigen::Vector2d b = on_plane.hnormalized();
    const Eigen::Vector3d& t = views.truth.direction;
    const Eigen::Vector2d along = (t.head<2>() - t.z() * b).normalized();
    const Eigen::Vector2d across(-along.y(), along.x());
    const double shift_px = 8 + 0.04 * (x_px - 220) + 0.04 * (y_px + 240);
    views.pairs.push_back({a, b + shift_px / kFocal_px * (across + 0.5 * along)});
  }
}

TEST(PlaneViews, MovingObjectDoesNotDisplaceThePose) {
  const TwoViewScene scene{
      .content = ViewModel::plane, .points = 200, .noise_px = 0.05, .patch_px = 0.2};
  int undecided = 0;
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    TwoViews views = make_two_views(scene, seed);
    add_moving_object(views, scene.baseline, seed);
    const RelativePoseEstimate found =
        estimate_relative_pose(views.pairs, kFocal_px, {}, {.up_in_reference = views.normal});
    undecided += found.model == ViewModel::undecided ? 1 : 0;
    if (found.model == ViewModel::undecided) continue;
    EXPECT_LT(direction_error_deg(found.pose, views.truth), 15) << seed;
    EXPECT_LT(rotation_error_deg(found.pose, views.truth), 1) << seed;
  }
  EXPECT_LT(undecided, 3);
}

// 400 pairs of a camera at height 1, pitched down by `pitch_rad`: ground, and points above the
// horizon at depths 10 to 30.
TwoViews make_ground_and_horizon(double pitch_rad, double baseline, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    const double x = normal(random), y = normal(random);
    return Eigen::Vector3d(x, y, normal(random));
  };
  const auto noise = [&] {
    const double x = normal(random);
    return Eigen::Vector2d(0.15 / kFocal_px * Eigen::Vector2d(x, normal(random)));
  };
  TwoViews views;
  views.normal = {0, std::cos(pitch_rad), std::sin(pitch_rad)};
  views.truth = {so3_exp(0.03 * draw()), draw().normalized()};
  while (views.pairs.size() < 400) {
    const double x = unit(random);
    const Eigen::Vector2d a((x - 0.5) * 800 / kFocal_px, (unit(random) - 0.5) * 480 / kFocal_px);
    const double inverse_depth = views.normal.dot(a.homogeneous());
    const double depth = inverse_depth > 0.05 ? 1 / inverse_depth : 10 + 20 * unit(random);
    const Eigen::Vector3d moved = depth * (views.truth.current_from_reference * a.homogeneous()) +
                                  baseline * views.truth.direction;
    if (moved.z() > 0.1) views.pairs.push_back({a + noise(), moved.hnormalized() + noise()});
  }
  return views;
}

TEST(PlaneViews, PointsBehindGroundDoNotSelectTheWrongPose) {
  for (const double pitch_deg : {10, 15, 20}) {
    for (const double baseline : {0.05, 0.15}) {
      int undecided = 0;
      for (std::uint32_t seed = 1; seed <= 50; ++seed) {
        const TwoViews views = make_ground_and_horizon(pitch_deg * kDegree, baseline, seed);
        const RelativePoseEstimate found =
            estimate_relative_pose(views.pairs, kFocal_px, {}, vertical_of(views));
        undecided += found.model == ViewModel::undecided ? 1 : 0;
        if (found.model == ViewModel::undecided) continue;
        EXPECT_LT(direction_error_deg(found.pose, views.truth), 15) << pitch_deg << ' ' << seed;
      }
      EXPECT_LT(undecided, 3) << pitch_deg << ' ' << baseline;
    }
  }
}

TEST(Homography, VerticalResolvesTheMotionsOfAWall) {
  int decided = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const TwoViews views = make_two_views({.content = ViewModel::plane, .points = 300}, seed);
    RelativePoseHints hints;
    hints.up_in_reference = views.normal.unitOrthogonal();
    hints.up_in_current = views.truth.current_from_reference * *hints.up_in_reference;
    const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {}, hints);
    if (found.model != ViewModel::plane) continue;
    ++decided;
    EXPECT_LT(rotation_error_deg(found.pose, views.truth), 0.3) << seed;
  }
  EXPECT_GT(decided, 15);
}

}  // namespace
}  // namespace stillkite
