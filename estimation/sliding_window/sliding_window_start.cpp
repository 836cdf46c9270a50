// Initialization, rest and restart of SlidingWindow.
#include <algorithm>
#include <utility>

#include "estimation/sliding_window/ground_points.hpp"
#include "estimation/sliding_window/marginalization.hpp"
#include "estimation/sliding_window/sliding_window.hpp"
#include "estimation/sliding_window/triangulation.hpp"
#include "estimation/sliding_window/window_tracks.hpp"
#include "geometry/time.hpp"

namespace stillkite {

void SlidingWindow::begin_with(WindowFrame first) {
  window_.frames.clear();
  window_.tracks.clear();
  window_.alignments.clear();
  window_.reference_id = window_.ground_keyframe_id = -1;
  window_.prior.information = Eigen::MatrixXd::Zero(SharedIndex::kSize, SharedIndex::kSize);
  window_.prior.gradient = Eigen::VectorXd::Zero(SharedIndex::kSize);
  append_frame(window_, std::move(first));
}

void SlidingWindow::remove_oldest() {
  forget_start();  // it has moved since
  remove_first_frame(window_);
  restart_tracks(window_);
}

void SlidingWindow::try_initialization() {
  constexpr double kMinInterval_s = 0.4;
  if (try_above_ground()) return;
  const double span_s = seconds_between(window_.frames.front().stamp, window_.frames.back().stamp);
  if (span_s < kMinInterval_s) return;
  Window attempt = window_;
  if (attempt.start) attempt.start->tilt_sigma_rad.reset();
  const RigidTransform before = window_.frames.front().state.world_from_imu;
  initialization_ = initialize_in_motion(attempt, before, priors_);
  contradictions_ += initialization_.is_contradictory;
  if (!initialization_.accepted) return;
  contradictions_ = 0;
  window_ = std::move(attempt);
  is_initialized_ = is_batch_ = true;
  align_first_pose(before.rotation, window_.frames.front().state.world_from_imu.rotation);
  estimate();
}

// With a known height the second frame is enough.
bool SlidingWindow::try_above_ground() {
  if (!window_.start || !window_.start->tilt_sigma_rad) return false;
  Window attempt = window_;
  const Eigen::Quaterniond before = window_.frames.front().state.world_from_imu.rotation;
  initialization_ = initialize_above_ground(attempt, priors_);
  if (!initialization_.accepted) return false;
  window_ = std::move(attempt);
  is_initialized_ = is_batch_ = true;
  align_first_pose(before, window_.frames.front().state.world_from_imu.rotation);
  estimate();
  return true;
}

// Scale and vertical are known well enough for first-estimate Jacobians.
bool SlidingWindow::is_settled() const {
  constexpr double kMaxTilt_rad = kSettledScale_ratio;
  if (!(scale_sigma_ratio(window_) < kSettledScale_ratio)) return false;
  if (window_.start && !(height_sigma_ratio(window_) < kSettledScale_ratio)) return false;
  const Eigen::Matrix3d R = state().world_from_imu.rotation.toRotationMatrix();
  const Eigen::Matrix3d rotation = R * covariance_.topLeftCorner<3, 3>() * R.transpose();
  return rotation.diagonal().head<2>().maxCoeff() < kMaxTilt_rad * kMaxTilt_rad;
}

// All frames since the initialization, linearized anew with every frame, until the estimate is
// settled or the batch is full.
void SlidingWindow::estimate_batch(bool is_full) {
  linearize_at_present(window_);
  set_initial_prior(window_, priors_, rest_);
  estimate();
  is_batch_ = !is_full && !is_settled();
  if (window_.start) {
    const GroundRelief& relief = window_.start->relief;
    if (relief.is_rough() || (!is_batch_ && !relief.is_plane())) {
      forget_ground();
      return;
    }
    level_ground(window_);
  }
  if (is_batch_) return;
  set_initial_prior(window_, priors_, rest_);
  rest_.reset();
  slide();
  limit_keyframes();
}

void SlidingWindow::forget_start() {
  window_.start.reset();
  window_.alignments.clear();
  window_.ground_keyframe_id = -1;
  window_.ground = window_.first_ground = {};
}

// What is seen is no plane: its height gives no scale.
void SlidingWindow::forget_ground() {
  forget_start();
  for (WindowTrack& track : window_.tracks) {
    track.ground_information = 0;
    track.point = triangulate(window_, track);
  }
  set_initial_prior(window_, priors_, rest_);
  is_initialized_ = is_batch_ = scale_sigma_ratio(window_) < kMaxScaleSigma_ratio;
  if (is_initialized_) {
    estimate();
  } else {
    forget_estimate();
  }
}

// For a new initialization. The gyroscope bias, which rotations show, stays.
void SlidingWindow::forget_estimate() {
  window_.extrinsics = window_.first_extrinsics = window_.calibrated;
  for (std::size_t i = 0; i < window_.frames.size(); ++i) {
    WindowFrame& frame = window_.frames[i];
    frame.first_estimate.reset();
    frame.state.velocity_in_world_m_s.setZero();
    frame.state.accel_bias_m_s2.setZero();
    if (i > 0) integrate_imu(window_, i);
  }
}

// One frame, with its features, as long as the camera rests.
void SlidingWindow::stay_at_rest(Timestamp stamp, std::span<const ImuInterval> readings,
                                 std::span<const FeatureObservation> features,
                                 const CameraRest& rest) {
  if (!is_at_rest_) rest_.emplace();
  for (const ImuInterval& reading : readings) rest_->add(reading);
  rest_->velocity_sigma_m_s = rest.velocity_sigma_m_s;
  WindowFrame frame;
  frame.id = next_frame_id_++;
  frame.stamp = stamp;
  frame.imu = ImuPreintegration(noise_);
  // the camera has not rotated since it came to rest
  const auto at_rest =
      std::find_if(window_.frames.begin(), window_.frames.end(),
                   [&](const WindowFrame& earlier) { return earlier.stamp >= rest.since; });
  frame.state = at_rest == window_.frames.end() ? window_.frames.back().state : at_rest->state;
  if (!is_at_rest_ && at_rest != window_.frames.begin()) forget_start();
  if (window_.start) window_.start->tilt_sigma_rad.reset();
  const auto ground_keyframe = window_.find(window_.ground_keyframe_id);
  const bool is_ground_kept =
      ground_keyframe && window_.frames[*ground_keyframe].stamp >= rest.since;
  const Eigen::Quaterniond before = frame.state.world_from_imu.rotation;
  begin_with(std::move(frame));
  initialize_at_rest(window_, *rest_);
  set_initial_prior(window_, priors_, rest_);
  align_first_pose(before, state().world_from_imu.rotation);
  take_keyframe(features);
  if (is_ground_kept) take_ground_keyframe();
  is_initialized_ = is_at_rest_ = is_batch_ = true;
  points_ = {};
  update_covariance();
}

// Attitude of the first frame by the vertical that was found at a later one.
void SlidingWindow::align_first_pose(const Eigen::Quaterniond& before,
                                     const Eigen::Quaterniond& after) {
  if (is_restarted_) return;
  world_from_first_.rotation =
      (after * before.conjugate() * world_from_first_.rotation).normalized();
}

void SlidingWindow::restart() {
  WindowFrame first;
  first.id = window_.frames.back().id;
  first.stamp = window_.frames.back().stamp;
  first.imu = ImuPreintegration(noise_);
  first.state = state();
  first.state.velocity_in_world_m_s.setZero();
  is_restarted_ = true;
  forget_start();
  window_.extrinsics = window_.first_extrinsics = window_.calibrated;
  begin_with(std::move(first));
  is_initialized_ = is_batch_ = is_at_rest_ = false;
  rest_.reset();
  initialization_ = {};
  points_ = {};
}

}  // namespace stillkite
