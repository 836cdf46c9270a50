#include "estimation/fusion/start_prior.hpp"

#include <Eigen/Cholesky>

#include "estimation/fusion/fusion_filter.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
using OwnMatrix = FusionFilter::OwnMatrix;
using OwnVector = Eigen::Matrix<double, OwnMatrix::RowsAtCompileTime, 1>;

// A frame after all that it was told, and how its errors follow from the next one's.
struct Step {
  RigidTransform world_from_camera;
  OwnMatrix covariance;
  OwnMatrix predicted;   // before what corrected it
  OwnVector correction;  // by that
  OwnMatrix gain = OwnMatrix::Zero();
};

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

std::vector<Step> filtered(FusionFilter filter, std::span<const ToldFrame> frames) {
  std::vector<Step> steps;
  steps.reserve(frames.size());
  for (const ToldFrame& frame : frames) {
    for (const auto& tell : frame.before_views) tell(filter);
    for (const auto& tell : frame.after_views) tell(filter);
    const FusionPrediction& by = filter.prediction();
    if (!steps.empty()) {
      Step& last = steps.back();
      last.gain = by.covariance.ldlt().solve(by.transition * last.covariance).transpose();
    }
    steps.push_back({.world_from_camera = filter.state().world_from_camera,
                     .covariance = filter.own_covariance(),
                     .predicted = by.covariance,
                     .correction = error_between(filter.state(), by.state)});
  }
  return steps;
}

// What a frame's poses and those of later frames share is its gain times what the next frame's do.
StartPrior smoothed(const std::vector<Step>& steps, std::span<const std::size_t> some) {
  std::vector<Eigen::Index> column(steps.size(), -1);
  for (std::size_t i = 0; i < some.size(); ++i) column[some[i]] = pose_at(i);
  StartPrior out;
  out.world_from_camera.resize(steps.size());
  out.covariance.setZero(pose_at(steps.size()), pose_at(some.size()));
  OwnVector error = OwnVector::Zero();
  OwnMatrix covariance = steps.back().covariance;
  Eigen::MatrixXd shared(OwnMatrix::RowsAtCompileTime, pose_at(steps.size()));
  for (std::size_t k = steps.size(); k-- > 0;) {
    const Step& step = steps[k];
    if (k + 1 < steps.size()) {
      const Step& next = steps[k + 1];
      error = step.gain * (next.correction + error);
      covariance =
          step.covariance + step.gain * (covariance - next.predicted) * step.gain.transpose();
      auto later = shared.rightCols(shared.cols() - pose_at(k + 1));
      later = (step.gain * later).eval();
    }
    out.world_from_camera[k] = {
        (so3_exp(error.segment<3>(Index::kRotation)) * step.world_from_camera.rotation)
            .normalized(),
        step.world_from_camera.translation + error.segment<3>(Index::kPosition)};
    shared.middleCols<kPose>(pose_at(k)) = covariance.leftCols<kPose>();
    for (std::size_t j = k; j < steps.size(); ++j) {
      const Matrix6d both = shared.block<kPose, kPose>(0, pose_at(j));
      if (column[j] >= 0) out.covariance.block<kPose, kPose>(pose_at(k), column[j]) = both;
      if (column[k] < 0) continue;
      out.covariance.block<kPose, kPose>(pose_at(j), column[k]) = both.transpose();
    }
  }
  return out;
}

}  // namespace

StartPrior start_prior(const FusionConfig& config, const FusionStart& start,
                       std::span<const ToldFrame> frames, std::size_t anchor,
                       std::span<const std::size_t> chosen) {
  FusionConfig without_landmarks = config;
  without_landmarks.relinearize_start = false;
  without_landmarks.landmarks = 0;
  std::vector<std::size_t> some(chosen.begin(), chosen.end());
  some.push_back(anchor);
  StartPrior prior = smoothed(filtered(FusionFilter(without_landmarks, start), frames), some);
  // Of e_k - A_k e_a and e_j - A_j e_a: the anchor's turn takes along what is away from it.
  const RigidTransform& world_from_anchor = prior.world_from_camera[anchor];
  const auto by_anchor = [&](std::size_t frame) {
    Matrix6d A = Matrix6d::Identity();
    A.bottomLeftCorner<3, 3>() = -skew(Eigen::Vector3d(prior.world_from_camera[frame].translation -
                                                       world_from_anchor.translation));
    return A;
  };
  const Eigen::MatrixXd C = prior.covariance;
  const Matrix6d C_aa = C.block<kPose, kPose>(pose_at(anchor), C.cols() - kPose);
  prior.covariance.conservativeResize(C.rows(), C.cols() - kPose);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Matrix6d C_ka = C.block<kPose, kPose>(pose_at(k), C.cols() - kPose);
    const Matrix6d A_k = by_anchor(k);
    for (std::size_t j = 0; j < chosen.size(); ++j) {
      const Matrix6d C_aj = C.block<kPose, kPose>(pose_at(anchor), pose_at(j));
      const Matrix6d A_j_t = by_anchor(chosen[j]).transpose();
      prior.covariance.block<kPose, kPose>(pose_at(k), pose_at(j)) +=
          A_k * (C_aa * A_j_t - C_aj) - C_ka * A_j_t;
    }
  }
  return prior;
}

}  // namespace stillkite
