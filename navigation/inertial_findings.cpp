#include "navigation/inertial_findings.hpp"

#include <Eigen/Core>
#include <optional>

#include "estimation/sliding_window/window_solver.hpp"

namespace stillkite {
namespace {

constexpr double kFiveSigma = 25;  // one degree of freedom

// Differences that matter to a user.
constexpr double kMinTimeOffset_s = 0.005;
constexpr double kMinCameraRotation_rad = 0.02;
constexpr double kMinLeverArm_m = 0.02;

// Attempts of the initialization: a second at 15 per second.
constexpr int kMinContradictions = 15;

bool differs(const InertialFinding& finding, double min_change) {
  if (!(finding.change.norm() > min_change)) return false;
  return finding.change.cwiseQuotient(finding.sigma).squaredNorm() > kFiveSigma3;
}

// Extrinsics of an initialized window.
void add_extrinsics(const SlidingWindow& window, std::vector<InertialFinding>& out) {
  const std::optional<Eigen::MatrixXd> covariance = window_covariance(window.window());
  if (!covariance) return;
  const CameraExtrinsics& estimate = window.extrinsics();
  const ExtrinsicsError change = minus(estimate, window.window().calibrated);
  const ExtrinsicsError sigma = covariance->diagonal().head<ExtrinsicsIndex::kSize>().cwiseSqrt();
  const double offset_s = change(ExtrinsicsIndex::kTimeOffset);
  const double offset_sigma_s = sigma(ExtrinsicsIndex::kTimeOffset);
  const bool is_significant = offset_s * offset_s > kFiveSigma * offset_sigma_s * offset_sigma_s;
  if (std::abs(offset_s) > kMinTimeOffset_s && is_significant) {
    out.push_back({InertialFault::clock, offset_s * Eigen::Vector3d::UnitX(),
                   offset_s * Eigen::Vector3d::UnitX(), offset_sigma_s * Eigen::Vector3d::UnitX()});
  }
  const InertialFinding rotation{
      InertialFault::camera_rotation, so3_log(estimate.imu_from_camera.rotation),
      change.segment<3>(ExtrinsicsIndex::kRotation), sigma.segment<3>(ExtrinsicsIndex::kRotation)};
  if (differs(rotation, kMinCameraRotation_rad)) out.push_back(rotation);
  const InertialFinding lever_arm{InertialFault::lever_arm, estimate.imu_from_camera.translation,
                                  change.segment<3>(ExtrinsicsIndex::kLeverArm),
                                  sigma.segment<3>(ExtrinsicsIndex::kLeverArm)};
  if (differs(lever_arm, kMinLeverArm_m)) out.push_back(lever_arm);
}

}  // namespace

bool contradicts_prior(const InertialState& state, const InertialPriors& priors) {
  return accel_bias_deviation(state, priors) > kFiveSigma3;
}

std::optional<InertialFinding> prior_contradiction(const SlidingWindow& window) {
  if (!window.is_initialized()) return std::nullopt;
  const InertialPriors& priors = window.priors();
  if (contradicts_prior(window.state(), priors)) {
    const Eigen::Vector3d& bias_m_s2 = window.state().accel_bias_m_s2;
    const auto variance = window.covariance().diagonal().segment<3>(InertialIndex::kAccelBias);
    return InertialFinding{.fault = InertialFault::accelerometer,
                           .value = bias_m_s2,
                           .change = bias_m_s2,
                           .sigma = variance.cwiseSqrt()};
  }
  if (camera_rotation_deviation(window.window(), priors) > kFiveSigma3) {
    const CameraExtrinsics& estimate = window.extrinsics();
    return InertialFinding{
        .fault = InertialFault::axes,
        .value = so3_log(estimate.imu_from_camera.rotation),
        .change =
            minus(estimate, window.window().calibrated).segment<3>(ExtrinsicsIndex::kRotation),
        .sigma = Eigen::Vector3d::Constant(priors.camera_rotation_rad)};
  }
  return std::nullopt;
}

std::vector<InertialFinding> inertial_findings(const SlidingWindow& window) {
  std::vector<InertialFinding> out;
  if (window.is_initialized()) add_extrinsics(window, out);
  if (window.contradictions() >= kMinContradictions) {
    out.push_back({.fault = InertialFault::contradiction});
  }
  return out;
}

}  // namespace stillkite
