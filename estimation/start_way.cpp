#include "estimation/start_way.hpp"

#include <Eigen/Cholesky>
#include <optional>

#include "estimation/fusion_filter.hpp"
#include "estimation/resection.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
using OwnMatrix = FusionFilter::OwnMatrix;
using OwnVector = Eigen::Matrix<double, OwnMatrix::RowsAtCompileTime, 1>;

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

StartWay smoothed_way(const FusionConfig& config, const FusionStart& start,
                      std::span<const ToldFrame> frames, const std::vector<Landmark>& landmarks) {
  struct Step {
    RigidTransform world_from_camera;
    OwnVector correction;  // of the prediction
    OwnMatrix gain;        // d(errors) by those of the next frame's prediction
  };
  // 1. Forward.
  FusionConfig without_landmarks = config;
  without_landmarks.relinearize_start = false;
  without_landmarks.landmarks = 0;
  FusionFilter filter(without_landmarks, start);
  std::vector<Step> steps;
  steps.reserve(frames.size());
  for (const ToldFrame& frame : frames) {
    const OwnMatrix before = filter.own_covariance();
    for (const auto& tell : frame.told) tell(filter);
    const OwnMatrix predicted = filter.own_covariance();
    if (!steps.empty()) {
      steps.back().gain = predicted.ldlt().solve(filter.step_transition() * before).transpose();
    }
    const FusionState state = filter.state();
    const auto seen_from = resection(state, landmarks, frame.seen);
    if (seen_from) filter.update_pose(*seen_from);
    steps.push_back({.world_from_camera = filter.state().world_from_camera,
                     .correction = error_between(filter.state(), state),
                     .gain = OwnMatrix::Zero()});
  }
  // 2. And back.
  StartWay way(frames.size());
  OwnVector after = OwnVector::Zero();
  for (std::size_t i = frames.size(); i-- > 0;) {
    const OwnVector error = steps[i].gain * after;
    way[i] = corrected(steps[i].world_from_camera, error);
    after = steps[i].correction + error;
  }
  return way;
}

}  // namespace stillkite
