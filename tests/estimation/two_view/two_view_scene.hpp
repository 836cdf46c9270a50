#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"
#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Two views of random points: 800x480 px, focal length 700 px, mean depth 1.
struct TwoViewScene {
  static constexpr double kFocal_px = 700;

  ViewModel content = ViewModel::general;  ///< simulated model
  int points = 1000;
  double baseline = 0.1;  ///< length of the translation
  double relief = 0.12;   ///< full range of the depths
  double noise_px = 0.3;  ///< standard deviation per coordinate, both views
  double patch_px = 0;    ///< standard deviation per coordinate, current view, common to 60x60 px
  double outliers = 0;    ///< share of the pairs
  double rotation_rad = 0.1;
};
inline constexpr double kFocal_px = TwoViewScene::kFocal_px;

struct TwoViews {
  std::vector<BearingPair> pairs;
  std::vector<unsigned char> is_inlier;
  RelativePose truth;
  Eigen::Vector3d normal;   ///< of the plane, from the reference camera towards it
  double deviation_px = 0;  ///< RMS distance of the inliers' depths from the plane, as parallax
  double parallax_px = 0;   ///< RMS displacement of the inliers after the best rotation
};

/// Deterministic in the seed.
[[nodiscard]] inline TwoViews make_two_views(const TwoViewScene& scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const auto direction = [&]() -> Eigen::Vector3d {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  TwoViews views;
  const bool still = scene.content == ViewModel::still;
  const bool moves = !still && scene.content != ViewModel::rotation_only;
  const Eigen::Vector3d axis = direction();
  views.truth.current_from_reference =
      so3_exp(still ? Eigen::Vector3d::Zero() : Eigen::Vector3d(scene.rotation_rad * axis));
  views.truth.direction = moves ? direction() : Eigen::Vector3d::Zero();
  // plane normal up to 35 deg from the optical axis
  const Eigen::Vector3d tilted(0.5 * (2 * unit(random) - 1), 0.5 * (2 * unit(random) - 1), 1);
  views.normal = scene.content == ViewModel::plane ? tilted.normalized() : Eigen::Vector3d::UnitZ();
  const auto pixel = [&]() -> Eigen::Vector2d {
    return Eigen::Vector2d((unit(random) - 0.5) * 800, (unit(random) - 0.5) * 480) /
           TwoViewScene::kFocal_px;
  };
  const auto inside = [](const Eigen::Vector2d& p) {
    return std::abs(p.x()) < 400 / TwoViewScene::kFocal_px &&
           std::abs(p.y()) < 240 / TwoViewScene::kFocal_px;
  };
  const auto noise = [&] {
    const double sigma = scene.noise_px / TwoViewScene::kFocal_px;
    return Eigen::Vector2d(sigma * normal(random), sigma * normal(random));
  };
  std::mt19937 patch_random(seed + 1);
  std::vector<Eigen::Vector2d> patch_errors;
  for (int i = 0; i < 20 * 20; ++i) {
    const double x = normal(patch_random);
    patch_errors.emplace_back(x, normal(patch_random));
  }
  const auto patch = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    const Eigen::Vector2i at = (p * TwoViewScene::kFocal_px / 60).array().floor().cast<int>();
    return scene.patch_px / TwoViewScene::kFocal_px *
           patch_errors[static_cast<std::size_t>(20 * (at.y() + 10) + at.x() + 10)];
  };
  double squared_deviation = 0;
  // least-squares fit of a small rotation to the displacements
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_hand_side = Eigen::Vector3d::Zero();
  double parallax = 0;
  int inliers = 0;
  while (static_cast<int>(views.pairs.size()) < scene.points) {
    const Eigen::Vector2d a = pixel();
    if (unit(random) < scene.outliers) {
      views.pairs.push_back({a, pixel()});
      views.is_inlier.push_back(0);
      continue;
    }
    double depth = 1 + scene.relief * (unit(random) - 0.5);
    if (scene.content == ViewModel::plane) {
      depth = views.normal.z() / views.normal.dot(a.homogeneous());
    }
    const Eigen::Vector3d rotated = views.truth.current_from_reference * a.homogeneous();
    const Eigen::Vector3d moved = depth * rotated + scene.baseline * views.truth.direction;
    if (moved.z() < 0.05 || !inside(moved.hnormalized())) continue;
    const Eigen::Vector2d b = moved.hnormalized();
    views.pairs.push_back({a + noise(), b + patch(b) + noise()});
    views.is_inlier.push_back(1);
    const Eigen::Vector2d p = rotated.hnormalized();
    const Eigen::Vector2d displacement = moved.hnormalized() - p;
    Eigen::Matrix<double, 2, 3> J;
    J << -p.x() * p.y(), 1 + p.x() * p.x(), -p.y(), -1 - p.y() * p.y(), p.x() * p.y(), p.x();
    normal_matrix += J.transpose() * J;
    right_hand_side += J.transpose() * displacement;
    parallax += displacement.squaredNorm();
    squared_deviation += (depth - 1) * (depth - 1) * displacement.squaredNorm();
    ++inliers;
  }
  parallax -= right_hand_side.dot(normal_matrix.ldlt().solve(right_hand_side));
  views.parallax_px =
      TwoViewScene::kFocal_px * std::sqrt(std::max(parallax, 0.0) / std::max(inliers, 1));
  views.deviation_px =
      TwoViewScene::kFocal_px * std::sqrt(squared_deviation / std::max(inliers, 1));
  return views;
}

[[nodiscard]] inline double rotation_error_deg(const RelativePose& found,
                                               const RelativePose& truth) {
  return angle_between_rad(found.current_from_reference, truth.current_from_reference) / kDegree;
}
[[nodiscard]] inline double direction_error_deg(const RelativePose& found,
                                                const RelativePose& truth) {
  return angle_between_rad(found.direction, truth.direction) / kDegree;
}

}  // namespace stillkite
