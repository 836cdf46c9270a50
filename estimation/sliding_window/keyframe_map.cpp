#include "estimation/sliding_window/keyframe_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"

namespace stillkite {
namespace {

// Feature of the map in the present image.
struct MapView {
  const KeyframeMap::Point* known;
  const FeatureObservation* feature;
};

std::vector<MapView> views_of(const KeyframeMap& map,
                              std::span<const FeatureObservation> features) {
  std::vector<MapView> views;
  auto known = map.points.begin();
  for (const FeatureObservation& feature : features) {
    while (known != map.points.end() && known->track_id < feature.track_id) ++known;
    if (known == map.points.end()) break;
    if (known->track_id == feature.track_id) views.push_back({&*known, &feature});
  }
  return views;
}

// Normal equations of the camera's pose, and errors of the views, squared, in variances.
struct PoseEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0;
  std::vector<double> squared;
};

PoseEquations pose_equations(const std::vector<MapView>& views,
                             const RigidTransform& keyframe_from_camera) {
  constexpr double kBehindCamera = 1e4;
  const CameraPair pair = camera_pair({}, keyframe_from_camera, {});
  const Matrix6d by_pose = pair_jacobians(pair).by_target;
  PoseEquations out;
  for (const MapView& view : views) {
    const auto expected = project_point(pair, view.known->point);
    if (!expected) {
      out.squared.push_back(kBehindCamera);
      out.cost += huber_loss(kBehindCamera);
      continue;
    }
    const Eigen::Vector2d by_depth = view.known->inverse_depth_sigma * expected->by_point.col(2);
    const Eigen::Matrix2d covariance = view.feature->covariance + by_depth * by_depth.transpose();
    const Eigen::Matrix2d information = covariance.llt().solve(Eigen::Matrix2d::Identity());
    const Eigen::Vector2d residual = view.feature->bearing - expected->bearing;
    const double squared = residual.dot(information * residual);
    out.squared.push_back(squared);
    out.cost += huber_loss(std::min(squared, kBehindCamera));
    const Eigen::Matrix<double, 2, 6> J = expected->by_pair * by_pose;
    const Eigen::Matrix<double, 6, 2> weighted =
        robust_weight(RobustKernel::huber, squared).weight * J.transpose() * information;
    out.H += weighted * J;
    out.g += weighted * residual;
  }
  return out;
}

RigidTransform moved(const RigidTransform& pose, const Vector6d& step) {
  return {(pose.rotation * so3_exp(step.head<3>())).normalized(),
          pose.translation + step.tail<3>()};
}

PoseEquations fit_pose(const std::vector<MapView>& views, RigidTransform& keyframe_from_camera) {
  constexpr int kMaxIterations = 30;
  constexpr double kMinDecrease = 1e-3;
  double damping = 1e-3;
  PoseEquations now = pose_equations(views, keyframe_from_camera);
  for (int i = 0; i < kMaxIterations; ++i) {
    Matrix6d H = now.H;
    H.diagonal() *= 1 + damping;
    const RigidTransform next_pose = moved(keyframe_from_camera, H.ldlt().solve(now.g));
    PoseEquations next = pose_equations(views, next_pose);
    if (!(next.cost <= now.cost)) {
      damping *= 10;
      continue;
    }
    damping *= 0.1;
    keyframe_from_camera = next_pose;
    const double decrease = now.cost - next.cost;
    now = std::move(next);
    if (decrease < kMinDecrease) break;
  }
  return now;
}

}  // namespace

KeyframeMap keyframe_map(const Window& window, std::int64_t keyframe_id) {
  KeyframeMap map;
  const auto keyframe = window.find(keyframe_id);
  if (!keyframe) return map;
  map.world_from_camera =
      window.frames[*keyframe].world_from_imu_after(window.image_shift_s(), false) *
      window.extrinsics.imu_from_camera;
  CameraPairs pairs(window, false);
  for (const WindowTrack& track : window.tracks) {
    if (!track.point || track.observations.front().frame_id != keyframe_id) continue;
    double information = 0;
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const WindowObservation& observation = track.observations[k];
      information += inverse_depth_information(
          pairs.at(*keyframe, *window.find(observation.frame_id)), *track.point, observation);
    }
    if (information > 0) map.points.push_back({track.id, *track.point, 1 / std::sqrt(information)});
  }
  return map;
}

std::optional<CameraInMap> locate_camera(const KeyframeMap& map,
                                         std::span<const FeatureObservation> features,
                                         const RigidTransform& guess) {
  constexpr std::size_t kMinInliers = 20;
  constexpr double kMinInliers_ratio = 0.5;
  constexpr double kMaxSquaredError = 16;  // four sigma in two dimensions
  const std::vector<MapView> views = views_of(map, features);
  if (views.size() < kMinInliers) return std::nullopt;
  CameraInMap out{.keyframe_from_camera = guess, .covariance = Matrix6d::Zero()};
  const PoseEquations all = fit_pose(views, out.keyframe_from_camera);
  std::vector<MapView> inliers;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (all.squared[i] <= kMaxSquaredError) inliers.push_back(views[i]);
  }
  const auto min_inliers = std::max<std::size_t>(
      kMinInliers, static_cast<std::size_t>(kMinInliers_ratio * static_cast<double>(views.size())));
  if (inliers.size() < min_inliers) return std::nullopt;
  const PoseEquations fit = fit_pose(inliers, out.keyframe_from_camera);
  out.covariance = fit.H.ldlt().solve(Matrix6d::Identity());
  out.inliers = static_cast<int>(inliers.size());
  if (!out.covariance.allFinite()) return std::nullopt;
  return out;
}

}  // namespace stillkite
