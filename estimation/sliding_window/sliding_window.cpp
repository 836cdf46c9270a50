#include "estimation/sliding_window/sliding_window.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/sliding_window/frame_selection.hpp"
#include "estimation/sliding_window/marginalization.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"
#include "estimation/sliding_window/triangulation.hpp"
#include "estimation/sliding_window/window_solver.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

// Frames with velocity and biases, and keyframes with a pose only.
constexpr std::size_t kChainFrames = 6;
constexpr std::size_t kKeyframes = 8;
constexpr std::size_t kBatchFrames = 15;
// Minimum interval of two chain frames; the frames between are merged.
constexpr double kMinChainInterval_s = 0.045;
constexpr double kMinInitialization_s = 0.4;
constexpr int kMaxIterations = 4;
constexpr double kMaxSquaredError = 16;  // four sigma in two dimensions

}  // namespace

SlidingWindow::SlidingWindow(const CameraExtrinsics& extrinsics,
                             const RigidTransform& world_from_imu, const ImuNoise& noise,
                             const InertialPriors& priors)
    : noise_(noise), priors_(priors), world_from_first_(world_from_imu) {
  window_.extrinsics = window_.first_extrinsics = extrinsics;
  WindowFrame first;
  first.imu = ImuPreintegration(noise_);
  first.state.world_from_imu = world_from_imu;
  begin_with(std::move(first));
}

void SlidingWindow::begin_with(WindowFrame first) {
  window_.frames.clear();
  window_.tracks.clear();
  window_.prior.information = Eigen::MatrixXd::Zero(ExtrinsicsIndex::kSize, ExtrinsicsIndex::kSize);
  window_.prior.gradient = Eigen::VectorXd::Zero(ExtrinsicsIndex::kSize);
  append_frame(window_, std::move(first));
}

void SlidingWindow::add_frame(Timestamp stamp, std::span<const ImuSample> samples,
                              std::span<const FeatureObservation> features,
                              const std::optional<CameraRest>& rest) {
  if (next_frame_id_ == 0) {
    window_.frames.back().id = next_frame_id_++;
    window_.frames.back().stamp = stamp;
    return;
  }
  const bool has_readings = std::any_of(samples.begin(), samples.end(),
                                        [](const ImuSample& sample) { return !sample.is_gap; });
  if (rest && has_readings && (!is_initialized_ || is_at_rest_)) {
    stay_at_rest(stamp, samples, features, *rest);
    return;
  }
  is_at_rest_ = false;
  rest_ = {};
  // 1. Predict by the IMU, and merge a frame that is too close to its neighbours.
  predict(stamp, samples);
  if (rest) window_.frames.back().rest_sigma_m_s = rest->velocity_sigma_m_s;
  bool is_thinned = true;
  if (is_initialized_ && !is_batch_) {
    thin_chain();
  } else {
    is_thinned = thin_batch();
  }
  // 2. Features of known tracks.
  add_observations(features);
  // 3. Estimate all states.
  if (!is_initialized_) {
    if (!is_thinned) remove_oldest();
    try_initialization();
  } else {
    triangulate_tracks();
    if (is_batch_) {
      estimate_batch(!is_thinned);
    } else {
      estimate();
      slide();
    }
  }
  remove_empty_tracks();
}

void SlidingWindow::take_keyframe(std::span<const FeatureObservation> features) {
  WindowFrame& newest = window_.frames.back();
  newest.is_keyframe = true;
  for (const FeatureObservation& feature : features) {
    if (!window_.tracks.empty() && feature.track_id <= window_.tracks.back().id) continue;
    window_.tracks.push_back({.id = feature.track_id,
                              .observations = {{.frame_id = newest.id,
                                                .bearing = feature.bearing,
                                                .information = feature.covariance.inverse()}},
                              .point = std::nullopt});
  }
  if (is_initialized_ && !is_batch_) limit_keyframes();
  remove_empty_tracks();
}

void SlidingWindow::predict(Timestamp stamp, std::span<const ImuSample> samples) {
  const InertialState last = window_.frames.back().state;
  WindowFrame frame;
  frame.id = next_frame_id_++;
  frame.stamp = stamp;
  frame.imu = ImuPreintegration(noise_);
  frame.imu.reintegrate(last.gyro_bias_rad_s, last.accel_bias_m_s2);
  for (const ImuSample& sample : samples) frame.imu.add(sample);
  if (!samples.empty()) frame.gyro_rad_s = samples.back().angular_rate_rad_s;
  frame.state = frame.imu.predict(last);
  if (!is_initialized_) {
    // velocity and gravity are not known yet
    frame.state.world_from_imu.translation = last.world_from_imu.translation;
    frame.state.velocity_in_world_m_s.setZero();
  }
  append_frame(window_, std::move(frame));
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

void SlidingWindow::remove_oldest() {
  remove_first_frame(window_);
  restart_tracks();
}

// Tracks begin in a keyframe.
void SlidingWindow::restart_tracks() {
  const auto is_keyframe = [&](const WindowObservation& observation) {
    const auto at = window_.find(observation.frame_id);
    return at && window_.frames[*at].is_keyframe;
  };
  for (WindowTrack& track : window_.tracks) {
    const auto first =
        std::find_if(track.observations.begin(), track.observations.end(), is_keyframe);
    if (first != track.observations.begin()) track.point.reset();
    track.observations.erase(track.observations.begin(), first);
  }
}

void SlidingWindow::add_observations(std::span<const FeatureObservation> features) {
  const WindowFrame& newest = window_.frames.back();
  for (const FeatureObservation& feature : features) {
    const auto track =
        std::lower_bound(window_.tracks.begin(), window_.tracks.end(), feature.track_id,
                         [](const WindowTrack& t, std::int64_t id) { return t.id < id; });
    if (track == window_.tracks.end() || track->id != feature.track_id) continue;
    track->observations.push_back({.frame_id = newest.id,
                                   .bearing = feature.bearing,
                                   .information = feature.covariance.inverse()});
  }
}

void SlidingWindow::try_initialization() {
  const double span_s = seconds_between(window_.frames.front().stamp, window_.frames.back().stamp);
  if (span_s < kMinInitialization_s) return;
  Window attempt = window_;
  const RigidTransform before = window_.frames.front().state.world_from_imu;
  initialization_ = initialize_in_motion(attempt, before, priors_);
  if (!initialization_.accepted) return;
  window_ = std::move(attempt);
  is_initialized_ = is_batch_ = true;
  align_first_pose(before.rotation, window_.frames.front().state.world_from_imu.rotation);
  estimate();
}

// All frames since the initialization, linearized anew with every frame, until the scale is known
// well enough for first-estimate Jacobians, or the batch is full.
void SlidingWindow::estimate_batch(bool is_full) {
  constexpr double kSettledScale_ratio = 0.02;
  for (WindowFrame& frame : window_.frames) {
    frame.imu.reintegrate(frame.state.gyro_bias_rad_s, frame.state.accel_bias_m_s2);
  }
  set_initial_prior(window_, priors_);
  estimate();
  is_batch_ = !is_full && scale_sigma_ratio(window_) > kSettledScale_ratio;
  if (is_batch_) return;
  set_initial_prior(window_, priors_);
  slide();
  limit_keyframes();
}

// One frame, with its features, as long as the camera rests.
void SlidingWindow::stay_at_rest(Timestamp stamp, std::span<const ImuSample> samples,
                                 std::span<const FeatureObservation> features,
                                 const CameraRest& rest) {
  for (const ImuSample& sample : samples) rest_.add(sample);
  WindowFrame frame;
  frame.id = next_frame_id_++;
  frame.stamp = stamp;
  frame.imu = ImuPreintegration(noise_);
  // the camera has not rotated since it came to rest
  const auto at_rest =
      std::find_if(window_.frames.begin(), window_.frames.end(),
                   [&](const WindowFrame& earlier) { return earlier.stamp >= rest.since; });
  frame.state = at_rest == window_.frames.end() ? window_.frames.back().state : at_rest->state;
  const Eigen::Quaterniond before = frame.state.world_from_imu.rotation;
  begin_with(std::move(frame));
  initialize_at_rest(window_, rest_, rest.velocity_sigma_m_s, priors_);
  align_first_pose(before, state().world_from_imu.rotation);
  take_keyframe(features);
  is_initialized_ = is_at_rest_ = true;
  measured_points_ = inlier_points_ = 0;
  update_covariance();
}

void SlidingWindow::update_covariance() {
  if (const auto covariance = window_covariance(window_)) {
    covariance_ = covariance->bottomRightCorner<InertialIndex::kSize, InertialIndex::kSize>();
  }
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
  window_.first_extrinsics = window_.extrinsics;
  begin_with(std::move(first));
  is_initialized_ = is_batch_ = is_at_rest_ = false;
  rest_ = {};
  initialization_ = {};
  measured_points_ = inlier_points_ = 0;
}

void SlidingWindow::estimate() {
  constexpr int kMaxBatchIterations = 20;
  const WindowFit fit = optimize(window_, is_batch_ ? kMaxBatchIterations : kMaxIterations);
  if (fit.newest_covariance) {
    covariance_ = *fit.newest_covariance;
  } else {
    update_covariance();
  }
  reject_outliers();
}

void SlidingWindow::triangulate_tracks() {
  for (WindowTrack& track : window_.tracks) {
    if (!track.point) track.point = triangulate(window_, track);
  }
}

// Removes observations that do not fit, and points whose depth became negative.
void SlidingWindow::reject_outliers() {
  const std::int64_t newest = window_.frames.back().id;
  measured_points_ = inlier_points_ = 0;
  ReprojectionErrors errors(window_);
  for (WindowTrack& track : window_.tracks) {
    if (!track.point) continue;
    const auto is_outlier = [&](const WindowObservation& observation) {
      return &observation != track.observations.data() &&
             errors.squared(track, observation) > kMaxSquaredError;
    };
    const bool is_measured = track.in(newest) != nullptr;
    measured_points_ += is_measured;
    std::vector<WindowObservation> kept;
    kept.reserve(track.observations.size());
    for (const WindowObservation& observation : track.observations) {
      if (!is_outlier(observation)) kept.push_back(observation);
    }
    track.observations = std::move(kept);
    inlier_points_ += track.in(newest) != nullptr;
    constexpr double kMinInverseDepth_1_m = 1e-6;
    if (track.point->inverse_depth < kMinInverseDepth_1_m) track.point.reset();
  }
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
    restart_tracks();
  }
}

std::optional<double> SlidingWindow::median_depth_m() const {
  std::vector<double> depths_m;
  for (const WindowTrack& track : window_.tracks) {
    if (track.point) depths_m.push_back(1 / track.point->inverse_depth);
  }
  if (depths_m.empty()) return std::nullopt;
  return upper_median(depths_m);
}

void SlidingWindow::remove_empty_tracks() {
  const std::int64_t newest = window_.frames.back().id;
  std::erase_if(window_.tracks, [&](const WindowTrack& track) {
    if (track.observations.empty()) return true;
    // neither a point nor seen any more
    return !track.point && track.observations.back().frame_id != newest;
  });
}

}  // namespace stillkite
