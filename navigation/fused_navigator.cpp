#include "navigation/fused_navigator.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/two_view/ground_relief.hpp"
#include "geometry/plane.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/fusion_setup.hpp"
#include "navigation/inertial_steps.hpp"
#include "navigation/sensor_update.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

// Neither the flow nor enough landmarks were to be believed, whatever the reference alone says.
Verdict unmeasured(Verdict reference) {
  return is_measured(reference) ? Verdict::too_few_inliers : reference;
}

// The report's motion is the filter's once that is in metres.
NavigationEstimate with_fused_motion(NavigationEstimate out,
                                     const MotionEstimate& since_reference) {
  if (out.verdict != Verdict::ok || out.scale == ScaleSource::none) return out;
  out.reference->motion = since_reference;
  out.reference->motion.scale_age_s = out.scale_age_s;
  out.reference->motion.twist_in_camera = out.twist_in_camera;
  return out;
}

}  // namespace

FusedNavigator::FusedNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                               const NavigatorConfig& config, const InitialState& initial)
    : camera_(camera),
      body_from_camera_(body_from_camera),
      world_from_initial_(initial.world_from_body.rotation * body_from_camera.rotation),
      config_(checked_fusion_config(config)),
      sensors_(config.sensors),
      scale_(initial.scale == ScaleSource::none ? ScaleSource::imu : initial.scale),
      flow_(camera, body_from_camera, config, initial),
      reference_(camera, body_from_camera, config, initial, Mode::recommended),
      flow_from_camera_(initial.world_from_body * body_from_camera),
      flow_scale_(initial.scale),
      landmarks_(config_, camera.focal_x_px),
      filter_(config_, fusion_start(initial, body_from_camera, config.initial_tilt_sigma_rad)),
      home_(filter_.map()),
      is_ground_flat_(config.fusion.flat_ground) {}

NavigationEstimate FusedNavigator::step(const Frame& frame, const FrameInterval& interval,
                                        const SensorReadings& readings) {
  // 1. Either estimator by itself: the flow's image is not searched for where it is of no use,
  //    and the reference's is told the vertical.
  const NavigationEstimate flow = flow_.step(frame, interval, readings, flow_hints());
  if (flow_.has_jumped()) filter_.forget_start();
  SensorReadings hints = readings;
  if (!hints.attitude) hints.attitude = guessed_attitude(flow);
  const Eigen::Quaterniond world_from_camera = *hints.attitude * body_from_camera_.rotation;
  const NavigationEstimate reference =
      reference_.step(frame, interval, hints, [&](const auto& bearings, const auto& inliers) {
        return is_consistent_relocalization(bearings, inliers, world_from_camera, frame.stamp);
      });
  StopWatch watch;
  // 2. Where the camera is by now, by its inertia.
  if (interval.rejection == Verdict::first_frame) scale_stamp_ = last_ = frame.stamp;
  predict(readings, frame.stamp, reference);
  update_from_sensors(readings, frame.stamp);
  // 3. How the ground has moved since the flow's keyframe, and the features since the reference.
  const Seen seen = update_from_images(flow, reference, interval.rejection.has_value());
  const VectorEstimate velocity = mean_velocity(flow, seen.ground);
  const MotionEstimate since_reference = motion_since_reference(reference.reference->motion);
  // 4. The camera, wherever it is, is what new landmarks and the ground will be seen from.
  if (reference.reference->new_reference) take_reference(reference.reference->on_first_reference);
  if (flow.new_keyframe) filter_.take_keyframe();
  const Verdict verdict = interval.rejection              ? *interval.rejection
                          : seen.ground || seen.landmarks ? Verdict::ok
                                                          : unmeasured(reference.verdict);
  NavigationEstimate out = with_fused_motion(
      with_both_reports(answer(frame, verdict, velocity, reference), flow, reference),
      since_reference);
  out.stage_ms[static_cast<std::size_t>(Stage::filter)] += watch.lap_ms();
  return out;
}

FlowHints FusedNavigator::flow_hints() const {
  FlowHints hints{.allow_search = !has_relief_, .normal = {}};
  if (is_ground_flat_) hints.normal = filter_.normal_in_keyframe();
  return hints;
}

FusedNavigator::Seen FusedNavigator::update_from_images(const NavigationEstimate& flow,
                                                        const NavigationEstimate& reference,
                                                        bool is_spoiled) {
  const bool relocalized = reference.reference->relocalized;
  const bool on_first_reference = reference.reference->on_first_reference;
  landmarks_.add_unit_variance(reference_.unit_variance());
  flow_from_camera_ = flow.world_from_body * body_from_camera_;
  if (flow.scale != flow_scale_) reseat_anchor();  // its world has another unit now
  flow_scale_ = flow.scale;
  if (flow.verdict == Verdict::ok && !relocalized) judge_ground(on_first_reference);
  Seen seen;
  seen.ground = is_ground_flat_ && update_from_plane();
  if (relocalized) filter_.restore(home_);
  seen.landmarks = !is_spoiled && update_from_landmarks(on_first_reference);
  if (!has_gyro_ && !seen.ground) update_rotation(reference);
  if (relocalized) reseat_anchor();
  if (!has_gyro_) set_angular_rate(seen.ground ? flow : reference);
  return seen;
}

// Pavement and crops look alike at many places: what is seen of the first reference must be where
// it is expected, give or take much more than the filter is off by when it is too sure.
bool FusedNavigator::is_consistent_relocalization(const FeatureBearings& bearings,
                                                  const std::vector<unsigned char>& inliers,
                                                  const Eigen::Quaterniond& world_from_camera,
                                                  Timestamp now) const {
  constexpr double kSigmas = 10;
  constexpr double kLeast_heights = 0.005;  // and so many radians
  constexpr double kShareOfStep = 0.5;
  const Eigen::Vector3d step_m = seconds_between(last_, now) * filter_.velocity_in_world_m_s();
  const RigidTransform expected_m{world_from_camera,
                                  filter_.world_from_camera_m().translation + step_m};
  Matrix6d covariance = filter_.pose_covariance();
  covariance.diagonal().head<3>().array() +=
      square(kLeast_heights * filter_.height_m()) + square(kShareOfStep * step_m.norm());
  covariance.diagonal().tail<3>().array() += square(kLeast_heights);
  return filter_.may_be_seen(home_, landmarks_.views(bearings, inliers), expected_m, covariance,
                             kSigmas);
}

void FusedNavigator::take_reference(bool on_first_reference) {
  if (on_first_reference) home_ = filter_.map();
  filter_.take_anchor();
  flow_from_anchor_ = flow_from_camera_;
}

// Where the filter has it.
void FusedNavigator::reseat_anchor() {
  flow_from_anchor_ = flow_from_camera_ * filter_.anchor_from_camera_m().inverse();
}

// What the filter makes of what the reference estimator says of it.
MotionEstimate FusedNavigator::motion_since_reference(const MotionEstimate& by_reference) const {
  MotionEstimate motion = by_reference;
  const RigidTransform seen = filter_.anchor_from_camera_m();
  const Matrix6d covariance = filter_.anchored_covariance();
  motion.status = EstimateStatus::ok;
  motion.source = EstimateSource::fused;
  motion.reference_from_camera = seen.rotation;
  motion.rotation_covariance = covariance.bottomRightCorner<3, 3>();
  motion.displacement_kind = DisplacementKind::metric;
  motion.displacement_in_reference = seen.translation;
  motion.displacement_covariance = covariance.topLeftCorner<3, 3>();
  motion.scale = scale_;
  return motion;
}

// As it was, and on by what the flow has turned since.
Eigen::Quaterniond FusedNavigator::guessed_attitude(const NavigationEstimate& flow) const {
  const Eigen::Quaterniond turn =
      flow_from_camera_.rotation.conjugate() * (flow.world_from_body * body_from_camera_).rotation;
  return filter_.state().world_from_camera.rotation * turn * body_from_camera_.rotation.conjugate();
}

void FusedNavigator::predict(const SensorReadings& readings, Timestamp now,
                             const NavigationEstimate& reference) {
  if (now <= last_) return;
  const Eigen::Quaterniond before = filter_.state().world_from_camera.rotation;
  const double dt_s = seconds_between(last_, now);
  filter_.begin_step();
  step_s_ = dt_s;
  const std::vector<InertialStep> steps =
      inertial_steps(readings.inertial, last_, now, body_from_camera_.rotation);
  double left_s = dt_s;
  for (const InertialStep& step : steps) {
    filter_.predict(step);
    left_s -= step.dt_s;
  }
  if (left_s > 1e-6) filter_.predict(uncovered_step(readings, left_s, reference));
  has_gyro_ = !steps.empty() || readings.mean_angular_rate_in_body_rad_s;
  rate_in_camera_rad_s_ =
      so3_log(before.conjugate() * filter_.state().world_from_camera.rotation) / dt_s;
  rate_covariance_ = filter_.gyro_bias_covariance() +
                     square(config_.gyro_density) / dt_s * Eigen::Matrix3d::Identity();
  last_ = now;
}

// Where neither gyroscope nor ground tells it. Its errors last as the flow's do.
void FusedNavigator::update_rotation(const NavigationEstimate& reference) {
  const MotionEstimate& motion = reference.reference->motion;
  if (reference.verdict != Verdict::ok || motion.status != EstimateStatus::ok) return;
  // of OpenCV's turns, and where pairs do not tell, nobody knows how good they are
  if (!(motion.rotation_covariance.diagonal().minCoeff() > 0)) return;
  filter_.update_turn(motion.reference_from_camera,
                      correlated_frames() * motion.rotation_covariance);
}

void FusedNavigator::set_angular_rate(const NavigationEstimate& estimate) {
  rate_in_camera_rad_s_ = estimate.twist_in_camera.angular_rate_rad_s;
  rate_covariance_ = estimate.twist_covariance.bottomRightCorner<3, 3>();
}

void FusedNavigator::update_from_sensors(const SensorReadings& readings, Timestamp now) {
  const CameraReadings camera =
      camera_readings(readings, body_from_camera_, filter_.state().world_from_camera.rotation);
  constexpr double kAlike = 3;  // frames, over which what an attitude is off by lasts
  if (camera.attitude) {
    filter_.update_up(camera.attitude->conjugate() * Eigen::Vector3d::UnitZ(),
                      std::sqrt(kAlike) * sensors_.attitude_sigma_rad);
  }
  if (!camera.height_m || !(*camera.height_m > 0)) return;
  // under a range finder a table is no ground; where nothing told a height before, the first counts
  const bool is_told = scale_ != ScaleSource::imu;
  if (camera.height_source == ScaleSource::range && is_told && !is_ground_flat_) return;
  // a sensor outranks what was said at the start
  if (scale_ == ScaleSource::initial_height && !is_start_doubted_) {
    filter_.doubt_height(sensors_.start_height_sigma_ratio);
    is_start_doubted_ = true;
  }
  if (!filter_.update_height(*camera.height_m, sensors_.height_sigma_m)) return;
  scale_ = camera.height_source;
  scale_stamp_ = now;
}

// What the IMU's readings leave open.
InertialStep FusedNavigator::uncovered_step(const SensorReadings& readings, double dt_s,
                                            const NavigationEstimate& reference) const {
  InertialStep step{
      .dt_s = dt_s, .angular_rate_rad_s = {}, .is_gyro = false, .specific_force_m_s2 = {}};
  if (readings.mean_angular_rate_in_body_rad_s) {
    step.is_gyro = true;
    step.angular_rate_rad_s =
        body_from_camera_.rotation.conjugate() * *readings.mean_angular_rate_in_body_rad_s;
  } else if (reference.reference->motion.twist_in_camera) {
    step.angular_rate_rad_s = reference.reference->motion.twist_in_camera->angular_rate_rad_s;
  }
  return step;
}

// The flow takes what it sees for flat and level. Where its own motion does not take the features
// to where they are, what it sees has depth, and its metres are wrong ones; and so where landmarks
// lie at different heights. What looks flat elsewhere than at the start may lie on another level.
void FusedNavigator::judge_ground(bool on_first_reference) {
  if (config_.flat_ground) return;
  constexpr double kMostMisfit = 0.2;
  constexpr int kInARow = 5;
  constexpr double kShift_px = 0.3;
  const GroundPlane ground = ground_plane_in_camera(flow_from_anchor_);
  const std::optional<double> misfit =
      ground_misfit(reference_.bearings().pairs, flow_from_camera_.inverse() * flow_from_anchor_,
                    ground.normal_in_camera, ground.height_m, kShift_px / camera_.focal_x_px);
  if (!misfit) return;
  const bool looks_flat =
      *misfit <= kMostMisfit && (on_first_reference || is_ground_flat_) && !has_relief_;
  contrary_ = looks_flat == is_ground_flat_ ? 0 : contrary_ + 1;
  if (contrary_ < kInARow) return;
  is_ground_flat_ = looks_flat;
  contrary_ = 0;
}

bool FusedNavigator::update_from_plane() {
  const std::optional<KeyframeView>& view = flow_.view();
  return view && filter_.update_keyframe_view(*view, lens_ratio() * correlated_frames());
}

// A lens that is not as told bends the flow's windows as it bends features.
double FusedNavigator::lens_ratio() const {
  return std::max(1.0, landmarks_.unit_variance());
}

// An error of the flow that would add up to a way counts as often as frames share it.
double FusedNavigator::correlated_frames() const {
  return step_s_ > 0 ? std::max(1.0, config_.flow_correlated_s / step_s_) : 1;
}

bool FusedNavigator::update_from_landmarks(bool on_first_reference) {
  const FeatureBearings& bearings = reference_.bearings();
  landmarks_.select(filter_, bearings, reference_.inliers(), on_first_reference);
  const int taken = filter_.update_landmarks(landmarks_.views(bearings, reference_.inliers()));
  has_relief_ = !config_.flat_ground && filter_.shows_relief();
  if (has_relief_) is_ground_flat_ = false;
  // under a later reference the lowest level may be another than the start's
  if (is_ground_flat_ || on_first_reference) filter_.update_ground(is_ground_flat_);
  return taken >= config_.min_landmarks;
}

// In the axes of the camera half way through the last interval.
VectorEstimate FusedNavigator::mean_velocity(const NavigationEstimate& flow,
                                             bool flow_taken) const {
  const VectorEstimate by_way = velocity_by_way(filter_, step_s_, world_from_half_way());
  const double flow_height_m = flow_from_camera_.translation.z();
  if (has_gyro_ || !flow_taken || !(flow_height_m > 0 && filter_.height_m() > 0)) return by_way;
  return velocity_by_way_and_ground(filter_, by_way, flow, flow_height_m, lens_ratio(),
                                    config_.gate_sigma);
}

Eigen::Quaterniond FusedNavigator::world_from_half_way() const {
  return filter_.state().world_from_camera.rotation *
         so3_exp(-0.5 * step_s_ * rate_in_camera_rad_s_);
}

NavigationEstimate FusedNavigator::answer(const Frame& frame, Verdict verdict,
                                          const VectorEstimate& velocity_in_camera,
                                          const NavigationEstimate& reference) const {
  // metres that were merely guessed are none
  const bool is_metric = filter_.scale_sigma() < config_.metric_below_sigma_ratio;
  EstimateParts parts{.verdict = verdict,
                      .source = EstimateSource::fused,
                      .camera = {.pose = {filter_.world_from_camera_m(), filter_.pose_covariance()},
                                 .scale = is_metric ? scale_ : ScaleSource::none,
                                 .scale_stamp = scale_stamp_},
                      .world_from_initial_camera = {world_from_initial_, filter_.start_m()},
                      .twist_in_camera = {velocity_in_camera.mean, rate_in_camera_rad_s_},
                      .velocity_in_world_m_s = world_from_half_way() * velocity_in_camera.mean,
                      .quality = reference.quality,
                      .new_keyframe = reference.new_keyframe};
  parts.twist_covariance.topLeftCorner<3, 3>() = velocity_in_camera.covariance;
  parts.twist_covariance.bottomRightCorner<3, 3>() = rate_covariance_;
  NavigationEstimate out = make_estimate(frame, body_from_camera_, parts);
  out.gravity_alignment = {.aligned_from_world = filter_.aligned_from_world(),
                           .pose_covariance = filter_.upright_pose_covariance(),
                           .sigma_rad = filter_.up_sigma_rad()};
  return out;
}

}  // namespace stillkite
