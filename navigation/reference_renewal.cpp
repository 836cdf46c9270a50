#include <algorithm>
#include <cmath>
#include <utility>

#include "flow/pyramid.hpp"
#include "geometry/angle.hpp"
#include "navigation/image_texture.hpp"
#include "navigation/reference_navigator.hpp"

// Which image is the reference: a new one where few features are left, the first one again where
// it comes back into view.

namespace stillkite {
namespace {

// What a loss leaves of the attitude: the camera turns on while nobody looks.
constexpr double kLossSigma_rad = 5 * kDegree;
constexpr int kManyTimes = 2;
constexpr int kCoarseLevels = 4;  // on the last of which noise is averaged away

bool is_featureless(const cv::Mat& grey) {
  Pyramid pyramid;
  pyramid.build(grey, kCoarseLevels);
  return is_bare(pyramid.level(pyramid.levels() - 1));
}

// About the optical axis, from x to y.
double image_turn_rad(const Eigen::Quaterniond& current_from_reference) {
  const Eigen::Matrix3d R = current_from_reference.toRotationMatrix();
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

}  // namespace

int ReferenceNavigator::fewest_features(const Reference& reference) const {
  return std::max(config_.min_features,
                  static_cast<int>(config_.renew_below_ratio * reference.most_found));
}

void ReferenceNavigator::renew_reference(const Frame& frame, int features, Verdict verdict) {
  ++frames_since_reference_;
  const bool measured = verdict == Verdict::ok;
  const bool is_thin = features < fewest_features(references_.back());
  failures_ = is_thin && !measured ? failures_ + 1 : 0;
  const bool is_time = config_.renew_every_frames > 0 && measured &&
                       frames_since_reference_ >= config_.renew_every_frames;
  // features that left with the answer still good make way at once; those merely hidden come back
  const bool is_due = is_time || (is_thin && measured) || failures_ > config_.patience_frames;
  report_.new_reference = is_due && take_reference(frame, measured);
}

// Many of its features, and of those most in one pose: less may be chance.
bool ReferenceNavigator::look_for_home(const Frame& frame, const SensorReadings& readings,
                                       const HomeCheck& is_consistent_relocalization) {
  if (references_.size() == 1 || ++frames_away_ % config_.seek_home_every_frames != 0) return false;
  const double turn_rad = image_turn_rad(current_.world_from_camera.conjugate() *
                                         references_.front().attitude.world_from_camera);
  const FeatureTracks& tracks = references_.front().association.find(frame, turn_rad);
  if (tracks.found_count < kManyTimes * fewest_features(references_.front())) return false;
  const FeatureBearings bearings = feature_bearings(camera_, tracks);
  const RelativePoseEstimate pose =
      estimate(bearings.pairs, references_.front(), {}, readings.attitude);
  return pose.model != ViewModel::undecided && 2 * pose.inlier_count > tracks.found_count &&
         (!is_consistent_relocalization || is_consistent_relocalization(bearings, pose.inliers));
}

void ReferenceNavigator::go_home(Timestamp now) {
  references_.pop_back();
  on_first_reference_ = true;
  is_rate_known_ = false;
  begin_reference();
  begin_report(now);
  report_.relocalized = true;
}

void ReferenceNavigator::begin_reference() {
  last_pose_.reset();
  gate_.reset();
  frames_since_reference_ = failures_ = features_before_ = 0;
}

bool ReferenceNavigator::keeps_home() const {
  // the hold paper holds to whatever is new; OpenCV's way drops features for good
  return mode_ == Mode::recommended && config_.seek_home_every_frames > 0 &&
         config_.renew_every_frames == 0 && config_.association != Association::opencv;
}

// An image without features would be held to for ever: what there is stays until a better comes.
bool ReferenceNavigator::set_reference(const Frame& frame) {
  if (is_featureless(frame.grey)) return false;
  if (!has_reference_ || !on_first_reference_ || !keeps_home()) {
    return references_.back().association.set_reference(frame, config_.min_features, followed_px_);
  }
  Reference next = fresh_reference();
  if (!next.association.set_reference(frame, config_.min_features, followed_px_)) return false;
  references_.push_back(std::move(next));
  frames_away_ = 0;
  return true;
}

bool ReferenceNavigator::take_reference(const Frame& frame, bool measured) {
  if (!set_reference(frame)) return false;
  current_.stamp = frame.stamp;
  if (!measured) {
    current_.covariance.diagonal().array() += kLossSigma_rad * kLossSigma_rad;
  }
  on_first_reference_ = !has_reference_ || mode_ == Mode::paper;
  if (has_reference_ && mode_ == Mode::paper) current_.world_from_camera = start_.rotation;
  has_reference_ = true;
  current_.covariance_from_reference.setZero();
  references_.back().most_found = 0;
  references_.back().attitude = current_;
  references_.back().row_times.begin(frame.stamp);
  begin_reference();
  return true;
}

}  // namespace stillkite
