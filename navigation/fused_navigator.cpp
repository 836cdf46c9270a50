#include "navigation/fused_navigator.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>

#include "navigation/assumptions.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

InertialStep in_camera(const InertialReading& reading, double dt_s,
                       const Eigen::Quaterniond& body_from_camera) {
  const Eigen::Quaterniond camera_from_body = body_from_camera.conjugate();
  return {.dt_s = dt_s,
          .angular_rate_rad_s = camera_from_body * reading.angular_rate_in_body_rad_s,
          .is_gyro = true,
          .specific_force_m_s2 = camera_from_body * reading.specific_force_in_body_m_s2};
}

// The interval's finite readings, a step each; what they leave open has none.
std::vector<InertialStep> inertial_steps(const std::vector<InertialReading>& readings,
                                         Timestamp from, Timestamp to,
                                         const Eigen::Quaterniond& body_from_camera) {
  std::vector<InertialStep> steps;
  steps.reserve(readings.size() + 1);
  Timestamp at = from;
  for (const InertialReading& reading : readings) {
    const bool is_finite = reading.angular_rate_in_body_rad_s.allFinite() &&
                           reading.specific_force_in_body_m_s2.allFinite();
    if (!is_finite || reading.stamp <= at || reading.stamp > to) continue;
    steps.push_back(in_camera(reading, seconds_between(at, reading.stamp), body_from_camera));
    at = reading.stamp;
  }
  return steps;
}

// Neither the flow nor enough landmarks were to be believed, whatever the reference alone says.
Verdict unmeasured(Verdict reference) {
  const bool is_good = reference == Verdict::ok || reference == Verdict::first_frame;
  return is_good ? Verdict::too_few_inliers : reference;
}

std::array<double, kStageCount> sum_of(std::array<double, kStageCount> a,
                                       const std::array<double, kStageCount>& b) {
  std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::plus<>());
  return a;
}

// now - before, where it is positive.
Matrix6d growth_of(const Matrix6d& before, const Matrix6d& now) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(now - before);
  const Matrix6d& V = solver.eigenvectors();
  return V * solver.eigenvalues().cwiseMax(0).asDiagonal() * V.transpose();
}

FusionConfig checked(const FusionConfig& config) {
  if (config.min_landmarks <= config.landmarks) return config;
  throw InputError(fmt::format("fusion.min_landmarks: {} is more than fusion.landmarks, {}",
                               config.min_landmarks, config.landmarks));
}

}  // namespace

FusedNavigator::FusedNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                               const NavigatorConfig& config, const InitialState& initial,
                               Mode mode)
    : camera_(camera),
      body_from_camera_(body_from_camera),
      config_(checked(config.fusion)),
      readout_s_(config.readout_s),
      scale_(initial.scale),
      flow_(camera, body_from_camera, config, initial),
      reference_(camera, body_from_camera, config, initial, mode),
      filter_(config.fusion, initial.world_from_body * body_from_camera,
              kAnySpeed_heights_s * initial.world_from_body.translation.z()) {}

NavigationEstimate FusedNavigator::step(const Frame& frame, const FrameInterval& interval,
                                        const SensorReadings& readings) {
  // 1. Either estimator by itself.
  const NavigationEstimate flow = flow_.step(frame, interval, readings);
  const NavigationEstimate reference = reference_.step(frame, interval, readings);
  StopWatch watch;
  // 2. Where the camera is by now, by its inertia.
  if (interval.spoiled == Verdict::first_frame) last_ = frame.stamp;
  predict(readings, frame.stamp, flow, reference);
  if (readings.attitude) {
    const Eigen::Quaterniond world_from_camera = *readings.attitude * body_from_camera_.rotation;
    filter_.update_up(world_from_camera.conjugate() * Eigen::Vector3d::UnitZ());
  }
  // 3. How fast the flow says it goes; how the reference's features have moved.
  judge_ground(*reference.reference);
  const bool flow_taken = !interval.spoiled && is_ground_flat_ && see_flow(flow);
  const bool landmarks_taken = !interval.spoiled && see_landmarks();
  // 4. A new reference: the camera, wherever it is, is what the landmarks are seen from.
  if (reference.reference->new_reference) filter_.take_anchor();
  const Verdict verdict = interval.spoiled                ? *interval.spoiled
                          : flow_taken || landmarks_taken ? Verdict::ok
                                                          : unmeasured(reference.verdict);
  NavigationEstimate out = answer(frame, verdict);
  out.stage_ms = sum_of(flow.stage_ms, reference.stage_ms);
  out.stage_ms[static_cast<std::size_t>(Stage::filter)] += watch.lap_ms();
  out.new_keyframe = reference.new_keyframe;
  out.quality = reference.quality;
  out.reference = reference.reference;
  return out;
}

void FusedNavigator::predict(const SensorReadings& readings, Timestamp now,
                             const NavigationEstimate& flow, const NavigationEstimate& reference) {
  if (now <= last_) return;
  const Eigen::Quaterniond before = filter_.state().world_from_camera.rotation;
  const double dt_s = seconds_between(last_, now);
  const std::vector<InertialStep> steps =
      inertial_steps(readings.inertial, last_, now, body_from_camera_.rotation);
  double left_s = dt_s;
  for (const InertialStep& step : steps) {
    filter_.predict(step);
    left_s -= step.dt_s;
  }
  follows_flow_ = steps.empty() && follow_flow(flow, dt_s);
  if (left_s > 1e-6 && !follows_flow_) {
    filter_.predict(uncovered_step(readings, left_s, reference));
  }
  rate_in_camera_rad_s_ =
      follows_flow_
          ? flow.twist_in_camera.angular_rate_rad_s
          : so3_log(before.conjugate() * filter_.state().world_from_camera.rotation) / dt_s;
  const bool has_gyro = !steps.empty() || readings.mean_angular_rate_in_body_rad_s;
  rate_covariance_ = rate_covariance(has_gyro, dt_s, flow, reference);
  last_ = now;
  last_flow_.reset();
  if (flow.verdict == Verdict::ok) last_flow_ = flow;
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

// Of the mean rate since the last frame, by what told it.
Eigen::Matrix3d FusedNavigator::rate_covariance(bool has_gyro, double dt_s,
                                                const NavigationEstimate& flow,
                                                const NavigationEstimate& reference) const {
  if (follows_flow_) return flow.twist_covariance.bottomRightCorner<3, 3>();
  if (has_gyro) {
    return filter_.gyro_bias_covariance() +
           config_.gyro_density * config_.gyro_density / dt_s * Eigen::Matrix3d::Identity();
  }
  return reference.reference->motion.twist_in_camera
             ? Eigen::Matrix3d(reference.twist_covariance.bottomRightCorner<3, 3>())
             : any_rate_covariance();
}

Eigen::Matrix3d FusedNavigator::any_rate_covariance() {
  return kAnyRate_rad_s * kAnyRate_rad_s * Eigen::Matrix3d::Identity();
}

// The way since the last frame, of two answers whose common errors cancel; what the second is less
// certain of is what the way has added.
bool FusedNavigator::follow_flow(const NavigationEstimate& flow, double dt_s) {
  if (!is_ground_flat_ || flow.verdict != Verdict::ok || !last_flow_) return false;
  const RigidTransform before = last_flow_->world_from_body * body_from_camera_;
  const RigidTransform now = flow.world_from_body * body_from_camera_;
  filter_.predict_by_odometry(before.inverse() * now, dt_s,
                              growth_of(last_flow_->pose_covariance, flow.pose_covariance));
  return true;
}

// The flow takes what it sees for flat ground: where the features show depth its metres are wrong
// ones, and before they have shown anything nobody knows.
void FusedNavigator::judge_ground(const ReferenceReport& reference) {
  if (reference.model == ViewModel::plane) is_ground_flat_ = true;
  if (reference.model == ViewModel::general) is_ground_flat_ = false;
}

bool FusedNavigator::see_flow(const NavigationEstimate& flow) {
  if (flow.verdict != Verdict::ok) return false;
  // alike over some frames: an error that would add up to a way counts as often; by odometry none
  // do
  const double alike = follows_flow_ ? 1 : config_.flow_correlated_frames;
  return filter_.update_flow_velocity(flow.twist_in_camera.velocity_m_s,
                                      alike * flow.twist_covariance.topLeftCorner<3, 3>());
}

bool FusedNavigator::see_landmarks() {
  choose_landmarks();
  const FeatureBearings& bearings = reference_.bearings();
  const std::vector<unsigned char>& inliers = reference_.inliers();
  const double sigma = feature_sigma();
  int taken = 0;
  for (std::size_t i = 0; i < std::min(bearings.pairs.size(), inliers.size()); ++i) {
    if (inliers[i] == 0) continue;
    const int feature = static_cast<int>(bearings.feature_of_pair[i]);
    if (filter_.update_landmark(feature, bearings.pairs[i].current, sigma)) ++taken;
  }
  filter_.drop_refused();
  filter_.update_ground();
  return taken >= config_.min_landmarks;
}

// On z = 1. Rows that are read one after the other see a feature where it was at another time.
double FusedNavigator::feature_sigma() const {
  constexpr double kOfUniform = 0.2887;  // 1 / sqrt(12)
  return std::hypot(config_.pixel_sigma_px / camera_.focal_x_px,
                    kOfUniform * readout_s_ * rate_in_camera_rad_s_.norm());
}

// Spread over the picture: each next one as far from those at hand as can be.
void FusedNavigator::choose_landmarks() {
  const FeatureBearings& bearings = reference_.bearings();
  const std::vector<unsigned char>& inliers = reference_.inliers();
  const std::size_t count = std::min(bearings.pairs.size(), inliers.size());
  const auto lacking = static_cast<std::size_t>(config_.landmarks) - filter_.landmarks().size();
  if (lacking == 0 || count == 0) return;
  std::vector<double> distance(count, 1e9);
  const auto keep_away = [&](const Eigen::Vector2d& from) {
    for (std::size_t i = 0; i < count; ++i) {
      distance[i] = std::min(distance[i], (bearings.pairs[i].reference - from).squaredNorm());
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (inliers[i] == 0) distance[i] = 0;
  }
  for (const Landmark& landmark : filter_.landmarks()) keep_away(landmark.bearing);
  for (std::size_t added = 0; added < lacking; ++added) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    constexpr double kApart = 0.02;
    if (!(*farthest > kApart * kApart)) return;
    const auto i = static_cast<std::size_t>(farthest - distance.begin());
    const Eigen::Vector2d bearing = bearings.pairs[i].reference;
    filter_.add_landmark(static_cast<int>(bearings.feature_of_pair[i]), bearing, feature_sigma());
    keep_away(bearing);
  }
}

NavigationEstimate FusedNavigator::answer(const Frame& frame, Verdict verdict) const {
  NavigationEstimate out;
  out.stamp = frame.stamp;
  out.frame_index = frame.index;
  out.verdict = verdict;
  out.source = EstimateSource::fused;
  const RigidTransform world_from_camera = filter_.world_from_camera_m();
  out.world_from_body = world_from_camera * body_from_camera_.inverse();
  out.pose_covariance = filter_.pose_covariance();
  out.velocity_in_world_m_s = filter_.velocity_in_world_m_s();
  const Eigen::Matrix3d R_t = world_from_camera.rotation.conjugate().toRotationMatrix();
  out.twist_in_camera = {R_t * out.velocity_in_world_m_s, rate_in_camera_rad_s_};
  out.twist_covariance.topLeftCorner<3, 3>() =
      R_t * filter_.velocity_covariance() * R_t.transpose();
  out.twist_covariance.bottomRightCorner<3, 3>() = rate_covariance_;
  // metres that were merely guessed are none
  const bool is_metric = filter_.scale_sigma() < config_.metric_below_sigma_ratio;
  out.scale = is_metric ? scale_ : ScaleSource::none;
  return out;
}

}  // namespace stillkite
