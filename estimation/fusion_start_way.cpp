#include <Eigen/Cholesky>
#include <algorithm>

#include "estimation/fusion_filter.hpp"
#include "estimation/landmark_model.hpp"

// The camera's way in a hover's first pictures, if the landmarks were where they are said to be:
// what the next pass is linearised about (fusion_start.cpp).
namespace stillkite {
namespace {

using Index = FusionIndex;
using OwnVector = Eigen::Matrix<double, Index::kAnchorRotation, 1>;

OwnVector error_between(const FusionState& truth, const FusionState& state) {
  OwnVector error;
  error << so3_log(truth.world_from_camera.rotation * state.world_from_camera.rotation.conjugate()),
      truth.world_from_camera.translation - state.world_from_camera.translation,
      truth.velocity_in_world - state.velocity_in_world,
      truth.gyro_bias_rad_s - state.gyro_bias_rad_s, truth.accel_bias_m_s2 - state.accel_bias_m_s2,
      truth.gravity_tilt_rad - state.gravity_tilt_rad, truth.log_scale - state.log_scale,
      truth.log_height - state.log_height;
  return error;
}

RigidTransform corrected(const RigidTransform& pose, const OwnVector& error) {
  return {(so3_exp(error.segment<3>(Index::kRotation)) * pose.rotation).normalized(),
          pose.translation + error.segment<3>(Index::kPosition)};
}

}  // namespace

// Each frame's resection measures its pose; by all of them and what else was told (Rauch, Tung,
// Striebel 1965). Passes about the resections themselves, noisy as one frame is, are pulled by that
// noise, which is the views' own, and settle slowly or elsewhere.
FusionFilter::StartWay FusionFilter::smoothed_way(const std::vector<Landmark>& landmarks,
                                                  std::size_t frames) const {
  struct Step {
    RigidTransform world_from_camera;
    OwnVector correction;  // of the prediction
    OwnMatrix gain;        // d(errors) by those of the next frame's prediction
  };
  // 1. Forward, a filter without landmarks.
  FusionConfig config = config_;
  config.relinearize_start = false;
  config.landmarks = 0;
  FusionFilter filter(config, start_);
  std::vector<Step> steps;
  steps.reserve(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    filter.since_frame_.setIdentity();
    const OwnMatrix before = filter.P_.topLeftCorner<kOwn, kOwn>();
    for (const auto& tell : told_[i].told) tell(filter);
    const OwnMatrix predicted = filter.P_.topLeftCorner<kOwn, kOwn>();
    if (!steps.empty()) {
      steps.back().gain = predicted.ldlt().solve(filter.since_frame_ * before).transpose();
    }
    const FusionState state = filter.state_;
    const std::optional<Resection> seen_from = filter.resection(told_[i].seen, landmarks);
    if (seen_from) filter.correct_pose(*seen_from);
    steps.push_back({.world_from_camera = filter.state_.world_from_camera,
                     .correction = error_between(filter.state_, state),
                     .gain = OwnMatrix::Zero()});
  }
  // 2. And back.
  StartWay way(frames);
  OwnVector after = OwnVector::Zero();
  for (std::size_t i = frames; i-- > 0;) {
    const OwnVector error = steps[i].gain * after;
    way[i] = corrected(steps[i].world_from_camera, error);
    after = steps[i].correction + error;
  }
  return way;
}

bool FusionFilter::correct_pose(const Resection& seen_from) {
  const RigidTransform& pose = state_.world_from_camera;
  Innovation<6> innovation;
  innovation.residual << so3_log(seen_from.world_from_camera.rotation * pose.rotation.conjugate()),
      seen_from.world_from_camera.translation - pose.translation;
  innovation.H.add(Index::kRotation, Matrix6d::Identity().leftCols<3>());
  innovation.H.add(Index::kPosition, Matrix6d::Identity().rightCols<3>());
  innovation.noise = seen_from.information.inverse();
  return correct(innovation);
}

// Where landmarks put the camera, by least squares from the predicted pose.
std::optional<FusionFilter::Resection> FusionFilter::resection(
    std::span<const FeatureView> seen, const std::vector<Landmark>& landmarks) const {
  constexpr int kSteps = 5;
  constexpr std::size_t kFewest = 6;
  constexpr int kColumn = Index::kLandmarks;
  Eigen::MatrixXd of_pose = Eigen::MatrixXd::Zero(kColumn + 3, 6);
  of_pose.topRows<6>().setIdentity();
  FusionState state = state_;
  Resection out;
  for (int step = 0; step < kSteps; ++step) {
    Matrix6d N = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    std::size_t count = 0;
    for (const FeatureView& view : seen) {
      const auto landmark =
          std::find_if(landmarks.begin(), landmarks.end(),
                       [&](const Landmark& l) { return l.feature == view.feature; });
      if (landmark == landmarks.end()) continue;
      const auto innovation =
          landmark_innovation(state, *landmark, kColumn, view.bearing, view.covariance);
      if (!innovation) continue;
      const Eigen::Matrix<double, 2, 6> H = innovation->H.times(of_pose);
      const Eigen::Matrix<double, 2, 6> weighted = view.covariance.llt().solve(H);
      N += H.transpose() * weighted;
      b += weighted.transpose() * innovation->residual;
      ++count;
    }
    const Vector6d x = N.ldlt().solve(b);
    if (count < kFewest || !x.allFinite()) return std::nullopt;
    RigidTransform& pose = state.world_from_camera;
    pose.rotation = (so3_exp(x.head<3>()) * pose.rotation).normalized();
    pose.translation += x.tail<3>();
    out = {.world_from_camera = pose, .information = N};
  }
  return out;
}

}  // namespace stillkite
