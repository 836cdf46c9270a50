#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "navigation/hover_pilot.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite::test {

/// The camera's way and turn from where it starts at rest to where the flight ends, in the axes of
/// the camera at the start; both grow with the square of time.
struct KnownMotion {
  const char* name;
  Eigen::Vector3d way_in_reference_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_in_reference_rad = Eigen::Vector3d::Zero();
};

/// A short flight over flat ground, 3 m high, by a camera that looks ahead and down: no axis of it
/// is one of the world's.
class KnownFlight {
 public:
  static constexpr int kFrames = 21;
  static constexpr double kFramesPerSecond = 30;
  static constexpr double kHeight_m = 3;
  static constexpr double kForwardTilt_deg = 35;

  /// `seed`: over which piece of ground, and with which noise.
  explicit KnownFlight(const KnownMotion& motion, std::uint64_t seed = 1)
      : motion_(motion), seed_(seed) {}

  [[nodiscard]] static RigidTransform mount() { return camera_raised_forward(kForwardTilt_deg); }

  [[nodiscard]] RigidTransform world_from_body_at_start() const {
    const auto piece = static_cast<double>(seed_);
    return {so3_exp({0, 0, 0.4 * piece}), {0.7 * piece, -1.3 * piece, kHeight_m}};
  }

  [[nodiscard]] RigidTransform reference_from_camera(int frame) const {
    const double share = std::pow(static_cast<double>(frame) / (kFrames - 1), 2);
    return {so3_exp(share * motion_.turn_in_reference_rad), share * motion_.way_in_reference_m};
  }

  /// The mean over the interval that ends with the frame, in the camera half way.
  [[nodiscard]] Twist mean_twist_in_camera(int frame) const {
    const RigidTransform before = reference_from_camera(frame - 1);
    const RigidTransform now = reference_from_camera(frame);
    const Eigen::Quaterniond half_way = interpolate(before, now, 0.5).rotation;
    return {.velocity_m_s =
                kFramesPerSecond * (half_way.conjugate() * (now.translation - before.translation)),
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
  // 1.25 texels a pixel straight below
  [[nodiscard]] static const Scene& scene() {
    static const Scene made{
        .ground = std::make_shared<GroundTexture>(procedural_ground(1200, 900, 1), 0.01),
        .relief = nullptr,
        .vehicle = nullptr};
    return made;
  }

  KnownMotion motion_;
  std::uint64_t seed_;
};

/// Images in, and out what the controller is told, by the way that HoverPilot takes.
class ContractEstimator {
 public:
  ContractEstimator(Policy policy, const RigidTransform& world_from_body_at_start,
                    const NavigatorConfig& config = {})
      : navigator_(
            small_camera(), KnownFlight::mount(), config,
            {.world_from_body = world_from_body_at_start, .scale = ScaleSource::initial_height},
            {.policy = policy}) {}

  MotionEstimate step(const Frame& frame) {
    const NavigationEstimate estimate = navigator_.step(frame);
    if (!start_covariance_) start_covariance_ = estimate.pose_covariance;
    return motion_estimate(estimate, *start_covariance_, KnownFlight::mount());
  }

 private:
  Navigator navigator_;
  std::optional<Matrix6d> start_covariance_;
};

}  // namespace stillkite::test
