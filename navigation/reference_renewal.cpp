#include <algorithm>
#include <cmath>
#include <utility>

#include "flow/pyramid.hpp"
#include "geometry/angle.hpp"
#include "navigation/image_texture.hpp"
#include "navigation/reference_navigator.hpp"

// Reference selection: replacement when few features are left, relocalization on the first one.

namespace stillkite {
namespace {

// Standard deviation of the unmeasured rotation during a loss.
constexpr double kReferenceLossSigma_rad = 5 * kDegree;
constexpr int kRelocalizationFeatureRatio = 2;
constexpr int kCoarseLevels = 4;  // noise is averaged out on the last one

bool is_featureless(const cv::Mat& grey) {
  Pyramid pyramid;
  pyramid.build(grey, kCoarseLevels);
  return is_textureless(pyramid.level(pyramid.levels() - 1));
}

// Rotation about the optical axis, from x to y.
double image_rotation_rad(const Eigen::Quaterniond& current_from_reference) {
  const Eigen::Matrix3d R = current_from_reference.toRotationMatrix();
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

}  // namespace

int ReferenceNavigator::min_features(const Reference& reference) const {
  return std::max(config_.min_features,
                  static_cast<int>(config_.renew_below_ratio * reference.max_found));
}

void ReferenceNavigator::renew_reference(const Frame& frame, int features, Verdict verdict) {
  ++frames_since_reference_;
  const bool measured = verdict == Verdict::ok;
  const bool has_too_few = features < min_features(references_.back());
  failures_ = has_too_few && !measured ? failures_ + 1 : 0;
  const bool is_scheduled = config_.renew_every_frames > 0 && measured &&
                            frames_since_reference_ >= config_.renew_every_frames;
  // features out of view are replaced at once; after a failure they may reappear
  const bool is_due =
      is_scheduled || (has_too_few && measured) || failures_ > config_.patience_frames;
  report_.new_reference = is_due && take_reference(frame, measured);
}

// Requires many of its features, most of them inliers of one pose.
bool ReferenceNavigator::try_relocalization(
    const Frame& frame, const SensorReadings& readings,
    const RelocalizationCheck& is_consistent_relocalization) {
  if (references_.size() == 1 ||
      ++frames_off_first_reference_ % config_.relocalize_every_frames != 0) {
    return false;
  }
  const double rotation_rad = image_rotation_rad(current_.world_from_camera.conjugate() *
                                                 references_.front().attitude.world_from_camera);
  const FeatureTracks& tracks = references_.front().association.associate(frame, rotation_rad);
  if (tracks.found_count < kRelocalizationFeatureRatio * min_features(references_.front()))
    return false;
  const FeatureBearings bearings = feature_bearings(camera_, tracks);
  const RelativePoseEstimate pose =
      estimate(bearings.pairs, references_.front(), {}, readings.attitude);
  return pose.model != ViewModel::undecided && 2 * pose.inlier_count > tracks.found_count &&
         (!is_consistent_relocalization || is_consistent_relocalization(bearings, pose.inliers));
}

void ReferenceNavigator::relocalize(Timestamp now) {
  references_.pop_back();
  on_first_reference_ = true;
  has_previous_attitude_ = false;
  begin_reference();
  begin_report(now);
  report_.relocalized = true;
}

void ReferenceNavigator::begin_reference() {
  last_pose_.reset();
  gate_.reset();
  frames_since_reference_ = failures_ = previous_features_ = 0;
}

bool ReferenceNavigator::keeps_first_reference() const {
  // the hold paper holds the newest reference; OpenCV's tracker loses features permanently
  return mode_ == Mode::recommended && config_.relocalize_every_frames > 0 &&
         config_.renew_every_frames == 0 && config_.association != Association::opencv;
}

// A textureless image is not accepted: it would never be replaced.
bool ReferenceNavigator::set_reference(const Frame& frame) {
  if (is_featureless(frame.grey)) return false;
  if (!has_reference_ || !on_first_reference_ || !keeps_first_reference()) {
    return references_.back().association.set_reference(frame, config_.min_features, tracked_px_);
  }
  Reference next = make_reference();
  if (!next.association.set_reference(frame, config_.min_features, tracked_px_)) return false;
  references_.push_back(std::move(next));
  frames_off_first_reference_ = 0;
  return true;
}

bool ReferenceNavigator::take_reference(const Frame& frame, bool measured) {
  if (!set_reference(frame)) return false;
  current_.stamp = frame.stamp;
  if (!measured) {
    current_.covariance.diagonal().array() += kReferenceLossSigma_rad * kReferenceLossSigma_rad;
  }
  on_first_reference_ = !has_reference_ || mode_ == Mode::paper;
  if (has_reference_ && mode_ == Mode::paper)
    current_.world_from_camera = world_from_initial_.rotation;
  has_reference_ = true;
  current_.covariance_from_reference.setZero();
  current_.independent_covariance.setZero();
  current_.mean_displacement_px.setZero();
  references_.back().max_found = 0;
  references_.back().attitude = current_;
  references_.back().rolling_shutter_correction.begin(frame.stamp);
  begin_reference();
  return true;
}

}  // namespace stillkite
