#include "estimation/sliding_window/sliding_window.hpp"

#include <algorithm>
#include <utility>

#include "estimation/sliding_window/frame_selection.hpp"
#include "estimation/sliding_window/ground_equations.hpp"
#include "estimation/sliding_window/ground_points.hpp"
#include "estimation/sliding_window/marginalization.hpp"
#include "estimation/sliding_window/triangulation.hpp"
#include "estimation/sliding_window/window_solver.hpp"
#include "estimation/sliding_window/window_tracks.hpp"
#include "geometry/chi_square.hpp"

namespace stillkite {
namespace {

// Frames with velocity and biases, and keyframes with a pose only.
constexpr std::size_t kChainFrames = 6;
constexpr std::size_t kKeyframes = 8;
constexpr std::size_t kBatchFrames = 15;
// Minimum interval of two chain frames; the frames between are merged.
constexpr double kMinChainInterval_s = 0.045;
constexpr int kMaxIterations = 4;

}  // namespace

SlidingWindow::SlidingWindow(const CameraExtrinsics& extrinsics,
                             const RigidTransform& world_from_imu, const ImuNoise& noise,
                             const InertialPriors& priors,
                             const std::optional<StartAboveGround>& start)
    : noise_(noise), priors_(priors), world_from_first_(world_from_imu) {
  window_.calibrated = window_.extrinsics = window_.first_extrinsics = extrinsics;
  window_.start = start;
  ImuInterval at_rest;
  at_rest.specific_force_m_s2 = world_from_imu.rotation.conjugate() * -gravity_in_world();
  window_.imu = ImuTimeline(at_rest);
  WindowFrame first;
  first.imu = ImuPreintegration(noise_);
  first.state.world_from_imu = world_from_imu;
  begin_with(std::move(first));
}

void SlidingWindow::add_frame(Timestamp stamp, std::span<const ImuInterval> readings,
                              std::span<const FeatureObservation> features,
                              const std::optional<CameraRest>& rest,
                              const std::optional<KeyframeView>& ground) {
  add_readings(readings);
  if (next_frame_id_ == 0) {
    window_.frames.back().id = next_frame_id_++;
    window_.frames.back().stamp = stamp;
    return;
  }
  if (rest && !readings.empty() && (!is_initialized_ || is_at_rest_)) {
    stay_at_rest(stamp, readings, features, *rest);
    return;
  }
  is_at_rest_ = false;
  // 1. Predict by the IMU, and merge a frame that is too close to its neighbours.
  predict(stamp);
  if (rest) window_.frames.back().rest_sigma_m_s = rest->velocity_sigma_m_s;
  bool is_thinned = true;
  if (is_initialized_ && !is_batch_) {
    thin_chain();
  } else {
    is_thinned = thin_batch();
  }
  // 2. Features of known tracks, and the ground.
  add_observations(window_, features);
  if (ground) align_to_ground(*ground);
  // 3. Estimate all states.
  if (!is_initialized_) {
    if (!is_thinned) remove_oldest();
    try_initialization();
  } else {
    add_points();
    if (is_batch_) {
      estimate_batch(!is_thinned);
    } else {
      estimate();
      slide();
    }
  }
  remove_empty_tracks(window_);
  forget_readings();
}

void SlidingWindow::take_keyframe(std::span<const FeatureObservation> features,
                                  std::span<const FeatureObservation> realigned) {
  window_.frames.back().is_keyframe = true;
  replace_observations(window_, realigned);
  begin_tracks(window_, features);
  if (!window_.find(window_.reference_id)) window_.reference_id = window_.frames.back().id;
  if (is_initialized_ && !is_batch_) {
    limit_keyframes();
    level_ground(window_);
  }
  remove_empty_tracks(window_);
}

bool SlidingWindow::can_align_to_ground() const {
  return is_scale_measured() && window_.start && height_sigma_ratio(window_) < kSettledScale_ratio;
}

void SlidingWindow::take_ground_keyframe() {
  WindowFrame& newest = window_.frames.back();
  newest.is_keyframe = true;
  window_.ground_keyframe_id = newest.id;
  for (GroundAlignment& alignment : window_.alignments) {
    if (alignment.frame_id == newest.id) alignment.is_link = true;
  }
  if (is_initialized_ && !is_batch_) limit_keyframes();
}

// Late readings replace the gap at the end of the newest frames' intervals.
void SlidingWindow::add_readings(std::span<const ImuInterval> readings) {
  const Timestamp known_until = window_.imu.end();
  window_.imu.add(readings);
  for (std::size_t i = window_.frames.size(); --i > 0;) {
    const WindowFrame& frame = window_.frames[i];
    if (window_.imu_time(frame.stamp) <= known_until || frame.imu.samples().empty()) break;
    integrate_imu(window_, i);
  }
}

// As long as intervals may be integrated again.
void SlidingWindow::forget_readings() {
  constexpr double kMargin_s = 0.3;  // a change of the clock offset
  const std::size_t newest = window_.frames.size() - 1;
  const std::size_t first = is_initialized_ && !is_batch_ && newest > 0 ? newest - 1 : 0;
  const Timestamp begin = window_.imu_time(window_.frames[first].stamp);
  window_.imu.forget_before({begin.ns - from_seconds(kMargin_s).ns});
}

void SlidingWindow::predict(Timestamp stamp) {
  const InertialState last = window_.frames.back().state;
  WindowFrame frame;
  frame.id = next_frame_id_++;
  frame.stamp = stamp;
  frame.imu = ImuPreintegration(noise_);
  frame.state = last;
  append_frame(window_, std::move(frame));
  const std::size_t newest = window_.frames.size() - 1;
  integrate_imu(window_, newest);
  InertialState& state = window_.frames[newest].state;
  state = window_.frames[newest].imu.predict(last);
  if (is_initialized_) return;
  // velocity and gravity are not known yet
  state.world_from_imu.translation = last.world_from_imu.translation;
  state.velocity_in_world_m_s.setZero();
}

// The last frame but one is merged if it follows the one before too closely.
void SlidingWindow::thin_chain() {
  if (window_.frames.size() < 3) return;
  const std::size_t at = window_.frames.size() - 2;
  const WindowFrame& frame = window_.frames[at];
  const double interval_s = seconds_between(window_.frames[at - 1].stamp, frame.stamp);
  if (frame.is_keyframe || frame.first_estimate || interval_s >= kMinChainInterval_s) return;
  merge_frame(window_, at);
}

// Keeps the frames spread over time: merges the one with the closest neighbours that is no
// keyframe. False if there are too many keyframes.
bool SlidingWindow::thin_batch() {
  if (window_.frames.size() <= kBatchFrames) return true;
  const std::optional<std::size_t> closest = closest_frame(window_);
  if (!closest) return false;
  merge_frame(window_, *closest);
  return true;
}

void SlidingWindow::add_points() {
  triangulate_tracks(window_);
  place_on_ground(window_);
}

void SlidingWindow::align_to_ground(const KeyframeView& ground) {
  if (!window_.start || !window_.find(window_.ground_keyframe_id)) return;
  const GroundAlignment alignment =
      ground_alignment(ground, window_.ground_keyframe_id, window_.frames.back().id);
  if (alignment.information.allFinite()) window_.alignments.push_back(alignment);
}

// One that the other measurements exclude is of another place of the ground.
void SlidingWindow::reject_alignment() {
  constexpr double kMaxSigmas = 5;
  if (window_.alignments.empty()) return;
  const GroundAlignment& newest = window_.alignments.back();
  if (newest.frame_id != window_.frames.back().id) return;
  if (squared_error(window_, newest) < chi_square_at_sigmas(kMaxSigmas, 6)) return;
  window_.alignments.pop_back();
}

Matrix6d SlidingWindow::mount_covariance() const {
  if (is_initialized_) {
    if (const auto covariance = window_covariance(window_))
      return covariance->topLeftCorner<6, 6>();
  }
  Vector6d sigma;
  sigma.segment<3>(ExtrinsicsIndex::kRotation).setConstant(priors_.camera_rotation_rad);
  sigma.segment<3>(ExtrinsicsIndex::kLeverArm).setConstant(priors_.lever_arm_m);
  return sigma.cwiseAbs2().asDiagonal();
}

void SlidingWindow::update_covariance() {
  if (const auto covariance = window_covariance(window_)) {
    covariance_ = covariance->bottomRightCorner<InertialIndex::kSize, InertialIndex::kSize>();
  }
}

void SlidingWindow::move(const Eigen::Quaterniond& yaw, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& to) {
  move_window(window_, yaw, from, to);
  update_covariance();
}

void SlidingWindow::estimate() {
  constexpr int kMaxBatchIterations = 20;
  const WindowFit fit = optimize(window_, is_batch_ ? kMaxBatchIterations : kMaxIterations);
  move_first_estimates(window_);
  if (fit.newest_covariance) {
    covariance_ = *fit.newest_covariance;
  } else {
    update_covariance();
  }
  points_ = reject_outliers(window_);
  reject_alignment();
  update_ground_points(window_);
}

// Frames that leave the chain: a keyframe's velocity and biases, or the whole frame.
void SlidingWindow::slide() {
  const auto chain_size = [&] {
    return static_cast<std::size_t>(std::count_if(window_.frames.begin(), window_.frames.end(),
                                                  [](const auto& f) { return f.has_motion; }));
  };
  while (chain_size() > kChainFrames) {
    const std::size_t oldest = window_.frames.size() - chain_size();
    if (window_.frames[oldest].is_keyframe) {
      marginalize_motion(window_, oldest);
    } else {
      marginalize_frame(window_, oldest);
    }
  }
}

void SlidingWindow::limit_keyframes() {
  const auto poses = [&] {
    return static_cast<std::size_t>(std::count_if(window_.frames.begin(), window_.frames.end(),
                                                  [](const auto& f) { return !f.has_motion; }));
  };
  while (poses() > kKeyframes) {
    marginalize_frame(window_, redundant_keyframe(window_));
    restart_tracks(window_);
  }
}

}  // namespace stillkite
