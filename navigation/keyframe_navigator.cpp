#include "navigation/keyframe_navigator.hpp"

#include <algorithm>
#include <utility>

#include "navigation/assumptions.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/image_texture.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

// Ratio of camera heights after and before the motion: 1 - n . c, c the camera in the keyframe.
double height_ratio(const PlaneMotion& motion) {
  return 1 + motion.normal.dot(motion.rotation.conjugate() * motion.translation);
}

// Twist covariance of the height error: the filter assumes its height exact, v is proportional to
// it.
Matrix6d scale_error_covariance(const PoseEstimate& camera, const Twist& twist) {
  Vector6d speed = Vector6d::Zero();
  speed.head<3>() = twist.velocity_m_s / camera.world_from_camera.translation.z();
  return speed * camera.covariance(2, 2) * speed.transpose();
}

// Pose covariance of an error of the stamp.
Matrix6d stamp_error_covariance(const PoseEstimate& camera, const Twist& twist_in_camera,
                                double stamp_sigma_s) {
  const Eigen::Quaterniond& rotation = camera.world_from_camera.rotation;
  Vector6d error;
  error << rotation * twist_in_camera.velocity_m_s, rotation * twist_in_camera.angular_rate_rad_s;
  return stamp_sigma_s * stamp_sigma_s * error * error.transpose();
}

bool is_aligned(Verdict verdict) {
  return verdict == Verdict::ok || verdict == Verdict::not_flat;
}

FlowQuality quality_of(const PlaneAlignment& alignment) {
  return {.flow_vectors = alignment.tiles,
          .inlier_ratio = alignment.inlier_ratio,
          .mean_flow_px = alignment.mean_flow_px,
          .residual_px = alignment.residual_px,
          .condition = alignment.condition};
}

}  // namespace

KeyframeNavigator::KeyframeNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                                     const NavigatorConfig& config, const InitialState& initial)
    : camera_(camera),
      body_from_camera_(body_from_camera),
      config_(config),
      aligner_(camera, config.alignment),
      track_(body_from_camera, config, initial) {}

NavigationEstimate KeyframeNavigator::step(const Frame& frame, const FrameInterval& interval,
                                           const SensorReadings& readings, const FlowHints& hints) {
  StopWatch watch;
  view_.reset();
  hints_ = hints;
  set_mask(frame.mask);
  // 1. Build the image pyramid.
  current_.build(frame.grey, config_.alignment.levels);
  if (interval.rejection == Verdict::first_frame) return initialize(frame, readings);
  const double pyramid_ms = watch.lap_ms();
  if (interval.standstill) return stand_still(frame, interval, readings);
  // 2. Predict pose and velocity.
  track_.predict(interval.dt_s, readings);
  // 3. Align the image to the keyframe, from the predicted motion.
  store_tile_positions(interval);
  const PlaneAlignment alignment =
      interval.rejection ? PlaneAlignment{} : align(hints_.allow_search && relief_.is_flat());
  const double flow_ms = watch.lap_ms();
  // 4. Validate the alignment.
  const Verdict verdict = interval.rejection ? *interval.rejection : validate(alignment);
  // 5. Chain it to the keyframe, level both by the plane's normal, and filter; or coast.
  update_track(verdict, alignment, readings, frame, interval);
  // 6. Replace a keyframe that is almost out of view or does not align any more.
  const bool new_keyframe = renew_keyframe(verdict, alignment, interval);
  NavigationEstimate out = answer(frame, verdict);
  out.new_keyframe = new_keyframe;
  // over ground that is not flat too: static overlays are found by it
  if (is_aligned(verdict)) set_image_shift(out);
  out.quality = quality_of(alignment);
  out.stage_ms = {pyramid_ms, flow_ms, 0, watch.lap_ms()};
  return out;
}

// The tiles keep their positions for the next frame.
NavigationEstimate KeyframeNavigator::stand_still(const Frame& frame, const FrameInterval& interval,
                                                  const SensorReadings& readings) {
  track_.stand_still(interval, readings, frame.stamp);
  failures_ = 0;
  has_tiles_ = false;
  NavigationEstimate out = answer(frame, Verdict::still);
  out.image_shift_px = Eigen::Vector2d::Zero();
  return out;
}

NavigationEstimate KeyframeNavigator::initialize(const Frame& frame,
                                                 const SensorReadings& readings) {
  track_.initialize(readings, frame.stamp);
  // nothing aligns to a textureless image: replace it after the next frame
  failures_ = is_textureless(texture_level(current_)) ? config_.keyframes.give_up_after : 0;
  take_keyframe();
  NavigationEstimate out = answer(frame, Verdict::first_frame);
  out.new_keyframe = true;
  return out;
}

// Resets the relief filter when the mask changes.
void KeyframeNavigator::set_mask(const std::shared_ptr<const ImageMask>& mask) {
  if (mask != mask_) relief_ = {};
  mask_ = mask;
  aligner_.set_mask(mask);
}

// An alignment over ground that is not flat may fit a part of the image.
Verdict KeyframeNavigator::validate(const PlaneAlignment& alignment) {
  const Verdict verdict = classify(alignment);
  if (verdict != Verdict::ok && verdict != Verdict::too_few_inliers) return verdict;
  if (alignment.relief) relief_.update(*alignment.relief);
  return relief_.is_flat() ? verdict : Verdict::not_flat;
}

Verdict KeyframeNavigator::classify(const PlaneAlignment& alignment) const {
  const TrustConfig& trust = config_.trust;
  if (!alignment.solvable || alignment.tiles < trust.min_windows) {
    return Verdict::too_little_texture;
  }
  if (alignment.ground_ratio < trust.min_ground_ratio) return Verdict::horizon;
  const bool converged =
      alignment.correlation >= trust.min_correlation &&
      alignment.last_update_px < trust.max_last_update_px && alignment.covariance.allFinite() &&
      alignment.motion_by_twist.allFinite() && height_ratio(alignment.motion) > kMinHeightRatio;
  if (!converged) {
    return is_textureless(texture_level(current_)) ? Verdict::too_little_texture : Verdict::lost;
  }
  if (!(alignment.condition < trust.max_condition)) return Verdict::ill_conditioned;
  // deviations from relief, lens and shutter grow with the flow, those of moving water do not
  const double max_deviation_px =
      trust.max_deviation_px + trust.max_deviation_ratio * alignment.mean_flow_px;
  const bool is_rigid = alignment.correlation >= trust.rigid_correlation ||
                        alignment.deviation_px <= max_deviation_px;
  if (!is_rigid || alignment.inlier_ratio < trust.min_inlier_ratio) return Verdict::too_few_inliers;
  return Verdict::ok;
}

// Tile positions in the previous frame, stored before the next alignment.
void KeyframeNavigator::store_tile_positions(const FrameInterval& interval) {
  has_tiles_ = !interval.rejection;
  if (interval.rejection) return;
  const TileGrid& grid = aligner_.grid();
  if (keyframe_is_previous_) {
    previous_x_px_ = grid.centre_x_px;
    previous_y_px_ = grid.centre_y_px;
  } else {
    previous_x_px_ = aligner_.placement().x_px;
    previous_y_px_ = aligner_.placement().y_px;
  }
  keyframe_is_previous_ = false;
}

// Calls visit(position, flow since the previous frame, weight) for each tile in view.
void KeyframeNavigator::for_each_tile(auto&& visit) const {
  if (!has_tiles_) return;
  const TilePlacement& now = aligner_.placement();
  const std::vector<float>& weights = aligner_.weights();
  for (std::size_t i = 0; i < std::min(weights.size(), previous_x_px_.size()); ++i) {
    const Eigen::Vector2f at(now.x_px[i], now.y_px[i]);
    const Eigen::Vector2f before(previous_x_px_[i], previous_y_px_[i]);
    if (at.minCoeff() < 0 || before.minCoeff() < 0) continue;  // padding, or out of view
    visit(at, Eigen::Vector2f(at - before), weights[i]);
  }
}

std::vector<WeightedFlow> KeyframeNavigator::flow_vectors() const {
  std::vector<WeightedFlow> out;
  for_each_tile([&](const Eigen::Vector2f& at, const Eigen::Vector2f& shift_px, float weight) {
    out.push_back({at, shift_px, weight});
  });
  return out;
}

// Mean flow of the tiles since the last measured frame.
void KeyframeNavigator::set_image_shift(NavigationEstimate& out) const {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  int count = 0;
  for_each_tile([&](const Eigen::Vector2f&, const Eigen::Vector2f& shift, float) {
    shift_px += shift.cast<double>();
    ++count;
  });
  if (count == 0) return;
  out.image_shift_px = shift_px / count;
}

void KeyframeNavigator::update_track(Verdict verdict, const PlaneAlignment& alignment,
                                     const SensorReadings& readings, const Frame& frame,
                                     const FrameInterval& interval) {
  not_flat_motion_.reset();
  if (verdict == Verdict::not_flat) not_flat_motion_ = alignment.motion;
  if (interval.rejection) {
    track_.coast(readings, frame.stamp);
    return;
  }
  if (verdict != Verdict::ok) {
    track_.coast_over_rejection(readings, frame.stamp);
    return;
  }
  view_ = make_view(alignment);
  track_.update(alignment, readings, frame.stamp, frame.stamp_sigma_s);
  // a keyframe taken before the velocity converged needs it for its rolling shutter
  if (is_speed_initializing()) track_.set_keyframe_twist(track_.filter().twist_in_camera());
}

bool KeyframeNavigator::renew_keyframe(Verdict verdict, const PlaneAlignment& alignment,
                                       const FrameInterval& interval) {
  const bool is_due =
      is_aligned(verdict) ? count_success(alignment) : count_failure(verdict, interval);
  if (is_due) take_keyframe();
  return is_due;
}

bool KeyframeNavigator::count_success(const PlaneAlignment& alignment) {
  const KeyframeConfig& keyframes = config_.keyframes;
  failures_ = 0;
  tiles_at_keyframe_ = std::max(tiles_at_keyframe_, alignment.tiles);
  return !keyframes.enabled ||
         alignment.mean_flow_px > keyframes.renew_at_flow_ratio * camera_.width_px ||
         alignment.tiles < keyframes.renew_at_overlap * tiles_at_keyframe_;
}

bool KeyframeNavigator::count_failure(Verdict verdict, const FrameInterval& interval) {
  if (verdict == Verdict::frozen || (verdict == Verdict::time_gap && !interval.is_forward_gap)) {
    return false;
  }
  ++failures_;
  // without velocity, a keyframe that nothing has aligned to is of no use; without flat ground,
  // none
  const bool is_unusable =
      !relief_.is_flat() || (tiles_at_keyframe_ == 0 && is_prediction_uncertain());
  const bool is_exhausted =
      interval.is_forward_gap || is_unusable || failures_ >= config_.keyframes.give_up_after;
  return is_exhausted && !is_textureless(texture_level(current_));
}

void KeyframeNavigator::take_keyframe() {
  track_.take_keyframe();
  not_flat_motion_.reset();
  aligner_.set_reference(current_);
  keyframe_is_previous_ = true;
  tiles_at_keyframe_ = 0;
}

NavigationEstimate KeyframeNavigator::answer(const Frame& frame, Verdict verdict) const {
  const auto [twist_in_camera, covariance] = track_.twist();
  PoseEstimate camera = track_.camera();
  const Matrix6d twist_covariance = covariance + scale_error_covariance(camera, twist_in_camera);
  camera.covariance += stamp_error_covariance(camera, twist_in_camera, frame.stamp_sigma_s);
  return make_estimate(
      frame, body_from_camera_,
      {.verdict = verdict,
       .camera = {.pose = camera, .scale = track_.scale(), .scale_stamp = track_.scale_stamp()},
       .world_from_initial_camera = track_.world_from_initial(),
       .twist_in_camera = twist_in_camera,
       .twist_covariance = twist_covariance,
       .velocity_in_world_m_s = camera.world_from_camera.rotation * twist_in_camera.velocity_m_s});
}

}  // namespace stillkite
