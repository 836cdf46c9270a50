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

/// An image on its way to a command, and how it was when it was exposed.
struct SentImage {
  Timestamp due;
  Frame frame;
  Eigen::Quaterniond attitude;  ///< as the IMU had it
  DroneTruth truth;
};

/// The drone's camera and the link to the ground.
class HoverVideo {
 public:
  /// `config` and `world` must outlive it.
  HoverVideo(const HoverConfig& config, const HoverWorld& world, const Trial& trial);

  /// To be called once a step. Whether the camera exposes an image now; it is sent where somebody
  /// looks at it.
  bool expose(const DroneTruth& truth, const Eigen::Quaterniond& attitude, Timestamp now,
              const FaultEffect& fault);

  /// The next one, once the command that it leads to can go out.
  [[nodiscard]] std::optional<SentImage> take(Timestamp now);

 private:
  [[nodiscard]] cv::Mat light(const DroneTruth& truth, Timestamp now,
                              const FaultEffect& fault) const;
  [[nodiscard]] double gain(Timestamp now) const;
  [[nodiscard]] cv::Mat image(const DroneTruth& truth, Timestamp now,
                              const FaultEffect& fault) const;

  const HoverConfig& config_;
  const HoverWorld& world_;
  double duration_s_;
  bool is_looked_at_;
  std::uint64_t noise_seed_;
  std::vector<MovingObject> moving_objects_;
  std::deque<SentImage> pending_;
  std::int64_t frames_ = 0;
  std::int64_t looks_ = 0;
  cv::Mat last_;
};

}  // namespace stillkite
