#include "estimation/sliding_window/initialization.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/sliding_window/ground_points.hpp"
#include "estimation/sliding_window/linear_alignment.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"
#include "estimation/sliding_window/rotation_alignment.hpp"
#include "estimation/sliding_window/window_solver.hpp"
#include "estimation/sliding_window/window_step.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

// Points whose mean squared error is far above that of the others.
void reject_outlier_points(Window& window) {
  constexpr double kMaxRatioToMedian = 9;
  std::vector<double> errors;
  std::vector<std::size_t> points;
  ReprojectionErrors reprojection(window);
  for (std::size_t i = 0; i < window.tracks.size(); ++i) {
    const WindowTrack& track = window.tracks[i];
    if (!track.point || track.observations.size() < 2) continue;
    double sum = 0;
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      sum += reprojection.squared(track, track.observations[k]);
    }
    errors.push_back(sum / static_cast<double>(track.observations.size() - 1));
    points.push_back(i);
  }
  if (errors.empty()) return;
  const double limit = kMaxRatioToMedian * std::max(1.0, upper_median(errors));
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!(errors[k] <= limit)) window.tracks[points[k]].point.reset();
  }
}

void set_states(const LinearAlignment& alignment, const RigidTransform& world_from_first,
                Window& window) {
  const Eigen::Quaterniond& prior = world_from_first.rotation;
  const Eigen::Quaterniond rotation =
      rotation_between(prior * -alignment.gravity, Eigen::Vector3d::UnitZ()) * prior;
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    frame.first_estimate.reset();
    const RigidTransform& pose = alignment.first_from_imu[i];
    frame.state.world_from_imu = {(rotation * pose.rotation).normalized(),
                                  world_from_first.translation + rotation * pose.translation};
    frame.state.velocity_in_world_m_s = rotation * alignment.velocities[i];
  }
  for (std::size_t i = 0; i < window.tracks.size(); ++i) {
    window.tracks[i].point.reset();
    const std::optional<double>& depth_m = alignment.depths_m[i];
    if (!depth_m || !(*depth_m > 0)) continue;
    window.tracks[i].point =
        InverseDepthPoint{window.tracks[i].observations.front().bearing, 1 / *depth_m};
  }
}

// Moves the window so that its first frame has this position and yaw.
void move_first_frame(const RigidTransform& world_from_first, Window& window) {
  const RigidTransform before = window.frames.front().state.world_from_imu;
  const Eigen::Quaterniond change = world_from_first.rotation * before.rotation.conjugate();
  const Eigen::Quaterniond yaw = so3_exp({0, 0, 2 * std::atan2(change.z(), change.w())});
  move_window(window, yaw, before.translation, world_from_first.translation);
}

// Tilt of the first frame, and a ground at zero height within its relief and the error of the first
// frame's height.
void add_start(const Window& window, int at, MarginalPrior& prior) {
  const StartAboveGround& start = *window.start;
  const RigidTransform& pose = window.frames.front().state.world_from_imu;
  GroundError sigma;
  sigma << start.slope_sigma(), start.slope_sigma(),
      std::hypot(start.height_sigma_m, start.relief.sigma_m());
  const GroundError information = sigma.cwiseAbs2().cwiseInverse();
  const auto ground = Eigen::seqN(SharedIndex::kGround, GroundIndex::kSize);
  prior.information.diagonal()(ground) = information;
  prior.gradient(ground) = -information.cwiseProduct(minus(window.first_ground, WindowGround{}));
  if (!start.tilt_sigma_rad) return;
  const Eigen::Vector3d up = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d tilt = (Eigen::Matrix3d::Identity() - up * up.transpose()) /
                               (*start.tilt_sigma_rad * *start.tilt_sigma_rad);
  prior.information.block<3, 3>(at, at) += tilt;
  prior.gradient.segment<3>(at) +=
      tilt * so3_log(pose.rotation.conjugate() * start.world_from_imu.rotation);
}

// Zero velocity by the images; gyroscope bias and gravity by the mean readings.
void add_rest(const InitialRest& rest, const WindowFrame& frame, int at, MarginalPrior& prior) {
  const ImuNoise& noise = frame.imu.noise();
  const auto diagonal = [&](int first) {
    return prior.information.diagonal().segment<3>(at + first).array();
  };
  const auto gradient = [&](int first) { return prior.gradient.segment<3>(at + first); };
  const double velocity_information = 1 / (rest.velocity_sigma_m_s * rest.velocity_sigma_m_s);
  diagonal(InertialIndex::kVelocity) += velocity_information;
  gradient(InertialIndex::kVelocity) -= velocity_information * frame.state.velocity_in_world_m_s;
  const double rate_information = rest.duration_s / (noise.gyro_density * noise.gyro_density);
  diagonal(InertialIndex::kGyroBias) += rate_information;
  gradient(InertialIndex::kGyroBias) +=
      rate_information * (rest.angular_rate_rad_s - frame.state.gyro_bias_rad_s);
  const double force_information = rest.duration_s / (noise.accel_density * noise.accel_density);
  const Eigen::Vector3d expected =
      frame.state.world_from_imu.rotation.conjugate() * -gravity_in_world();
  Eigen::Matrix<double, 3, InertialIndex::kSize> J =
      Eigen::Matrix<double, 3, InertialIndex::kSize>::Zero();
  J.middleCols<3>(InertialIndex::kRotation) = skew(expected);
  J.middleCols<3>(InertialIndex::kAccelBias).setIdentity();
  prior.information.block<InertialIndex::kSize, InertialIndex::kSize>(at, at) +=
      force_information * J.transpose() * J;
  prior.gradient.segment<InertialIndex::kSize>(at) +=
      force_information * J.transpose() *
      (rest.specific_force_m_s2 - expected - frame.state.accel_bias_m_s2);
}

constexpr std::size_t kMinPoints = 12;

double mean_squared_error(const WindowFit& fit) {
  return fit.observations > 0 ? 2 * fit.reprojection / fit.observations : 1e9;
}

// The estimation converged, and agrees with images and priors.
bool is_explained(const Window& window, const InertialPriors& priors, double mean_squared_error) {
  constexpr double kMaxMeanSquaredError = 8;
  constexpr double kMaxDecrement = 0.5;     // one standard deviation from the minimum
  constexpr double kMaxBiasSigmas2 = 11.3;  // 99 %, three degrees of freedom
  return newton_decrement(window) < kMaxDecrement && mean_squared_error < kMaxMeanSquaredError &&
         accel_bias_deviation(window.frames.front().state, priors) < kMaxBiasSigmas2 &&
         camera_rotation_deviation(window, priors) < kFiveSigma3;
}

}  // namespace

double scale_sigma_ratio(const Window& window) {
  const Eigen::VectorXd distances = scale_direction(window);
  return window_sigma(window, distances) / distances.squaredNorm();
}

double height_sigma_ratio(const Window& window) {
  const double height_m =
      window.frames.front().state.world_from_imu.translation.z() - window.ground.height_m;
  const int height = SharedIndex::kGround + GroundIndex::kHeight;
  return window_sigma(window, Eigen::VectorXd::Unit(window.offsets().back(), height)) / height_m;
}

void set_initial_prior(Window& window, const InertialPriors& priors,
                       const std::optional<InitialRest>& rest) {
  constexpr double kPosition_m = 1e-3;
  constexpr double kYaw_rad = 1e-4;
  const auto information = [](double sigma) { return 1 / (sigma * sigma); };
  const std::vector<int> offsets = window.offsets();
  MarginalPrior& prior = window.prior;
  prior.information = Eigen::MatrixXd::Zero(offsets.back(), offsets.back());
  prior.gradient = Eigen::VectorXd::Zero(offsets.back());
  auto diagonal = prior.information.diagonal();
  diagonal.segment<3>(ExtrinsicsIndex::kRotation)
      .setConstant(information(priors.camera_rotation_rad));
  diagonal.segment<3>(ExtrinsicsIndex::kLeverArm).setConstant(information(priors.lever_arm_m));
  diagonal[ExtrinsicsIndex::kTimeOffset] = information(priors.time_offset_s);
  prior.gradient.head<ExtrinsicsIndex::kSize>() =
      diagonal.head<ExtrinsicsIndex::kSize>().cwiseProduct(
          minus(window.calibrated, window.first_extrinsics));
  diagonal.segment<GroundIndex::kSize>(SharedIndex::kGround).setOnes();  // without a start
  WindowFrame& first = window.frames.front();
  // a new clock offset has moved its state along the motion
  if (first.first_estimate) move_first_frame(first.first_estimate->world_from_imu, window);
  first.first_estimate = first.state;
  const int at = offsets.front();
  const Eigen::Vector3d up =
      first.state.world_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  prior.information.block<3, 3>(at, at) = information(kYaw_rad) * up * up.transpose();
  diagonal.segment<3>(at + InertialIndex::kPosition).setConstant(information(kPosition_m));
  diagonal.segment<3>(at + InertialIndex::kGyroBias)
      .setConstant(information(priors.gyro_bias_rad_s));
  diagonal.segment<3>(at + InertialIndex::kAccelBias)
      .setConstant(information(priors.accel_bias_m_s2));
  prior.gradient.segment<3>(at + InertialIndex::kGyroBias) =
      -information(priors.gyro_bias_rad_s) * first.state.gyro_bias_rad_s;
  prior.gradient.segment<3>(at + InertialIndex::kAccelBias) =
      -information(priors.accel_bias_m_s2) * first.state.accel_bias_m_s2;
  if (window.start) add_start(window, at, prior);
  if (rest) add_rest(*rest, first, at, prior);
}

double camera_rotation_deviation(const Window& window, const InertialPriors& priors) {
  const ExtrinsicsError change = minus(window.extrinsics, window.calibrated);
  return (change.segment<3>(ExtrinsicsIndex::kRotation) / priors.camera_rotation_rad).squaredNorm();
}

double accel_bias_deviation(const InertialState& state, const InertialPriors& priors) {
  return (state.accel_bias_m_s2 / priors.accel_bias_m_s2).squaredNorm();
}

void InitialRest::add(const ImuInterval& reading) {
  const double dt_s = seconds_between(reading.from, reading.to);
  duration_s += dt_s;
  const double share = dt_s / duration_s;
  angular_rate_rad_s += share * (reading.angular_rate_rad_s - angular_rate_rad_s);
  specific_force_m_s2 += share * (reading.specific_force_m_s2 - specific_force_m_s2);
}

void initialize_at_rest(Window& window, const InitialRest& rest) {
  InertialState& state = window.frames.front().state;
  const Eigen::Quaterniond before = state.world_from_imu.rotation;
  const Eigen::Quaterniond to_vertical =
      rotation_between(before * rest.specific_force_m_s2, Eigen::Vector3d::UnitZ());
  state.world_from_imu.rotation = (to_vertical * before).normalized();
  state.velocity_in_world_m_s.setZero();
  state.gyro_bias_rad_s = rest.angular_rate_rad_s;
  state.accel_bias_m_s2.setZero();
}

Initialization initialize_above_ground(Window& window, const InertialPriors& priors) {
  constexpr int kMaxIterations = 20;
  constexpr double kMinGround_ratio = 0.8;  // nothing measures the others
  for (WindowTrack& track : window.tracks) track.point.reset();
  const std::size_t placed = place_on_ground(window);
  const auto seen = std::ranges::count_if(
      window.tracks, [](const WindowTrack& track) { return track.observations.size() > 1; });
  if (placed < kMinPoints ||
      static_cast<double>(placed) < kMinGround_ratio * static_cast<double>(seen))
    return {};
  linearize_at_present(window);
  set_initial_prior(window, priors);
  const WindowFit fit = optimize(window, kMaxIterations);
  Initialization out;
  out.mean_squared_error = mean_squared_error(fit);
  out.accepted = is_explained(window, priors, out.mean_squared_error);
  return out;
}

Initialization initialize_in_motion(Window& window, const RigidTransform& world_from_first,
                                    const InertialPriors& priors) {
  // the linearization point of the first frame moves
  constexpr int kMaxRounds = 15;
  constexpr int kIterations = 4;
  constexpr double kMinDecrease = 0.02;  // as in optimize()
  // the linear solution's is within a factor of two of it, or far above
  constexpr double kMaxLinearScaleSigma_ratio = 2 * kMaxScaleSigma_ratio;
  if (!align_rotations(window, priors)) return {};
  const auto alignment = align_linearly(window);
  if (!alignment) return {};
  set_states(*alignment, world_from_first, window);
  if (whole_window(window).tracks.size() < kMinPoints) return {};
  set_initial_prior(window, priors);
  if (!(scale_sigma_ratio(window) < kMaxLinearScaleSigma_ratio)) return {};
  WindowFit fit;
  double last_cost = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMaxRounds; ++round) {
    linearize_at_present(window);
    reject_outlier_points(window);
    set_initial_prior(window, priors);
    fit = optimize(window, kIterations);
    if (fit.iterations < kIterations || !(fit.cost < last_cost - kMinDecrease)) break;
    last_cost = fit.cost;
  }
  set_initial_prior(window, priors);
  Initialization out;
  out.mean_squared_error = mean_squared_error(fit);
  out.scale_sigma_ratio = scale_sigma_ratio(window);
  const bool is_observable = out.scale_sigma_ratio < kMaxScaleSigma_ratio;
  const bool explains = is_explained(window, priors, out.mean_squared_error);
  out.accepted = is_observable && explains;
  out.is_contradictory = is_observable && !explains;
  return out;
}

}  // namespace stillkite
