#include "navigation/keyframe_navigator.hpp"

#include <algorithm>
#include <utility>

#include "navigation/assumptions.hpp"
#include "navigation/image_texture.hpp"
#include "navigation/motion_guess.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

constexpr int kFramesToLearnSpeed = 3;

// The level of a pyramid on which an image's texture is looked for.
constexpr int kTextureLevel = 2;

const cv::Mat& coarse(const Pyramid& pyramid) {
  return pyramid.level(std::min(kTextureLevel, pyramid.levels() - 1));
}

Vector6d in_heights(const Twist& twist, double height_m) {
  Vector6d v = twist.vector();
  v.head<3>() /= height_m;
  return v;
}

// By where they have what the optical axis met.
bool are_far_apart(const Camera& camera, const PlaneMotion& a, const PlaneMotion& b) {
  constexpr double kFar_px = 8;
  const auto seen_at = [](const PlaneMotion& motion) -> Eigen::Vector2d {
    return motion.homography().col(2).hnormalized();
  };
  return camera.focal_x_px * (seen_at(a) - seen_at(b)).norm() > kFar_px;
}

// Height of the camera after the motion over that before: 1 - n . c, c its place in the keyframe.
double height_ratio(const PlaneMotion& motion) {
  return 1 + motion.normal.dot(motion.rotation.conjugate() * motion.translation);
}

// The filter takes its height as given; a wrong one makes every speed wrong by the same share.
Matrix6d covariance_of_scale(const PoseEstimate& camera, const Twist& twist) {
  Vector6d speed = Vector6d::Zero();
  speed.head<3>() = twist.velocity_m_s / camera.world_from_camera.translation.z();
  return speed * camera.covariance(2, 2) * speed.transpose();
}

FlowQuality quality_of(const PlaneAlignment& alignment) {
  return {.windows = alignment.windows,
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
  aligner_.set_mask(frame.mask);
  // 1. Halve the image a few times.
  current_.build(frame.grey, config_.alignment.levels);
  if (interval.spoiled == Verdict::first_frame) return start(frame, readings);
  const double pyramid_ms = watch.lap_ms();
  // 2. Predict where the camera is by now.
  track_.predict(interval.dt_s, readings);
  // 3. From there find the motion since the keyframe that explains this image.
  remember_windows(interval);
  const PlaneAlignment alignment = interval.spoiled ? PlaneAlignment{} : align(hints.may_search);
  const double flow_ms = watch.lap_ms();
  // 4. Is it to be trusted?
  const Verdict verdict = interval.spoiled ? *interval.spoiled : judge(alignment);
  // 5. Chain it to the keyframe, level both by the plane's normal and filter; or stay as predicted.
  if (verdict == Verdict::ok) {
    view_ = view_of(alignment, hints.normal);
    track_.accept(alignment, readings, frame.stamp);
    // a keyframe taken before the speed was known had it all the same; its rows need it
    if (learns_speed()) {
      track_.assume_keyframe_twist(track_.filter().twist_in_camera());
    }
  } else {
    track_.coast(readings, frame.stamp);
  }
  // 6. A new keyframe where the old one is nearly out of sight, or does not align any more.
  const bool new_keyframe =
      verdict == Verdict::ok ? count_success(alignment) : count_failure(verdict, interval);
  if (new_keyframe) take_keyframe();
  NavigationEstimate out = answer(frame, verdict);
  out.new_keyframe = new_keyframe;
  if (verdict == Verdict::ok) tell_shift(interval.dt_s, out);
  out.quality = quality_of(alignment);
  out.stage_ms = {pyramid_ms, flow_ms, 0, watch.lap_ms()};
  return out;
}

NavigationEstimate KeyframeNavigator::start(const Frame& frame, const SensorReadings& readings) {
  track_.start(readings, frame.stamp);
  // nothing aligns to a bare image: let the next one do
  failures_ = is_bare(coarse(current_)) ? config_.keyframes.give_up_after : 0;
  take_keyframe();
  NavigationEstimate out = answer(frame, Verdict::first_frame);
  out.new_keyframe = true;
  return out;
}

PlaneAlignment KeyframeNavigator::align(bool may_search) {
  const PlaneMotion predicted = predicted_motion();
  const bool is_vague = is_prediction_vague();
  if (is_vague) aligned_ = 0;
  ++aligned_;
  PlaneAlignment best = align_from(predicted);
  if (!may_search || (!is_vague && judge(best) != Verdict::lost)) return best;
  PlaneMotion from = predicted;
  const bool is_near = fits(best);
  for (const PlaneMotion& guess : searched_motions()) {
    const PlaneAlignment other = align_from(guess);
    // pavement and crops look alike one slab or row further on: the nearest it is, or nobody knows
    if (fits(best) && fits(other) && are_far_apart(camera_, best.motion, other.motion)) {
      if (is_near) continue;
      return align_from(predicted);
    }
    if (!is_better(other, best)) continue;
    best = other;
    from = other.motion;
  }
  // from as far away as a guess the steps do not end where they should; and the windows shown are
  // those of the last alignment
  return align_from(from);
}

bool KeyframeNavigator::learns_speed() const {
  return aligned_ <= kFramesToLearnSpeed;
}

PlaneMotion KeyframeNavigator::predicted_motion() const {
  return motion_between(track_.keyframe().world_from_camera, track_.filter().pose());
}

// An alignment reaches about a pixel of the coarsest level.
bool KeyframeNavigator::is_prediction_vague() const {
  const double reach_px = std::exp2(current_.levels() - 1);
  return prediction_sigma_px(camera_, track_.filter()) > reach_px;
}

std::vector<PlaneMotion> KeyframeNavigator::searched_motions() const {
  std::vector<PlaneMotion> out;
  if (is_bare(coarse(current_))) return out;
  const int level = current_.levels() - 1;
  Camera camera = camera_;
  for (int l = 0; l < level; ++l) camera = half_resolution(camera);
  const Eigen::Vector3d normal = predicted_motion().normal;
  const LevelView view = level_view(camera, normal);
  for (const ImageShift& shift :
       find_shifts(aligner_.reference().level(level), current_.level(level), view.homography)) {
    const auto motions = motions_of(shift, camera, view, normal);
    out.insert(out.end(), motions.begin(), motions.end());
  }
  return out;
}

// Of images of other places no two are as alike.
bool KeyframeNavigator::fits(const PlaneAlignment& alignment) const {
  constexpr double kAlike = 0.9;
  return judge(alignment) == Verdict::ok && alignment.correlation >= kAlike;
}

bool KeyframeNavigator::is_better(const PlaneAlignment& a, const PlaneAlignment& b) const {
  if (judge(a) != Verdict::ok || a.correlation < config_.trust.min_found_correlation) return false;
  return judge(b) != Verdict::ok || a.correlation > b.correlation;
}

PlaneAlignment KeyframeNavigator::align_from(const PlaneMotion& guess) {
  PlaneAlignment alignment = align_at_speed(guess, track_.filter());
  if (config_.readout_s > 0 && learns_speed() && alignment.solvable) {
    // the rows' times matter once the speed is known: align again with the speed just seen
    alignment = align_at_speed(guess, track_.filter_after(alignment));
  }
  return alignment;
}

PlaneAlignment KeyframeNavigator::align_at_speed(const PlaneMotion& guess,
                                                 const MotionFilter& speed) {
  const PoseEstimate& keyframe = track_.keyframe();
  const double height_m = keyframe.world_from_camera.translation.z();
  const Twist now = speed.twist_in_camera();
  const Twist& then = learns_speed() ? now : track_.keyframe_twist();
  const RollingShutter shutter{config_.readout_s, in_heights(then, height_m),
                               in_heights(now, height_m)};
  PlaneAlignment alignment =
      aligner_.align(current_, guess, tilt_prior(keyframe, config_.levelling), shutter);
  // on a speed that both images share the motion hardly depends
  if (learns_speed()) alignment.motion_by_twist.setZero();
  return alignment;
}

// Motion and normal are multiplied: what a motion for another normal is, the windows tell to first
// order. Where that does not do they are aligned again, the normal held.
KeyframeView KeyframeNavigator::view_of(const PlaneAlignment& alignment,
                                        const std::optional<Eigen::Vector3d>& normal) {
  constexpr double kSecondOrder_rad = 1e-5;
  TiltPrior tilt = tilt_prior(track_.keyframe(), config_.levelling);
  const KeyframeView view{alignment.motion, tilt.axes, alignment.windows_alone};
  if (!normal || !tilt.covariance) return view;
  const Eigen::Vector2d turn = tilt.axes.transpose() * alignment.motion.normal.cross(*normal);
  if (alignment.motion.translation.norm() * turn.squaredNorm() < kSecondOrder_rad) return view;
  PlaneMotionStep to_normal;
  to_normal << alignment.windows_alone.motion_by_tilt * turn, turn;
  PlaneMotion guess = apply(alignment.motion, to_normal, tilt.axes);
  guess.normal = *normal;
  tilt.covariance = 1e-12 * Eigen::Matrix2d::Identity();
  const PlaneAlignment again = aligner_.align(current_, guess, tilt, alignment.shutter);
  if (judge(again) != Verdict::ok) return view;  // the normal may be far off
  return {again.motion, tilt.axes, again.windows_alone};
}

Verdict KeyframeNavigator::judge(const PlaneAlignment& alignment) const {
  const TrustConfig& trust = config_.trust;
  if (!alignment.solvable || alignment.windows < trust.min_windows) {
    return Verdict::too_little_texture;
  }
  if (alignment.ground_ratio < trust.min_ground_ratio) return Verdict::horizon;
  const bool follows = alignment.correlation >= trust.min_correlation &&
                       alignment.last_update_px < trust.max_last_update_px &&
                       alignment.covariance.allFinite() && alignment.motion_by_twist.allFinite() &&
                       height_ratio(alignment.motion) > kLowest;
  if (!follows) {
    return is_bare(coarse(current_)) ? Verdict::too_little_texture : Verdict::lost;
  }
  if (!(alignment.condition < trust.max_condition)) return Verdict::ill_conditioned;
  // relief, lens and shutter part the windows as the image moves; water does where it is
  const double may_deviate_px =
      trust.max_deviation_px + trust.max_deviation_ratio * alignment.mean_flow_px;
  const bool is_rigid =
      alignment.correlation >= trust.rigid_correlation || alignment.deviation_px <= may_deviate_px;
  if (!is_rigid || alignment.inlier_ratio < trust.min_inlier_ratio) return Verdict::too_few_inliers;
  return Verdict::ok;
}

// Before the next alignment: where the keyframe's windows are in the frame before.
void KeyframeNavigator::remember_windows(const FrameInterval& interval) {
  has_windows_ = !interval.spoiled;
  if (interval.spoiled) return;
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

// Those in view: where, by how much since the frame before, its weight.
void KeyframeNavigator::for_each_window(auto&& visit) const {
  if (!has_windows_) return;
  const TilePlacement& now = aligner_.placement();
  const std::vector<float>& weights = aligner_.weights();
  for (std::size_t i = 0; i < std::min(weights.size(), previous_x_px_.size()); ++i) {
    const Eigen::Vector2f at(now.x_px[i], now.y_px[i]);
    const Eigen::Vector2f before(previous_x_px_[i], previous_y_px_[i]);
    if (at.minCoeff() < 0 || before.minCoeff() < 0) continue;  // padding, or out of sight
    visit(at, Eigen::Vector2f(at - before), weights[i]);
  }
}

std::vector<WindowFlow> KeyframeNavigator::windows() const {
  std::vector<WindowFlow> out;
  for_each_window([&](const Eigen::Vector2f& at, const Eigen::Vector2f& shift_px, float weight) {
    out.push_back({at, shift_px, weight});
  });
  return out;
}

// Since the frame before that showed something.
void KeyframeNavigator::tell_shift(double dt_s, NavigationEstimate& out) const {
  double way_px = 0;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  int count = 0;
  for_each_window([&](const Eigen::Vector2f&, const Eigen::Vector2f& shift, float) {
    way_px += static_cast<double>(shift.norm());
    shift_px += shift.cast<double>();
    ++count;
  });
  if (count == 0) return;
  out.image_speed_px_s = way_px / count / dt_s;
  out.image_shift_px = shift_px / count;
}

bool KeyframeNavigator::count_success(const PlaneAlignment& alignment) {
  const KeyframeConfig& keyframes = config_.keyframes;
  failures_ = 0;
  windows_at_keyframe_ = std::max(windows_at_keyframe_, alignment.windows);
  return !keyframes.enabled ||
         alignment.mean_flow_px > keyframes.renew_at_flow_ratio * camera_.width_px ||
         alignment.windows < keyframes.renew_at_overlap * windows_at_keyframe_;
}

bool KeyframeNavigator::count_failure(Verdict verdict, const FrameInterval& interval) {
  if (verdict == Verdict::frozen || (verdict == Verdict::time_gap && !interval.is_late)) {
    return false;
  }
  ++failures_;
  // a keyframe to which nothing has aligned yet is no loss while nothing is known of the speed
  const bool is_worthless = windows_at_keyframe_ == 0 && is_prediction_vague();
  const bool patience_ends =
      interval.is_late || is_worthless || failures_ >= config_.keyframes.give_up_after;
  return patience_ends && !is_bare(coarse(current_));
}

void KeyframeNavigator::take_keyframe() {
  track_.take_keyframe();
  aligner_.set_reference(current_);
  keyframe_is_previous_ = true;
  windows_at_keyframe_ = 0;
}

NavigationEstimate KeyframeNavigator::answer(const Frame& frame, Verdict verdict) const {
  const PoseEstimate& camera = track_.camera();
  NavigationEstimate out;
  out.stamp = frame.stamp;
  out.frame_index = frame.index;
  out.verdict = verdict;
  out.world_from_body = camera.world_from_camera * body_from_camera_.inverse();
  out.world_from_start = track_.world_from_start() * body_from_camera_.inverse();
  out.pose_covariance = camera.covariance;
  out.twist_in_camera = track_.filter().mean_twist_in_camera();
  out.twist_covariance =
      track_.filter().mean_twist_covariance() + covariance_of_scale(camera, out.twist_in_camera);
  out.velocity_in_world_m_s = camera.world_from_camera.rotation * out.twist_in_camera.velocity_m_s;
  out.scale = track_.scale();
  if (out.scale != ScaleSource::none) {
    out.scale_age_s = seconds_between(track_.scale_stamp(), frame.stamp);
  }
  return out;
}

}  // namespace stillkite
