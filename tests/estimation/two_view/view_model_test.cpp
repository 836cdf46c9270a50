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

TEST(ViewModelTest, names_what_is_seen) {
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

// Exact pairs have no noise by which to judge: what the floor excuses is not taken for motion.
TEST(ViewModelTest, equal_pairs_are_still) {
  const TwoViews views = make_two_views({.content = ViewModel::still, .noise_px = 0}, 1);
  const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {});
  EXPECT_EQ(found.model, ViewModel::still);
  EXPECT_LT(rotation_error_deg(found.pose, {}), 1e-6);
  EXPECT_EQ(found.inlier_count, 1000);
}

TEST(ViewModelTest, a_plain_wrong_prior_changes_nothing) {
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

TEST(Homography, a_homography_has_the_two_views_that_made_it) {
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

TEST(Homography, a_rotation_is_its_own_homography) {
  const Eigen::Quaterniond turn = so3_exp({0.1, -0.2, 0.3});
  for (const PlaneMotion& view : decompose_homography(3 * turn.toRotationMatrix())) {
    EXPECT_LT(angle_between_rad(view.rotation, turn), 1e-7);
    EXPECT_LT(view.translation.norm(), 1e-7);
  }
}

// Forward flight at a leaning plane: both views have all pairs in front.
TEST(PlaneViews, two_views_that_nothing_tells_apart_are_undecided) {
  int undecided = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const TwoViews views = make_two_views({.content = ViewModel::plane, .points = 300}, seed);
    const RelativePoseEstimate alone = estimate_relative_pose(views.pairs, kFocal_px, {});
    if (alone.model == ViewModel::undecided) {
      ++undecided;
      EXPECT_EQ(alone.pose.direction.norm(), 0);
      EXPECT_GT(alone.inlier_count, 200);
    } else {
      EXPECT_LT(rotation_error_deg(alone.pose, views.truth), 0.3) << seed;
    }
    const RelativePoseEstimate by_prior =
        estimate_relative_pose(views.pairs, kFocal_px, {}, {.prior = views.truth});
    if (by_prior.model == ViewModel::plane) {
      EXPECT_LT(rotation_error_deg(by_prior.pose, views.truth), 0.3) << seed;
    }
  }
  EXPECT_GT(undecided, 3);
}

// As the vertical is that an estimator carries on which something else in the image pulls at.
TEST(Homography, a_vertical_that_errs_does_not_outvote_level_ground_and_the_prior) {
  const TwoViewScene scene{.content = ViewModel::plane, .points = 300, .baseline = 0.3};
  int decided = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const TwoViews views = make_two_views(scene, seed);
    const PlaneMotion truth{views.truth.current_from_reference,
                            scene.baseline * views.truth.direction, views.normal};
    for (const PlaneMotion& other : decompose_homography(truth.homography())) {
      const double apart_rad = angle_between_rad(other.rotation, truth.rotation);
      if (apart_rad < 3 * kDegree) continue;  // the true view, or too near for the prior to tell
      RelativePoseHints hints = vertical_of(views);
      hints.up_in_current = other.rotation * *hints.up_in_reference;
      hints.prior = views.truth;
      const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {}, hints);
      if (found.model != ViewModel::plane) continue;
      ++decided;
      EXPECT_LT(rotation_error_deg(found.pose, views.truth), 0.3) << seed;
    }
  }
  EXPECT_GT(decided, 10);
}

// What neighbours share, as what a lens is off by, is taken for depth, and at times suits an
// essential matrix near the plane's other pose better than the true one.
TEST(PlaneViews, level_ground_behind_a_lens_that_is_not_as_told_has_its_true_pose) {
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

// 400 pairs of a camera at the height 1 that looks so far below the horizon: ground, and above it
// what stands 10 to 30 away.
TwoViews make_ground_and_horizon(double pitch_rad, double way, std::uint32_t seed) {
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
    const double below = views.normal.dot(a.homogeneous());
    const double depth = below > 0.05 ? 1 / below : 10 + 20 * unit(random);
    const Eigen::Vector3d now = depth * (views.truth.current_from_reference * a.homogeneous()) +
                                way * views.truth.direction;
    if (now.z() > 0.1) views.pairs.push_back({a + noise(), now.hnormalized() + noise()});
  }
  return views;
}

TEST(PlaneViews, what_stands_behind_level_ground_does_not_make_its_other_pose_the_true_one) {
  for (const double pitch_deg : {10, 15, 20}) {
    for (const double way : {0.05, 0.15}) {
      int undecided = 0;
      for (std::uint32_t seed = 1; seed <= 50; ++seed) {
        const TwoViews views = make_ground_and_horizon(pitch_deg * kDegree, way, seed);
        const RelativePoseEstimate found =
            estimate_relative_pose(views.pairs, kFocal_px, {}, vertical_of(views));
        undecided += found.model == ViewModel::undecided ? 1 : 0;
        if (found.model == ViewModel::undecided) continue;
        EXPECT_LT(direction_error_deg(found.pose, views.truth), 15) << pitch_deg << ' ' << seed;
      }
      EXPECT_LT(undecided, 3) << pitch_deg << ' ' << way;
    }
  }
}

TEST(Homography, a_vertical_tells_the_poses_of_a_wall_apart) {
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
