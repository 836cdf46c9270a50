#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "estimation/fusion/dense_update.hpp"
#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {

using Index = FusionIndex;

// Views are weighed by how landmarks strayed when they were searched for; how they stray now is
// gathered beside it.
void FusionFilter::update_landmarks_about(const StartLandmarks& about,
                                          const RigidTransform& world_from_anchor,
                                          const RigidTransform& world_from_camera,
                                          std::span<const FeatureView> seen) {
  std::vector<RunningRatio> gathered;
  gathered.reserve(landmarks_.size());
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(size());
  const auto move = [&](RigidTransform& pose, const RigidTransform& to, int column) {
    offset.segment<3>(column) = so3_log(to.rotation * pose.rotation.conjugate());
    offset.segment<3>(column + 3) = to.translation - pose.translation;
    pose = to;
  };
  move(state_.world_from_camera, world_from_camera, Index::kRotation);
  move(state_.world_from_anchor, world_from_anchor, Index::kAnchorRotation);
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    const StartLandmark& linear = about.at(landmark.feature);
    offset[Index::landmark(i) + 2] = linear.inverse_depth - landmark.inverse_depth;
    landmark.inverse_depth = linear.inverse_depth;
    gathered.push_back(std::exchange(landmark.stray, linear.stray));
  }
  age_windows(seen);
  std::vector<LandmarkView> views = landmark_views(seen);
  std::erase_if(views, [&](const LandmarkView& view) {
    const Landmark& landmark = landmarks_[view.landmark];
    const auto expected = project_landmark(state_.world_from_camera, state_.world_from_anchor,
                                           landmark.bearing, landmark.inverse_depth);
    if (!expected) return true;
    const int column = Index::landmark(view.landmark);
    const Eigen::Matrix2d S = view.covariance + P_.block<2, 2>(column, column);
    const Eigen::Vector2d off = view.bearing - expected->bearing;
    return off.dot(S.llt().solve(off)) > 2 * square(config_.gate_sigma);
  });
  const auto correction = joint_correction(state_, landmarks_, P_, views, offset);
  Eigen::VectorXd error = -offset;
  if (correction) {
    subtract_gram(correction->A_t, P_);
    error += correction->error;
  }
  inject(error);
  const ViewErrors errors = view_errors(state_, landmarks_, views);
  for (std::size_t i = 0; i < gathered.size(); ++i) landmarks_[i].stray = gathered[i];
  for (std::size_t i = 0; i < views.size(); ++i) {
    landmarks_[views[i].landmark].stray.add(errors.squared[i] / errors.usual);
  }
}

// Landmarks that have been given up meanwhile are left out. The ground is to be told again.
void FusionFilter::adopt(const FusionFilter& again) {
  state_ = again.state_;
  P_ = again.P_;
  start_m_ = again.start_m_;
  is_height_given_ = again.is_height_given_;
  landmarks_ = again.landmarks_;
  for (const int feature : again.dropped_) give_up(feature);
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    landmarks_[i].is_of_start = true;
    const int feature = landmarks_[i].feature;
    if (std::find(dropped_.begin(), dropped_.end(), feature) != dropped_.end()) remove_landmark(i);
  }
}

}  // namespace stillkite
