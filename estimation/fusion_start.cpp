#include <algorithm>
#include <cmath>
#include <utility>

#include "estimation/dense_update.hpp"
#include "estimation/fusion_filter.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;

double log_determinant(const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

// Views are weighed by how landmarks strayed in the pass before; how they stray now is gathered
// beside it.
double FusionFilter::update_landmarks_about(const StartLandmarks& about,
                                            const RigidTransform* world_from_camera,
                                            std::span<const FeatureView> seen) {
  const RigidTransform predicted = state_.world_from_camera;
  std::vector<RunningRatio> gathered;
  gathered.reserve(landmarks_.size());
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(size());
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    const StartLandmark& linear = about.at(landmark.feature);
    offset[Index::landmark(i) + 2] = linear.inverse_depth - landmark.inverse_depth;
    landmark.inverse_depth = linear.inverse_depth;
    gathered.push_back(std::exchange(landmark.stray, linear.stray));
  }
  if (world_from_camera) {
    state_.world_from_camera = *world_from_camera;
  } else if (const auto seen_from = resection(state_, landmarks_, seen)) {
    state_.world_from_camera = seen_from->world_from_camera;
  }
  offset.segment<3>(Index::kRotation) =
      so3_log(state_.world_from_camera.rotation * predicted.rotation.conjugate());
  offset.segment<3>(Index::kPosition) =
      state_.world_from_camera.translation - predicted.translation;
  age_windows(seen);
  const std::vector<LandmarkView> views = landmark_views(seen);
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
  return correction ? correction->squared + log_determinant(correction->S) : HUGE_VAL;
}

// Landmarks that have been given up meanwhile are left out. The ground is to be told again.
void FusionFilter::adopt(const FusionFilter& again) {
  std::vector<Landmark> at_hand = std::move(landmarks_);
  state_ = again.state_;
  P_ = again.P_;
  start_m_ = again.start_m_;
  is_height_given_ = again.is_height_given_;
  landmarks_ = again.landmarks_;
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    Landmark& landmark = landmarks_[i];
    const auto found = std::find_if(at_hand.begin(), at_hand.end(), [&](const Landmark& l) {
      return l.feature == landmark.feature;
    });
    if (found == at_hand.end()) {
      remove_landmark(i);
      continue;
    }
    landmark.is_guess = found->is_guess;
    landmark.is_of_start = true;
    landmark.is_spare = found->is_spare;
    landmark.refused = found->refused;
    landmark.unseen = found->unseen;
  }
}

}  // namespace stillkite
