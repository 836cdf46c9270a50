#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// One feature seen twice: points (x, y) of the plane z = 1 of either camera, undistorted.
struct BearingPair {
  Eigen::Vector2d reference;
  Eigen::Vector2d current;
};

/// X_current = R X_reference + s t with an unknown scale s > 0; E = [t]x R in the hold paper's
/// eq. (2).
struct RelativePose {
  Eigen::Quaterniond current_from_reference = Eigen::Quaterniond::Identity();
  /// t, a unit vector, or 0 where nothing is known of it: the reference's origin seen from the
  /// current camera, the way home.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

/// What explains two views.
enum class ViewModel {
  undecided,      ///< too few pairs, no model for enough of them, or a plane of two possible poses
  still,          ///< nothing has moved
  rotation_only,  ///< the camera has turned on the spot; t is unknown
  plane,          ///< a homography: all that is seen lies in one plane
  general,        ///< an essential matrix: the scene has depth
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

/// A pose from pairs of bearings, and what is known of it.
struct RelativePoseEstimate {
  ViewModel model = ViewModel::undecided;
  RelativePose pose;
  /// Of the essential matrix, which every model's pairs obey; its t is 0 where none was found.
  RelativePose epipolar;
  /// Of (rotation vector, t), both in the current camera: R = exp(e) R_true, t = t_true + e. Its
  /// rank is 5 where t is known (t stays a unit vector); with t unknown the lower block is 0. All 0
  /// where it is not known how good the pose is.
  Matrix6d covariance = Matrix6d::Zero();
  std::vector<unsigned char> inliers;  ///< one a pair, 1 where the model explains it
  int inlier_count = 0;
  double residual = 0;  ///< robust standard deviation of the inliers' Sampson error, on z = 1
};

}  // namespace stillkite
