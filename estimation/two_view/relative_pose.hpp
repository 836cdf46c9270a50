#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Correspondence of one feature: undistorted points (x, y) on z = 1 of each camera.
struct BearingPair {
  Eigen::Vector2d reference;
  Eigen::Vector2d current;
};

/// X_current = R X_reference + s t with an unobservable scale s > 0; E = [t]x R (hold paper,
/// eq. 2).
struct RelativePose {
  Eigen::Quaterniond current_from_reference = Eigen::Quaterniond::Identity();
  /// t: unit vector from the current camera to the reference origin; 0 if unobservable.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

/// Model of the correspondences of two views.
enum class ViewModel {
  undecided,      ///< too few pairs or inliers, or an unresolved plane ambiguity
  still,          ///< identity: no motion
  rotation_only,  ///< pure rotation; t is unobservable
  plane,          ///< homography: all features lie on one plane
  general,        ///< essential matrix: scene with depth
};
template <>
struct EnumNames<ViewModel> {
  static constexpr auto value = std::to_array<std::pair<ViewModel, std::string_view>>(
      {{ViewModel::undecided, "undecided"},
       {ViewModel::still, "still"},
       {ViewModel::rotation_only, "rotation_only"},
       {ViewModel::plane, "plane"},
       {ViewModel::general, "general"}});
};

/// Relative pose from bearing pairs, with its covariance.
struct RelativePoseEstimate {
  ViewModel model = ViewModel::undecided;
  RelativePose pose;
  /// Pose of the essential matrix, valid for every model; t = 0 if none was found.
  RelativePose epipolar;
  /// Covariance of (rotation vector, t), both in the current camera: R = exp(e) R_true,
  /// t = t_true + e. Rank 5 (t is a unit vector); the lower block is 0 if t is unobservable. All 0
  /// if no covariance is available.
  Matrix6d covariance = Matrix6d::Zero();
  std::vector<unsigned char> inliers;  ///< one per pair, 1 for an inlier of the model
  int inlier_count = 0;
  double residual = 0;  ///< robust standard deviation of the inliers' Sampson error, on z = 1
};

}  // namespace stillkite
