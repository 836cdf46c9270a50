#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "navigation/hover_pilot.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/develop.hpp"
#include "simulation/procedural_ground.hpp"
#include "simulation/random.hpp"
#include "simulation/renderer.hpp"
#include "small_camera.hpp"

namespace stillkite::test {

/// The camera's way and turn from where it starts at rest to where the flight ends, in the axes of
/// the camera at the start; both grow with the square of time.
struct KnownMotion {
  const char* name;
  Eigen::Vector3d way_in_reference_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_in_reference_rad = Eigen::Vector3d::Zero();
};

/// Something flat that slides along y over the ground and hides the lower 40 % of the picture.
struct SlidingCover {
  double speed_m_s = 0.6;
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

  [[nodiscard]] Frame frame(int index, const std::optional<SlidingCover>& cover = {}) const {
    static const Renderer renderer(small_camera(), 2);
    const RigidTransform world_from_camera =
        world_from_body_at_start() * mount() * reference_from_camera(index);
    const cv::Mat light = renderer.render(scene(), world_from_camera, placed(cover, index));
    return framed(develop(light, {.noise_grey = 1.5}, seed_ * kFrames + index), index);
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
        .vehicle = std::make_shared<GroundTexture>(procedural_ground(700, 1200, 2), 0.01)};
    return made;
  }

  // Its front edge is 1.68 m ahead of the start, seen 5.8 degrees below the optical axis: 60 % down
  // the picture.
  [[nodiscard]] std::optional<VehiclePlacement> placed(const std::optional<SlidingCover>& cover,
                                                       int index) const {
    if (!cover) return {};
    constexpr double kFrontEdge_m = 1.68;
    constexpr double kLength_m = 7;
    constexpr double kWidth_m = 12;
    const RigidTransform start = world_from_body_at_start();
    const Eigen::Vector3d centre =
        start * Eigen::Vector3d(kFrontEdge_m - kLength_m / 2,
                                cover->speed_m_s * index / kFramesPerSecond, 0);
    const Eigen::Vector3d ahead = start.rotation * Eigen::Vector3d::UnitX();
    return VehiclePlacement{.centre_in_world_m = centre.head<2>(),
                            .heading_rad = std::atan2(ahead.y(), ahead.x()),
                            .length_m = kLength_m,
                            .width_m = kWidth_m};
  }

  KnownMotion motion_;
  std::uint64_t seed_;
};

/// Pictures in, and out what the controller is told, by the way that HoverPilot takes.
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
    if (!first_) first_ = estimate;
    return motion_estimate(estimate, *first_, KnownFlight::mount());
  }

 private:
  Navigator navigator_;
  std::optional<NavigationEstimate> first_;
};

}  // namespace stillkite::test
