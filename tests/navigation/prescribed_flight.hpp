#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "flow/frame.hpp"
#include "navigation/motion_conversion.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite::test {

/// Translation and rotation of the camera over the flight, in initial camera axes; both grow with
/// the square of time, from rest.
struct PrescribedMotion {
  const char* name;
  Eigen::Vector3d translation_in_reference_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_in_reference_rad = Eigen::Vector3d::Zero();
};

/// Short flight over flat ground at 3 m; the camera is tilted, so that no camera axis is parallel
/// to a world axis.
class PrescribedFlight {
 public:
  static constexpr int kFrames = 21;
  static constexpr double kFramesPerSecond = 30;
  static constexpr double kHeight_m = 3;
  static constexpr double kForwardTilt_deg = 35;

  /// `seed` selects the piece of ground and the image noise.
  explicit PrescribedFlight(const PrescribedMotion& motion, std::uint64_t seed = 1)
      : motion_(motion), seed_(seed) {}

  [[nodiscard]] static RigidTransform mount() { return camera_raised_forward(kForwardTilt_deg); }

  [[nodiscard]] RigidTransform world_from_body_at_start() const {
    const auto piece = static_cast<double>(seed_);
    return {so3_exp({0, 0, 0.4 * piece}), {0.7 * piece, -1.3 * piece, kHeight_m}};
  }

  [[nodiscard]] RigidTransform reference_from_camera(int frame) const {
    const double ratio = std::pow(static_cast<double>(frame) / (kFrames - 1), 2);
    return {so3_exp(ratio * motion_.rotation_in_reference_rad),
            ratio * motion_.translation_in_reference_m};
  }

  /// Mean over the interval that ends with the frame, in the camera axes at mid-interval.
  [[nodiscard]] Twist mean_twist_in_camera(int frame) const {
    const RigidTransform before = reference_from_camera(frame - 1);
    const RigidTransform now = reference_from_camera(frame);
    const Eigen::Quaterniond midpoint = interpolate(before, now, 0.5).rotation;
    return {.velocity_m_s =
                kFramesPerSecond * (midpoint.conjugate() * (now.translation - before.translation)),
            .angular_rate_rad_s =
                kFramesPerSecond * so3_log(before.rotation.conjugate() * now.rotation)};
  }

  [[nodiscard]] Frame frame(int index) const {
    static const Renderer renderer(small_camera(), 1);
    const RigidTransform world_from_camera =
        world_from_body_at_start() * mount() * reference_from_camera(index);
    return framed(develop(renderer.render(scene(), world_from_camera), {.noise_grey = 1.5},
                          seed_ * kFrames + static_cast<std::uint64_t>(index)),
                  index);
  }

  [[nodiscard]] static Frame framed(const cv::Mat& grey, int index) {
    return {.stamp = from_seconds(index / kFramesPerSecond), .index = index, .grey = grey};
  }

 private:
  // 1.25 texels per pixel at nadir
  [[nodiscard]] static const Scene& scene() {
    static const Scene made{
        .ground = std::make_shared<GroundTexture>(procedural_ground(1200, 900, 1), 0.01),
        .relief = nullptr,
        .vehicle = nullptr};
    return made;
  }

  PrescribedMotion motion_;
  std::uint64_t seed_;
};

/// Motion estimate for the controller from images, computed as in HoverPilot.
class ContractEstimator {
 public:
  ContractEstimator(Policy policy, const RigidTransform& world_from_body_at_start,
                    const NavigatorConfig& config = {})
      : navigator_(
            small_camera(), PrescribedFlight::mount(), config,
            {.world_from_body = world_from_body_at_start, .scale = ScaleSource::initial_height},
            {.policy = policy}) {}

  MotionEstimate step(const Frame& frame) {
    const NavigationEstimate estimate = navigator_.step(frame);
    if (!initial_covariance_) initial_covariance_ = estimate.pose_covariance;
    return motion_estimate(estimate, *initial_covariance_, PrescribedFlight::mount());
  }

 private:
  Navigator navigator_;
  std::optional<Matrix6d> initial_covariance_;
};

}  // namespace stillkite::test
