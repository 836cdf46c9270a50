#include <algorithm>
#include <cmath>

#include "navigation/image_texture.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/motion_hypotheses.hpp"

// Alignment of an image to the keyframe: from the prediction or, if that is lost, from a search.

namespace stillkite {
namespace {

constexpr int kSpeedConvergenceFrames = 3;

Vector6d in_heights(const Twist& twist, double height_m) {
  Vector6d v = twist.vector();
  v.head<3>() /= height_m;
  return v;
}

// Distance between the image positions of the keyframe's optical axis under both motions.
bool are_far_apart(const Camera& camera, const PlaneMotion& a, const PlaneMotion& b) {
  constexpr double kMinSeparation_px = 8;
  const auto axis_point = [](const PlaneMotion& motion) -> Eigen::Vector2d {
    return motion.homography().col(2).hnormalized();
  };
  return camera.focal_x_px * (axis_point(a) - axis_point(b)).norm() > kMinSeparation_px;
}

}  // namespace

PlaneAlignment KeyframeNavigator::align(bool allow_search) {
  const PlaneMotion predicted = predicted_motion();
  const bool is_uncertain = is_prediction_uncertain();
  if (is_uncertain) frames_since_speed_reset_ = 0;
  ++frames_since_speed_reset_;
  PlaneAlignment best = align_from(predicted);
  if (!allow_search || (!is_uncertain && classify(best) != Verdict::lost)) return best;
  PlaneMotion initial = predicted;
  const bool is_match = is_close_match(best);
  for (const PlaneMotion& hypothesis : search_hypotheses()) {
    const PlaneAlignment other = align_from(hypothesis);
    // aliasing by repetitive texture: keep the match from the prediction, or none
    if (is_close_match(best) && is_close_match(other) &&
        are_far_apart(camera_, best.motion, other.motion)) {
      if (is_match) continue;
      return align_from(predicted);
    }
    if (!is_better(other, best)) continue;
    best = other;
    initial = other.motion;
  }
  // a far initial value leaves the iterations short of convergence; and the tile state must be that
  // of the returned alignment
  return align_from(initial);
}

bool KeyframeNavigator::is_speed_initializing() const {
  return frames_since_speed_reset_ <= kSpeedConvergenceFrames;
}

// Over ground that is not flat the track coasts, but the images are aligned on.
PlaneMotion KeyframeNavigator::predicted_motion() const {
  if (not_flat_motion_) return *not_flat_motion_;
  return motion_between(track_.keyframe().world_from_camera, track_.filter().pose());
}

// Convergence range of an alignment: about one pixel of the coarsest level.
bool KeyframeNavigator::is_prediction_uncertain() const {
  const double convergence_range_px = std::exp2(current_.levels() - 1);
  return prediction_sigma_px(camera_, track_.filter()) > convergence_range_px;
}

std::vector<PlaneMotion> KeyframeNavigator::search_hypotheses() const {
  std::vector<PlaneMotion> out;
  if (is_textureless(texture_level(current_))) return out;
  const int level = current_.levels() - 1;
  Camera camera = camera_;
  for (int l = 0; l < level; ++l) camera = half_resolution(camera);
  const Eigen::Vector3d normal = predicted_motion().normal;
  const NadirView view = nadir_view(camera, normal);
  for (const ImageRegistration& shift :
       register_images(aligner_.reference().level(level), current_.level(level), view.homography)) {
    const auto motions = motion_hypotheses(shift, camera, view, normal);
    out.insert(out.end(), motions.begin(), motions.end());
  }
  return out;
}

// Minimum correlation above that of images of different places.
bool KeyframeNavigator::is_close_match(const PlaneAlignment& alignment) const {
  constexpr double kMinMatchCorrelation = 0.9;
  return classify(alignment) == Verdict::ok && alignment.correlation >= kMinMatchCorrelation;
}

bool KeyframeNavigator::is_better(const PlaneAlignment& a, const PlaneAlignment& b) const {
  if (classify(a) != Verdict::ok || a.correlation < config_.trust.min_found_correlation)
    return false;
  return classify(b) != Verdict::ok || a.correlation > b.correlation;
}

PlaneAlignment KeyframeNavigator::align_from(const PlaneMotion& initial) {
  PlaneAlignment alignment = align_with_velocity(initial, track_.filter());
  if (config_.readout_s > 0 && is_speed_initializing() && alignment.solvable) {
    // align again with the velocity just measured, for the row times
    alignment = align_with_velocity(initial, track_.filter_after(alignment));
  }
  return alignment;
}

PlaneAlignment KeyframeNavigator::align_with_velocity(const PlaneMotion& initial,
                                                      const MultipleModelFilter& velocity) {
  const PoseEstimate& keyframe = track_.keyframe();
  const double height_m = keyframe.world_from_camera.translation.z();
  const Twist current_twist = velocity.twist_in_camera();
  const Twist& keyframe_twist = is_speed_initializing() ? current_twist : track_.keyframe_twist();
  const RollingShutter shutter{config_.readout_s, in_heights(keyframe_twist, height_m),
                               in_heights(current_twist, height_m)};
  PlaneAlignment alignment = aligner_.align(
      current_, initial, tilt_prior(keyframe, config_.levelling), shutter, smooth_errors());
  // a velocity common to both images hardly affects the motion
  if (is_speed_initializing()) alignment.motion_by_twist.setZero();
  return alignment;
}

// The tiles measure the product of translation and normal, so the motion for another normal follows
// to first order. Beyond that, align again with the normal held.
KeyframeView KeyframeNavigator::make_view(const PlaneAlignment& alignment) {
  constexpr double kMaxSecondOrder_rad = 1e-5;
  const std::optional<Eigen::Vector3d>& normal = hints_.normal;
  TiltPrior tilt = tilt_prior(track_.keyframe(), config_.levelling);
  const KeyframeView view{alignment.motion, tilt.axes, alignment.plane_likelihood,
                          alignment.measured_likelihood};
  if (!normal || !tilt.covariance) return view;
  const Eigen::Vector2d tilt_change_rad =
      tilt.axes.transpose() * alignment.motion.normal.cross(*normal);
  if (alignment.motion.translation.norm() * tilt_change_rad.squaredNorm() < kMaxSecondOrder_rad)
    return view;
  PlaneMotionStep to_normal;
  to_normal << alignment.plane_likelihood.motion_by_tilt * tilt_change_rad, tilt_change_rad;
  PlaneMotion initial = apply(alignment.motion, to_normal, tilt.axes);
  initial.normal = *normal;
  tilt.covariance = 1e-12 * Eigen::Matrix2d::Identity();
  const PlaneAlignment refined =
      aligner_.align(current_, initial, tilt, alignment.shutter, smooth_errors());
  if (classify(refined) != Verdict::ok) return view;  // the hinted normal may be wrong
  return {refined.motion, tilt.axes, refined.plane_likelihood, refined.measured_likelihood};
}

SmoothErrors KeyframeNavigator::smooth_errors() const {
  return {.lens_sigma_px = config_.lens_sigma_px, .relief_ratio = relief_.ratio()};
}

}  // namespace stillkite
