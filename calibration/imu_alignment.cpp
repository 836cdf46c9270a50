#include "calibration/imu_alignment.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>

#include "estimation/robust_kernel.hpp"
#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr std::size_t kMinRotatedPairs = 15;
constexpr const char* kRotate =
    "rotate the camera for ten seconds about all three axes, by 20 deg/s and more, in view of a "
    "textured scene";

// Rotation vector of the camera between two images.
struct ObservedPair {
  const ImagePair* pair;
  Eigen::Vector3d rotation_rad;
};

std::vector<ObservedPair> observed_rotations(std::span<const ImagePair> pairs) {
  std::vector<ObservedPair> observed;
  for (const ImagePair& pair : pairs) {
    const auto rotation = epipolar_rotation(pair.matches, Eigen::Quaterniond::Identity());
    if (rotation) observed.push_back({&pair, so3_log(*rotation)});
  }
  return observed;
}

// Rotation vectors of the camera and, with an offset, of the gyroscope, less their means.
struct RotationFit {
  Eigen::Matrix3d imu_from_camera = Eigen::Matrix3d::Identity();
  double proper_error = 2;  // relative to the sum of both squared rotations; 2: nothing agrees
  double mirrored_error = 2;
};

std::optional<RotationFit> fit_rotation(std::span<const ObservedPair> observed,
                                        const GyroReadings& gyro, double offset_s) {
  std::vector<Eigen::Vector3d> camera, imu;
  Eigen::Vector3d camera_mean = Eigen::Vector3d::Zero(), imu_mean = camera_mean;
  for (const ObservedPair& one : observed) {
    const auto measured =
        gyro.between(one.pair->from, one.pair->to, offset_s, Eigen::Vector3d::Zero());
    if (!measured) continue;
    camera.push_back(one.rotation_rad);
    imu.push_back(so3_log(Eigen::Quaterniond(measured->rotation)));
    camera_mean += camera.back();
    imu_mean += imu.back();
  }
  if (camera.size() < kMinRotatedPairs) return std::nullopt;
  camera_mean /= static_cast<double>(camera.size());
  imu_mean /= static_cast<double>(camera.size());
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  double energy = 0;
  for (std::size_t i = 0; i < camera.size(); ++i) {
    const Eigen::Vector3d c = camera[i] - camera_mean, g = imu[i] - imu_mean;
    M += g * c.transpose();
    energy += c.squaredNorm() + g.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() > 0 ? 1 : -1;
  RotationFit fit;
  fit.imu_from_camera =
      svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  fit.proper_error = 2 - 4 * (s(0) + s(1) + sign * s(2)) / std::max(energy, 1e-30);
  fit.mirrored_error = 2 - 4 * (s(0) + s(1) - sign * s(2)) / std::max(energy, 1e-30);
  return fit;
}

struct InitialAlignment {
  Eigen::Matrix3d imu_from_camera;
  double offset_s;
};

InitialAlignment initial_alignment(std::span<const ObservedPair> observed, const GyroReadings& gyro,
                                   double max_offset_s) {
  constexpr double kStep_s = 0.005;
  constexpr double kMaxError = 0.5;        // of 2: a quarter of the rotation is unexplained
  constexpr double kMirroredRatio = 0.25;  // the mirrored axes explain that much better
  InitialAlignment best{Eigen::Matrix3d::Identity(), 0};
  double proper = HUGE_VAL, mirrored = HUGE_VAL;
  const int steps = static_cast<int>(std::ceil(max_offset_s / kStep_s));
  for (int i = -steps; i <= steps; ++i) {
    const auto fit = fit_rotation(observed, gyro, i * kStep_s);
    if (!fit) continue;
    mirrored = std::min(mirrored, fit->mirrored_error);
    if (fit->proper_error >= proper) continue;
    proper = fit->proper_error;
    best = {fit->imu_from_camera, i * kStep_s};
  }
  if (proper == HUGE_VAL) {
    throw InputError(
        "imu.path: the log does not cover the rotations in the images; check "
        "imu.time_offset_s and the log's stamps");
  }
  if (mirrored < kMaxError && mirrored < kMirroredRatio * proper) {
    throw InputError(
        "imu.path: the angular rates agree with the images only with mirrored axes: one axis has "
        "the wrong sign, or two are exchanged; give the readings in right-handed axes");
  }
  if (proper > kMaxError) {
    throw InputError(fmt::format(
        "imu.path: gyroscope and images disagree: no rotation and clock offset up to {:.1f} s "
        "explains three quarters of the image rotation; check unit (rad/s), axes and clock",
        max_offset_s));
  }
  return best;
}

// State of the Gauss-Newton iterations.
struct AlignmentState {
  Eigen::Quaterniond imu_from_camera;
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();
  double offset_s = 0;
  double focal_ratio = 1;

  void add(const Vector8d& step) {
    imu_from_camera = (so3_exp(step.head<3>()) * imu_from_camera).normalized();
    bias_rad_s += step.segment<3>(3);
    offset_s += step(6);
    focal_ratio *= std::exp(step(7));
  }
};

std::vector<BearingMatch> scaled_matches(const ImagePair& pair, double focal_ratio) {
  std::vector<BearingMatch> scaled = pair.matches;
  for (BearingMatch& match : scaled) {
    match.first.head<2>() /= focal_ratio;
    match.second.head<2>() /= focal_ratio;
    match.variance /= focal_ratio * focal_ratio;
  }
  return scaled;
}

struct PairEquation {
  Eigen::Matrix3d W;              // information of the residual
  Eigen::Vector3d W_e;            // times the residual: rotation error in the second camera's axes
  Eigen::Matrix<double, 3, 8> J;  // of the prediction
  double squared_error = 0;       // e' W e
};

// With the image information H and the gyroscope's noise Q: W = (H^-1 + Q)^-1 = (I + H Q)^-1 H.
std::optional<PairEquation> pair_equation(const ImagePair& pair, const GyroReadings& gyro,
                                          const AlignmentState& state,
                                          const ImuAlignmentOptions& options, bool is_robust) {
  constexpr double kFocalStep = 1e-4;
  const auto measured = gyro.between(pair.from, pair.to, state.offset_s, state.bias_rad_s);
  if (!measured) return std::nullopt;
  const Eigen::Matrix3d camera_from_imu = state.imu_from_camera.toRotationMatrix().transpose();
  const Eigen::Matrix3d predicted =
      camera_from_imu * measured->rotation * camera_from_imu.transpose();
  const auto equations = [&](double focal_ratio) {
    return epipolar_equations(
        options.estimate_focal ? scaled_matches(pair, focal_ratio) : pair.matches, predicted,
        is_robust);
  };
  const RotationEquations images = equations(state.focal_ratio);
  const double Q =
      options.gyro_density * options.gyro_density * seconds_between(pair.from, pair.to);
  const Eigen::Matrix3d damping = (Eigen::Matrix3d::Identity() + Q * images.H).inverse();
  PairEquation out;
  out.W = damping * images.H;
  out.W_e = damping * images.g;
  out.J.leftCols<3>() =
      camera_from_imu * (Eigen::Matrix3d::Identity() - measured->rotation.transpose());
  out.J.middleCols<3>(3) = camera_from_imu * measured->by_bias;
  out.J.col(6) = camera_from_imu * measured->by_offset;
  out.J.col(7).setZero();
  const Eigen::LDLT<Eigen::Matrix3d> H(images.H);
  const Eigen::Vector3d e = H.solve(images.g);
  if (!e.allFinite()) return std::nullopt;
  out.squared_error = e.dot(out.W_e);
  if (options.estimate_focal) {
    const auto rotation_at = [&](double factor) -> Eigen::Vector3d {
      const RotationEquations at = equations(state.focal_ratio * factor);
      return at.H.ldlt().solve(at.g);
    };
    // the residual of larger bearings, not of another prediction: opposite sign
    out.J.col(7) = -(rotation_at(1 + kFocalStep) - rotation_at(1 - kFocalStep)) / (2 * kFocalStep);
  }
  return out;
}

struct NormalEquations {
  Matrix8d H = Matrix8d::Zero();
  Vector8d g = Vector8d::Zero();
  double squared_error = 0;
  int pairs = 0;
};

NormalEquations normal_equations(std::span<const ImagePair> pairs, const GyroReadings& gyro,
                                 const AlignmentState& state, const ImuAlignmentOptions& options,
                                 bool is_robust) {
  NormalEquations out;
  for (const ImagePair& pair : pairs) {
    const auto equation = pair_equation(pair, gyro, state, options, is_robust);
    if (!equation) continue;
    // of three components
    const double weight =
        is_robust ? robust_weight(RobustKernel::huber, equation->squared_error / 3).weight : 1;
    out.H += weight * equation->J.transpose() * equation->W * equation->J;
    out.g += weight * equation->J.transpose() * equation->W_e;
    out.squared_error += weight * equation->squared_error;
    ++out.pairs;
  }
  if (!options.estimate_focal) out.H(7, 7) = 1;
  return out;
}

void check_alignment(const ImuAlignment& alignment, const ImuAlignmentOptions& options) {
  constexpr double kMaxRotationSigma_deg = 3, kMaxOffsetSigma_s = 0.02, kMaxFocalSigma = 0.2;
  const Vector8d sigmas = alignment.covariance.diagonal().cwiseSqrt();
  const double rotation_deg = sigmas.head<3>().maxCoeff() / kDegree;
  if (!(rotation_deg <= kMaxRotationSigma_deg) || !(sigmas(6) <= kMaxOffsetSigma_s) ||
      !(sigmas(7) <= kMaxFocalSigma) ||
      !(std::abs(alignment.time_offset_s) <= options.max_offset_s)) {
    throw InputError(
        fmt::format("imu.path: the images rotate too little to align the IMU: sigma of the "
                    "rotation {:.1f} deg, "
                    "of the clock {:.0f} ms; {}",
                    rotation_deg, 1e3 * sigmas(6), kRotate));
  }
}

}  // namespace

ImuAlignment align_imu(std::span<const ImagePair> pairs, const GyroReadings& gyro,
                       const ImuAlignmentOptions& options) {
  constexpr int kLeastSquares = 4;  // iterations before the robust ones
  constexpr int kMaxIterations = 30;
  constexpr double kMinStep = 1e-7;
  const std::vector<ObservedPair> observed = observed_rotations(pairs);
  if (observed.size() < kMinRotatedPairs) {
    throw InputError(
        fmt::format("source.path: {} pairs of images rotate measurably, at least {} "
                    "are needed; {}",
                    observed.size(), kMinRotatedPairs, kRotate));
  }
  const InitialAlignment initial = initial_alignment(observed, gyro, options.max_offset_s);
  AlignmentState state{.imu_from_camera = Eigen::Quaterniond(initial.imu_from_camera),
                       .offset_s = initial.offset_s};
  NormalEquations equations;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    equations = normal_equations(pairs, gyro, state, options, iteration >= kLeastSquares);
    const Vector8d step = equations.H.ldlt().solve(equations.g);
    if (!step.allFinite()) break;
    state.add(step);
    if (iteration > kLeastSquares && step.norm() < kMinStep) break;
  }
  ImuAlignment out{.imu_from_camera = state.imu_from_camera,
                   .gyro_bias_rad_s = state.bias_rad_s,
                   .time_offset_s = state.offset_s,
                   .focal_ratio = state.focal_ratio,
                   .pairs = equations.pairs};
  const double freedom = 3.0 * equations.pairs - (options.estimate_focal ? 8 : 7);
  out.unit_variance = equations.squared_error / std::max(1.0, freedom);
  out.covariance =
      std::max(1.0, out.unit_variance) * equations.H.ldlt().solve(Matrix8d::Identity());
  if (!options.estimate_focal) out.covariance(7, 7) = 0;
  check_alignment(out, options);
  return out;
}

}  // namespace stillkite
