#include "navigation/reference_navigator.hpp"

#include <algorithm>

#include "estimation/fusion/error_state.hpp"
#include "estimation/lens_error.hpp"
#include "estimation/two_view/opencv_relative_pose.hpp"
#include "estimation/two_view/relative_pose_estimator.hpp"
#include "navigation/assumptions.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/motion_conversion.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

constexpr int kMinFeatures = 8;
constexpr double kSuddenLossRatio = 0.5;

Eigen::Vector3d up_in_camera(const Eigen::Quaterniond& world_from_camera) {
  return world_from_camera.conjugate() * Eigen::Vector3d::UnitZ();
}

EstimateStatus status_of(Verdict verdict) {
  if (is_measured(verdict)) return EstimateStatus::ok;
  return verdict == Verdict::gated ? EstimateStatus::gated : EstimateStatus::lost;
}

Eigen::Vector2d mean_displacement_px(const std::vector<BearingPair>& pairs, double focal_px) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (const BearingPair& pair : pairs) {
    const Eigen::Vector2d displacement = pair.current - pair.reference;
    if (!displacement.allFinite()) continue;
    sum += displacement;
    ++count;
  }
  return focal_px / std::max(count, 1) * sum;
}

}  // namespace

ReferenceNavigator::ReferenceNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                                       const NavigatorConfig& config, const InitialState& initial,
                                       Mode mode)
    : camera_(camera),
      body_from_camera_(body_from_camera),
      config_(config.reference),
      world_from_initial_(initial.world_from_body * body_from_camera),
      mode_(mode),
      readout_s_(config.readout_s),
      lens_sigma_px_(config.lens_sigma_px),
      gate_(config.reference.gate) {
  references_.push_back(make_reference());
  const double tilt_variance = config.initial_tilt_sigma_rad * config.initial_tilt_sigma_rad;
  current_.world_from_camera = world_from_initial_.rotation;
  current_.covariance =
      Eigen::Vector3d(tilt_variance, tilt_variance, kExactVariance).asDiagonal().toDenseMatrix();
}

NavigationEstimate ReferenceNavigator::step(
    const Frame& frame, const FrameInterval& interval, const SensorReadings& readings,
    const RelocalizationCheck& is_consistent_relocalization) {
  StopWatch watch;
  flow_vectors_.clear();
  bearings_ = {};
  inliers_.clear();
  unit_variance_.reset();
  tracked_px_.clear();
  twist_.reset();
  if (interval.standstill && has_reference_) return stand_still(frame, interval);
  begin_report(frame.stamp);
  // 1. The first frame is the reference. Frozen and out-of-order frames are not measured.
  if (interval.rejection == Verdict::first_frame) initial_stamp_ = current_.stamp = frame.stamp;
  if (!has_reference_) return initialize(frame);
  if (interval.rejection && !interval.is_forward_gap) return answer(frame, *interval.rejection);
  // 2. Associate the reference's features.
  if (try_relocalization(frame, readings, is_consistent_relocalization)) relocalize(frame.stamp);
  const FeatureTracks& tracks = references_.back().association.associate(frame);
  references_.back().max_found = std::max(references_.back().max_found, tracks.found_count);
  const double flow_ms = watch.lap_ms();
  // 3. Undistort them; estimate rotation and translation direction.
  bearings_ = references_.back().rolling_shutter_correction.at_stamp(
      feature_bearings(camera_, tracks), tracks, frame.stamp);
  RelativePoseEstimate pose =
      estimate(bearings_.pairs, references_.back(), last_pose_, readings.attitude);
  const Eigen::Matrix3d independent = pose.covariance.topLeftCorner<3, 3>();
  pose.covariance *= lens_variance_ratio(pose, mean_shift_px(tracks));
  // 4. Validate the pose; the gate rejects a jump of rotation up to three times.
  const Verdict verdict = classify(pose, tracks.found_count);
  report(tracks, pose, verdict);
  if (verdict == Verdict::ok) update_attitude(pose, independent, frame);
  const double solve_ms = watch.lap_ms();
  // 5. Replace the reference if too few features are left, or by schedule.
  renew_reference(frame, tracks.found_count, verdict);
  NavigationEstimate out = answer(frame, verdict);
  out.stage_ms = {0, flow_ms, solve_ms, watch.lap_ms()};
  return out;
}

// The last motion holds, if it was accepted.
NavigationEstimate ReferenceNavigator::stand_still(const Frame& frame,
                                                   const FrameInterval& interval) {
  if (report_.motion.status != EstimateStatus::ok) report_.motion = predicted_motion(frame.stamp);
  report_.new_reference = report_.relocalized = false;
  current_.stamp = frame.stamp;
  twist_ = Twist{};
  rate_covariance_ = square(interval.standstill->rate_rad_s) * Eigen::Matrix3d::Identity();
  NavigationEstimate out = answer(frame, Verdict::still);
  const double variance = square(interval.standstill->rotation_rad);
  out.pose_covariance.diagonal().tail<3>().array() += variance;
  out.reference->motion.rotation_covariance.diagonal().array() += variance;
  return out;
}

ReferenceNavigator::Reference ReferenceNavigator::make_reference() const {
  const bool is_renumbered = config_.association == Association::matching;
  return {.association = FeatureAssociation(config_),
          .attitude = {},
          .rolling_shutter_correction = {is_renumbered ? 0 : readout_s_, camera_.height_px}};
}

void ReferenceNavigator::begin_report(Timestamp now) {
  report_ = {.reference_stamp = references_.back().attitude.stamp,
             .on_first_reference = on_first_reference_};
  if (has_reference_) report_.motion = predicted_motion(now);
}

// Motion before this frame is measured: the last one, its covariance grown by the rate's. It is
// relative to the reference, so the reference's own attitude covariance is subtracted.
MotionEstimate ReferenceNavigator::predicted_motion(Timestamp now) const {
  const Attitude& reference = references_.back().attitude;
  const Eigen::Matrix3d R = reference.world_from_camera.conjugate().toRotationMatrix();
  const double rotation_sigma_rad = kInitialRateSigma_rad_s * seconds_between(current_.stamp, now);
  MotionEstimate motion;
  motion.reference_from_camera =
      reference.world_from_camera.conjugate() * current_.world_from_camera;
  motion.rotation_covariance =
      R * (current_.covariance - reference.covariance) * R.transpose() +
      rotation_sigma_rad * rotation_sigma_rad * Eigen::Matrix3d::Identity();
  return motion;
}

NavigationEstimate ReferenceNavigator::initialize(const Frame& frame) {
  // rotation before the first textured image is not measured
  report_.new_reference = take_reference(frame, frame.stamp == initial_stamp_);
  report_.reference_stamp = frame.stamp;
  return answer(frame, has_reference_ ? Verdict::first_frame : Verdict::too_little_texture);
}

RelativePoseEstimate ReferenceNavigator::estimate(
    const std::vector<BearingPair>& pairs, const Reference& reference,
    const std::optional<RelativePose>& prior,
    const std::optional<Eigen::Quaterniond>& world_from_body) const {
  if (config_.solver == PoseSolver::opencv) {
    return estimate_relative_pose_opencv(pairs, camera_.focal_x_px, config_.opencv_pose);
  }
  RelativePoseHints hints{.prior = prior,
                          .up_in_reference = up_in_camera(reference.attitude.world_from_camera)};
  if (world_from_body) {
    hints.up_in_current = up_in_camera(*world_from_body * body_from_camera_.rotation);
  }
  return estimate_relative_pose(pairs, camera_.focal_x_px, config_.pose, hints);
}

Verdict ReferenceNavigator::classify(const RelativePoseEstimate& pose, int features) {
  if (features < kMinFeatures || is_sudden_loss(features)) return Verdict::lost;
  previous_features_ = features;
  if (pose.model == ViewModel::undecided) return Verdict::too_few_inliers;
  return gate_.accepts(pose.pose.current_from_reference) ? Verdict::ok : Verdict::gated;
}

// A sudden loss of features means occlusion or motion blur; a pose from the rest is unreliable.
bool ReferenceNavigator::is_sudden_loss(int features) const {
  return mode_ == Mode::recommended && features < config_.min_features &&
         features < kSuddenLossRatio * previous_features_;
}

void ReferenceNavigator::report(const FeatureTracks& tracks, const RelativePoseEstimate& pose,
                                Verdict verdict) {
  report_.model = pose.model;
  report_.features = tracks.found_count;
  report_.inliers = pose.inlier_count;
  report_.residual_px = pose.residual * camera_.focal_x_px;
  if (verdict == Verdict::ok || verdict == Verdict::gated) report_.motion = motion_from_pose(pose);
  report_.motion.status = status_of(verdict);
  report_.motion.mean_shift_px = mean_shift_px(tracks);
  report_.motion.parallax_rad = parallax_rad(bearings_.pairs, pose);
  flow_vectors_ = feature_flow_vectors(tracks, bearings_, pose);
  inliers_ = pose.inliers;
  if (verdict == Verdict::ok) unit_variance_ = stillkite::unit_variance(bearings_, pose);
  if (config_.association == Association::windows) {
    tracked_px_ = tracked_inliers(tracks, bearings_, inliers_);
  }
}

// A lens error that all features share adds its variance e^2 to the mean of their n errors, which
// independent ones leave with s^2 / n: the covariance grows by 1 + n e^2 / s^2.
double ReferenceNavigator::lens_variance_ratio(const RelativePoseEstimate& pose,
                                               double displacement_px) const {
  if (!(pose.residual > 0)) return 1;
  const double lens =
      lens_change_sigma(lens_sigma_px_ / camera_.focal_x_px, displacement_px, camera_.width_px);
  return 1 + pose.inlier_count * square(lens / pose.residual);
}

void ReferenceNavigator::update_attitude(const RelativePoseEstimate& pose,
                                         const Eigen::Matrix3d& independent, const Frame& frame) {
  const Eigen::Quaterniond reference_from_camera = pose.pose.current_from_reference.conjugate();
  Attitude next{
      .stamp = frame.stamp,
      .world_from_camera = references_.back().attitude.world_from_camera * reference_from_camera,
      .covariance = Eigen::Matrix3d::Zero(),
      .covariance_from_reference = pose.covariance.topLeftCorner<3, 3>(),
      .independent_covariance = independent};
  next.mean_displacement_px = mean_displacement_px(bearings_.pairs, camera_.focal_x_px);
  const Eigen::Matrix3d R = next.world_from_camera.toRotationMatrix();
  next.covariance =
      references_.back().attitude.covariance + R * next.covariance_from_reference * R.transpose();

  const double dt_s = seconds_between(current_.stamp, frame.stamp);
  const Eigen::Vector3d rate =
      so3_log(current_.world_from_camera.conjugate() * next.world_from_camera) / dt_s;
  if (has_previous_attitude_) twist_ = Twist{.angular_rate_rad_s = rate};
  has_previous_attitude_ = true;
  const Eigen::Vector3d by_stamp = frame.stamp_sigma_s * rate;
  // of the lens error, the change from frame to frame
  const double displacement_px = (next.mean_displacement_px - current_.mean_displacement_px).norm();
  rate_covariance_ = (current_.independent_covariance +
                      lens_variance_ratio(pose, displacement_px) * next.independent_covariance +
                      2 * by_stamp * by_stamp.transpose()) /
                     (dt_s * dt_s);
  current_ = next;
  last_pose_ = pose.pose;
}

NavigationEstimate ReferenceNavigator::answer(const Frame& frame, Verdict verdict) const {
  EstimateParts parts{
      .verdict = verdict,
      .source = EstimateSource::reference,
      .world_from_initial_camera = world_from_initial_,
      .quality = {.flow_vectors = report_.features,
                  .inlier_ratio = report_.features > 0
                                      ? static_cast<double>(report_.inliers) / report_.features
                                      : 0,
                  .mean_flow_px = report_.motion.mean_shift_px,
                  .residual_px = report_.residual_px},
      .new_keyframe = report_.new_reference};
  parts.camera.pose.world_from_camera = {current_.world_from_camera,
                                         world_from_initial_.translation};
  Matrix6d& pose_covariance = parts.camera.pose.covariance;
  // lengths are not measured: the position error is bounded by the speed_sigma only
  const double speed_sigma = kInitialSpeedSigma_heights_s * world_from_initial_.translation.z();
  const double displacement_sigma = speed_sigma * seconds_between(initial_stamp_, frame.stamp);
  const double unmeasured_s = seconds_between(current_.stamp, frame.stamp);
  const double rotation_sigma_rad = kInitialRateSigma_rad_s * unmeasured_s;
  pose_covariance.diagonal().head<3>().setConstant(displacement_sigma * displacement_sigma +
                                                   kExactVariance);
  pose_covariance.bottomRightCorner<3, 3>() = current_.covariance;
  pose_covariance.diagonal().tail<3>().array() += rotation_sigma_rad * rotation_sigma_rad;
  parts.twist_covariance.diagonal().head<3>().setConstant(speed_sigma * speed_sigma);
  parts.twist_covariance.diagonal().tail<3>().setConstant(kInitialRateSigma_rad_s *
                                                          kInitialRateSigma_rad_s);
  if (twist_) {
    const Eigen::Vector3d by_stamp =
        frame.stamp_sigma_s * (current_.world_from_camera * twist_->angular_rate_rad_s);
    pose_covariance.bottomRightCorner<3, 3>() += by_stamp * by_stamp.transpose();
    parts.twist_in_camera = *twist_;
    parts.twist_covariance.bottomRightCorner<3, 3>() = rate_covariance_;
    if (verdict == Verdict::still) {
      parts.twist_covariance.topLeftCorner<3, 3>() =
          square(world_from_initial_.translation.z()) * rate_covariance_;
    }
  }
  NavigationEstimate out = make_estimate(frame, body_from_camera_, parts);
  out.reference = report_;
  out.reference->motion.stamp = frame.stamp;
  out.reference->motion.source = EstimateSource::reference;
  out.reference->motion.status = status_of(verdict);
  out.reference->motion.twist_in_camera = twist_;
  if (twist_ && verdict == Verdict::ok) {
    out.reference->measured_rate_in_camera_rad_s = twist_->angular_rate_rad_s;
  }
  return out;
}

}  // namespace stillkite
