#include "estimation/sliding_window/initialization.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/window_solver.hpp"
#include "geometry/gravity.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

using Row3 = Eigen::RowVector3d;

struct BearingMatch {
  Eigen::Vector3d first, second;
  double variance;  // of one component
};

// Two frames with the rotation between them.
struct RotatedPair {
  ImuPreintegration imu;
  std::vector<BearingMatch> matches;
};

std::vector<RotatedPair> rotated_pairs(const Window& window) {
  constexpr std::size_t kStrides[] = {1, 3};
  constexpr std::size_t kMinMatches = 12;
  std::vector<RotatedPair> pairs;
  for (const std::size_t stride : kStrides) {
    for (std::size_t end = stride; end < window.frames.size(); ++end) {
      RotatedPair pair{ImuPreintegration(window.frames[end].imu.noise()), {}};
      for (std::size_t i = end - stride + 1; i <= end; ++i) pair.imu.append(window.frames[i].imu);
      const std::int64_t first_id = window.frames[end - stride].id;
      const std::int64_t second_id = window.frames[end].id;
      for (const WindowTrack& track : window.tracks) {
        const WindowObservation* first = nullptr;
        const WindowObservation* second = nullptr;
        for (const WindowObservation& observation : track.observations) {
          if (observation.frame_id == first_id) first = &observation;
          if (observation.frame_id == second_id) second = &observation;
        }
        if (first == nullptr || second == nullptr) continue;
        pair.matches.push_back({first->bearing.homogeneous(), second->bearing.homogeneous(),
                                0.25 * (first->covariance + second->covariance).trace()});
      }
      if (pair.matches.size() >= kMinMatches) pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

struct BiasEquations {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
};

// Adds a pair's epipolar residuals t . (a x R b); its translation direction t is eliminated.
void add_pair(RotatedPair& pair, const Eigen::Quaterniond& imu_from_camera,
              const Eigen::Vector3d& bias, bool is_robust, BiasEquations& out) {
  pair.imu.reintegrate(bias, Eigen::Vector3d::Zero());
  const Eigen::Matrix3d R_e = imu_from_camera.toRotationMatrix();
  const Eigen::Matrix3d camera_from_imu =
      R_e.transpose() * pair.imu.motion(bias, Eigen::Vector3d::Zero()).rotation.toRotationMatrix();
  const Eigen::Matrix3d by_bias = pair.imu.bias_jacobian().topLeftCorner<3, 3>();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const BearingMatch& match : pair.matches) {
    const Eigen::Vector3d n = match.first.cross(camera_from_imu * (R_e * match.second));
    moment += n * n.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moment);
  const Eigen::Vector3d t = eigen.eigenvectors().col(0);
  const Eigen::Matrix<double, 3, 2> tangent = eigen.eigenvectors().rightCols<2>();
  Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 3, 2> C = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Vector2d d = Eigen::Vector2d::Zero();
  for (const BearingMatch& match : pair.matches) {
    constexpr double kMinLever2 = 0.01;  // a bearing along the translation constrains nothing
    const Eigen::Vector3d second = R_e * match.second;
    const Eigen::Vector3d n = match.first.cross(camera_from_imu * second);
    const Eigen::Vector3d line = t.cross(match.first);
    const double variance = 2 * match.variance * std::max(kMinLever2, line.squaredNorm());
    const double r = t.dot(n);
    const Row3 J = -line.transpose() * camera_from_imu * skew(second) * by_bias;
    const Eigen::RowVector2d K = n.transpose() * tangent;
    const double weight =
        (is_robust ? robust_weight(RobustKernel::geman_mcclure, r * r / variance).weight : 1) /
        variance;
    out.H += weight * J.transpose() * J;
    out.g -= weight * r * J.transpose();
    C += weight * J.transpose() * K;
    D += weight * K.transpose() * K;
    d -= weight * r * K.transpose();
  }
  D.diagonal().array() += 1e-9 * D.trace() + 1e-9;
  const Eigen::Matrix<double, 3, 2> C_inverse = C * D.inverse();
  out.H -= C_inverse * C.transpose();
  out.g -= C_inverse * d;
}

// Poses of the IMU in the first frame's axes without velocity and gravity.
struct Integrated {
  double t_s = 0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

std::vector<Integrated> integrate(const Window& window, const Eigen::Vector3d& gyro_bias) {
  std::vector<Integrated> out(1);
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    ImuPreintegration imu = window.frames[i].imu;
    imu.reintegrate(gyro_bias, Eigen::Vector3d::Zero());
    const auto motion = imu.motion(gyro_bias, Eigen::Vector3d::Zero());
    const Integrated& from = out.back();
    const double dt = imu.duration_s();
    out.push_back({from.t_s + dt, (from.rotation * motion.rotation).normalized(),
                   from.velocity + from.rotation * motion.velocity,
                   from.position + dt * from.velocity + from.rotation * motion.position});
  }
  return out;
}

using Matrix66 = Eigen::Matrix<double, 6, 6>;

// Equations of one track in (velocity, gravity) and its depth.
struct TrackEquations {
  Matrix66 H = Matrix66::Zero();
  Vector6d g = Vector6d::Zero();
  Vector6d by_depth = Vector6d::Zero();
  double depth_information = 0;
  double depth_gradient = 0;
};

TrackEquations track_equations(const Window& window, const WindowTrack& track,
                               const std::vector<Integrated>& frames,
                               const std::optional<double>& depth_m, const Vector6d& solution) {
  const RigidTransform& imu_from_camera = window.extrinsics.imu_from_camera;
  TrackEquations out;
  const Integrated& host = frames[*window.find(track.observations.front().frame_id)];
  const Eigen::Vector3d along =
      host.rotation * (imu_from_camera.rotation * track.observations.front().bearing.homogeneous());
  const Eigen::Vector3d host_camera = host.position + host.rotation * imu_from_camera.translation;
  for (std::size_t i = 1; i < track.observations.size(); ++i) {
    const WindowObservation& observation = track.observations[i];
    const Integrated& frame = frames[*window.find(observation.frame_id)];
    Eigen::Matrix<double, 2, 3> line;
    line << 1, 0, -observation.bearing.x(), 0, 1, -observation.bearing.y();
    const Eigen::Matrix3d camera_from_first =
        (frame.rotation * imu_from_camera.rotation).conjugate().toRotationMatrix();
    line = line * camera_from_first;
    const Eigen::Vector3d known =
        host_camera - frame.position - frame.rotation * imu_from_camera.translation;
    Eigen::Matrix<double, 2, 6> A;
    A << (host.t_s - frame.t_s) * line, 0.5 * (host.t_s * host.t_s - frame.t_s * frame.t_s) * line;
    const Eigen::Vector2d by_depth = line * along;
    const Eigen::Vector2d constant = line * known;
    double weight = 1 / (0.5 * observation.covariance.trace());
    if (depth_m) {
      // residuals on z = 1: over the point's depth in this camera
      Eigen::Matrix<double, 3, 6> shift;
      shift << (host.t_s - frame.t_s) * Eigen::Matrix3d::Identity(),
          0.5 * (host.t_s * host.t_s - frame.t_s * frame.t_s) * Eigen::Matrix3d::Identity();
      const double z = (camera_from_first * (known + shift * solution + *depth_m * along)).z();
      constexpr double kMinDepth_m = 0.05;
      if (!(z > kMinDepth_m)) continue;
      weight /= z * z;
      const double squared = weight * (A * solution + by_depth * *depth_m + constant).squaredNorm();
      weight *= robust_weight(RobustKernel::huber, squared).weight;
    }
    out.H += weight * A.transpose() * A;
    out.g -= weight * A.transpose() * constant;
    out.by_depth += weight * A.transpose() * by_depth;
    out.depth_information += weight * by_depth.squaredNorm();
    out.depth_gradient -= weight * by_depth.dot(constant);
  }
  return out;
}

// (velocity, gravity) with gravity's known length: minimum of x^T H x - 2 g^T x on the sphere.
std::optional<Vector6d> solve_on_sphere(const Matrix66& H, const Vector6d& g) {
  const Eigen::LDLT<Eigen::Matrix3d> velocity(H.topLeftCorner<3, 3>());
  const Eigen::Matrix3d cross = H.topRightCorner<3, 3>();
  const Eigen::Matrix3d reduced =
      H.bottomRightCorner<3, 3>() - cross.transpose() * velocity.solve(cross);
  const Eigen::Vector3d right = g.tail<3>() - cross.transpose() * velocity.solve(g.head<3>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(reduced);
  const Eigen::Vector3d in_axes = eigen.eigenvectors().transpose() * right;
  const Eigen::Vector3d values = eigen.eigenvalues();
  if (!(values(2) > 0) || !in_axes.allFinite()) return std::nullopt;
  const auto length = [&](double multiplier) {
    return (in_axes.array() / (values.array() + multiplier)).matrix().norm();
  };
  double low = -values(0) * (1 - 1e-12);
  double high = low + in_axes.norm() / kGravity_m_s2 + values(2);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (length(middle) > kGravity_m_s2 ? low : high) = middle;
  }
  const double multiplier = 0.5 * (low + high);
  Vector6d x;
  x.tail<3>() = eigen.eigenvectors() * (in_axes.array() / (values.array() + multiplier)).matrix();
  x.head<3>() = velocity.solve(g.head<3>() - cross * x.tail<3>());
  if (!x.allFinite()) return std::nullopt;
  x.tail<3>() *= kGravity_m_s2 / x.tail<3>().norm();
  return x;
}

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

void set_states(const LinearAlignment& alignment, const Eigen::Vector3d& gyro_bias,
                const RigidTransform& world_from_first, Window& window) {
  const Eigen::Quaterniond& prior = world_from_first.rotation;
  const Eigen::Quaterniond rotation =
      rotation_between(prior * -alignment.gravity, Eigen::Vector3d::UnitZ()) * prior;
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    frame.first_estimate.reset();
    const RigidTransform& pose = alignment.first_from_imu[i];
    frame.state = {.world_from_imu = {(rotation * pose.rotation).normalized(),
                                      world_from_first.translation + rotation * pose.translation},
                   .velocity_in_world_m_s = rotation * alignment.velocities[i],
                   .gyro_bias_rad_s = gyro_bias,
                   .accel_bias_m_s2 = Eigen::Vector3d::Zero()};
    frame.imu.reintegrate(gyro_bias, Eigen::Vector3d::Zero());
  }
  for (std::size_t i = 0; i < window.tracks.size(); ++i) {
    window.tracks[i].point.reset();
    const std::optional<double>& depth_m = alignment.depths_m[i];
    if (!depth_m || !(*depth_m > 0)) continue;
    window.tracks[i].point =
        InverseDepthPoint{window.tracks[i].observations.front().bearing, 1 / *depth_m};
  }
}

}  // namespace

std::optional<Eigen::Vector3d> gyro_bias_from_images(const Window& window,
                                                     double prior_sigma_rad_s) {
  constexpr std::size_t kMinPairs = 3;
  constexpr int kIterations = 8;
  std::vector<RotatedPair> pairs = rotated_pairs(window);
  if (pairs.size() < kMinPairs) return std::nullopt;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    BiasEquations equations;
    equations.H.diagonal().setConstant(1 / (prior_sigma_rad_s * prior_sigma_rad_s));
    equations.g = -equations.H * bias;
    for (RotatedPair& pair : pairs) {
      add_pair(pair, window.extrinsics.imu_from_camera.rotation, bias, iteration > 2, equations);
    }
    const Eigen::Vector3d step = equations.H.ldlt().solve(equations.g);
    if (!step.allFinite()) return std::nullopt;
    bias += step;
  }
  return bias;
}

std::optional<LinearAlignment> align_linearly(const Window& window,
                                              const Eigen::Vector3d& gyro_bias) {
  constexpr int kIterations = 4;  // with the weights of the depths before
  const std::vector<Integrated> frames = integrate(window, gyro_bias);
  LinearAlignment out;
  out.depths_m.resize(window.tracks.size());
  Vector6d solution = Vector6d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<TrackEquations> equations(window.tracks.size());
    Matrix66 H = Matrix66::Zero();
    Vector6d g = Vector6d::Zero();
    for (std::size_t i = 0; i < window.tracks.size(); ++i) {
      const WindowTrack& track = window.tracks[i];
      if (track.observations.size() < 3) continue;
      if (iteration > 0 && !(out.depths_m[i].value_or(-1) > 0)) continue;
      TrackEquations& of = equations[i];
      of = track_equations(window, track, frames, out.depths_m[i], solution);
      if (!(of.depth_information > 0)) continue;
      H += of.H - of.by_depth * of.by_depth.transpose() / of.depth_information;
      g += of.g - of.by_depth * of.depth_gradient / of.depth_information;
    }
    const std::optional<Vector6d> solved = solve_on_sphere(H, g);
    if (!solved) return std::nullopt;
    solution = *solved;
    for (std::size_t i = 0; i < equations.size(); ++i) {
      const TrackEquations& of = equations[i];
      if (!(of.depth_information > 0)) continue;
      out.depths_m[i] = (of.depth_gradient - of.by_depth.dot(solution)) / of.depth_information;
    }
  }
  out.velocity = solution.head<3>();
  out.gravity = solution.tail<3>();
  for (const Integrated& frame : frames) {
    out.first_from_imu.push_back({frame.rotation, frame.position + frame.t_s * out.velocity +
                                                      0.5 * frame.t_s * frame.t_s * out.gravity});
    out.velocities.push_back(out.velocity + frame.t_s * out.gravity + frame.velocity);
  }
  return out;
}

double scale_sigma_ratio(const Window& window) {
  const std::optional<Eigen::MatrixXd> covariance = window_covariance(window);
  if (!covariance) return std::numeric_limits<double>::infinity();
  const std::vector<int> offsets = window.offsets();
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(covariance->rows());
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    direction.segment<3>(offsets[i] + InertialIndex::kPosition) =
        window.frames[i].state.world_from_imu.translation -
        window.frames.front().state.world_from_imu.translation;
  }
  const double squared = direction.squaredNorm();
  return std::sqrt(direction.dot(*covariance * direction)) / squared;
}

void set_initial_prior(Window& window, const InertialPriors& priors) {
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
  WindowFrame& first = window.frames.front();
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
}

void RestReadings::add(const ImuSample& sample) {
  if (sample.is_gap) return;
  duration_s += sample.dt_s;
  const double share = sample.dt_s / duration_s;
  angular_rate_rad_s += share * (sample.angular_rate_rad_s - angular_rate_rad_s);
  specific_force_m_s2 += share * (sample.specific_force_m_s2 - specific_force_m_s2);
}

void initialize_at_rest(Window& window, const RestReadings& readings, double velocity_sigma_m_s,
                        const InertialPriors& priors) {
  WindowFrame& frame = window.frames.front();
  const ImuNoise& noise = frame.imu.noise();
  const Eigen::Quaterniond before = frame.state.world_from_imu.rotation;
  const Eigen::Quaterniond to_vertical =
      rotation_between(before * readings.specific_force_m_s2, Eigen::Vector3d::UnitZ());
  frame.state.world_from_imu.rotation = (to_vertical * before).normalized();
  frame.state.velocity_in_world_m_s.setZero();
  frame.state.gyro_bias_rad_s = readings.angular_rate_rad_s;
  frame.state.accel_bias_m_s2.setZero();
  set_initial_prior(window, priors);
  // measurements with zero residual, but for the bias prior's and the length of gravity
  Eigen::MatrixXd& H = window.prior.information;
  Eigen::VectorXd& g = window.prior.gradient;
  const int at = window.offsets().front();
  const auto diagonal = [&](int first) { return H.diagonal().segment<3>(at + first).array(); };
  diagonal(InertialIndex::kVelocity) += 1 / (velocity_sigma_m_s * velocity_sigma_m_s);
  diagonal(InertialIndex::kGyroBias) +=
      readings.duration_s / (noise.gyro_density * noise.gyro_density);
  const double force_information =
      readings.duration_s / (noise.accel_density * noise.accel_density);
  const Eigen::Vector3d expected =
      frame.state.world_from_imu.rotation.conjugate() * -gravity_in_world();
  Eigen::Matrix<double, 3, InertialIndex::kSize> J =
      Eigen::Matrix<double, 3, InertialIndex::kSize>::Zero();
  J.middleCols<3>(InertialIndex::kRotation) = skew(expected);
  J.middleCols<3>(InertialIndex::kAccelBias).setIdentity();
  H.block<InertialIndex::kSize, InertialIndex::kSize>(at, at) +=
      force_information * J.transpose() * J;
  g.segment<InertialIndex::kSize>(at) +=
      force_information * J.transpose() * (readings.specific_force_m_s2 - expected);
}

Initialization initialize_in_motion(Window& window, const RigidTransform& world_from_first,
                                    const InertialPriors& priors) {
  constexpr int kRounds = 3;  // the linearization point of the first frame moves
  constexpr int kIterations = 20;
  constexpr double kMaxScaleSigma_ratio = 0.1;
  constexpr double kMaxMeanSquaredError = 8;
  constexpr double kMaxDecrement = 0.5;     // one standard deviation from the minimum
  constexpr double kMaxBiasSigmas2 = 11.3;  // 99 %, three degrees of freedom
  constexpr std::size_t kMinPoints = 12;
  const auto bias = gyro_bias_from_images(window, priors.gyro_bias_rad_s);
  if (!bias) return {};
  const auto alignment = align_linearly(window, *bias);
  if (!alignment) return {};
  set_states(*alignment, *bias, world_from_first, window);
  if (whole_window(window).tracks.size() < kMinPoints) return {};
  WindowFit fit;
  for (int round = 0; round < kRounds; ++round) {
    reject_outlier_points(window);
    set_initial_prior(window, priors);
    fit = optimize(window, kIterations);
    for (WindowFrame& frame : window.frames) {
      frame.imu.reintegrate(frame.state.gyro_bias_rad_s, frame.state.accel_bias_m_s2);
    }
  }
  set_initial_prior(window, priors);
  Initialization out;
  out.mean_squared_error = fit.observations > 0 ? 2 * fit.reprojection / fit.observations : 1e9;
  out.scale_sigma_ratio = scale_sigma_ratio(window);
  const double bias_sigmas_2 =
      (window.frames.front().state.accel_bias_m_s2 / priors.accel_bias_m_s2).squaredNorm();
  out.accepted = newton_decrement(window) < kMaxDecrement &&
                 out.scale_sigma_ratio < kMaxScaleSigma_ratio &&
                 out.mean_squared_error < kMaxMeanSquaredError && bias_sigmas_2 < kMaxBiasSigmas2;
  return out;
}

}  // namespace stillkite
