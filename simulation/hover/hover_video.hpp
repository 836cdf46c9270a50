#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "flow/frame.hpp"
#include "simulation/hover/fault.hpp"
#include "simulation/hover/hover_plant.hpp"
#include "simulation/hover/hover_world.hpp"
#include "simulation/scene/moving_objects.hpp"

namespace stillkite {

/// Transmitted image with IMU attitude and ground truth at its exposure.
struct SentImage {
  Timestamp due;  ///< time at which its command takes effect
  Frame frame;
  Eigen::Quaterniond attitude;  ///< estimate of the IMU
  DroneTruth truth;
};

/// Camera of the drone and video link to the ground.
class HoverVideo {
 public:
  /// `config` and `world` must outlive it.
  HoverVideo(const HoverConfig& config, const HoverWorld& world, const Trial& trial);

  /// Call once per step. Returns whether the camera exposes a frame now. A frame is rendered and
  /// transmitted only if the estimator processes it.
  bool expose(const DroneTruth& truth, const Eigen::Quaterniond& attitude, Timestamp now,
              const FaultEffect& fault);

  /// Removes and returns the next image that is due; nullopt without one.
  [[nodiscard]] std::optional<SentImage> receive(Timestamp now);

 private:
  [[nodiscard]] cv::Mat irradiance(const DroneTruth& truth, Timestamp now,
                                   const FaultEffect& fault) const;
  [[nodiscard]] double gain(Timestamp now) const;
  [[nodiscard]] cv::Mat image(const DroneTruth& truth, Timestamp now,
                              const FaultEffect& fault) const;

  const HoverConfig& config_;
  const HoverWorld& world_;
  double duration_s_;
  bool is_transmitting_;
  std::uint64_t noise_seed_;
  std::vector<MovingObject> moving_objects_;
  std::deque<SentImage> pending_;
  std::int64_t frames_ = 0;
  std::int64_t transmissions_ = 0;
  cv::Mat last_;
};

}  // namespace stillkite
