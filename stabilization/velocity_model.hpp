#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "geometry/time.hpp"

namespace stillkite {

/// Velocity of the drone in the station's frame, and its yaw rate (left is +).
using LevelMotion = Eigen::Vector4d;

/// What the drone's own commands have done to it by a model: each follows with a first-order lag,
/// w' = (u - w) / lag_s. From this a controller knows, before any image does, how far the drone
/// has come since an exposure and what it will still coast (Smith 1957).
class VelocityModel {
 public:
  explicit VelocityModel(double lag_s) : lag_s_(lag_s) {}

  /// To `now`, under the command that was given last. What is not later changes nothing.
  void advance(Timestamp now);

  /// From `now` of the last `advance` on.
  void set_command(const LevelMotion& command) { command_ = command; }

  [[nodiscard]] const LevelMotion& rate() const { return rate_; }

  /// Way from `since` to now; from the oldest instant that is remembered if `since` is before it.
  [[nodiscard]] LevelMotion way_since(Timestamp since) const;
  /// Then; that of the oldest instant remembered if `then` is before it.
  [[nodiscard]] LevelMotion rate_at(Timestamp then) const;

 private:
  struct Instant {
    Timestamp stamp;
    LevelMotion way = LevelMotion::Zero();
    LevelMotion rate = LevelMotion::Zero();
  };
  [[nodiscard]] Instant at(Timestamp then) const;

  static constexpr std::size_t kInstants = 128;  // two seconds at 60 Hz

  double lag_s_;
  LevelMotion command_ = LevelMotion::Zero();
  LevelMotion rate_ = LevelMotion::Zero();
  std::array<Instant, kInstants> past_;  // a ring, the newest at (count_ - 1) % kInstants
  std::size_t count_ = 0;
};

}  // namespace stillkite
