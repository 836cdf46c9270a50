#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "geometry/time.hpp"

namespace stillkite {

/// Translation (x, y, z) in the station's frame and yaw (left is +), or their rates.
using TranslationYaw = Eigen::Vector4d;

/// Drone motion that its own commands cause: each rate follows its command with a first-order lag,
/// w' = (u - w) / lag_s. It predicts the displacement since an exposure and the coasting, ahead of
/// any image (Smith predictor, 1957).
class VelocityModel {
 public:
  explicit VelocityModel(double lag_s) : lag_s_(lag_s) {}

  /// Predicts to `now` under the last command. Does nothing unless `now` is later.
  void advance(Timestamp now);

  /// Sets the command from the last `advance` on.
  void set_command(const TranslationYaw& command) { command_ = command; }

  [[nodiscard]] const TranslationYaw& rate() const { return rate_; }

  /// Displacement from `since` to now; from the oldest stored instant if `since` is before it.
  [[nodiscard]] TranslationYaw displacement_since(Timestamp since) const;
  /// Rate at `then`; at the oldest stored instant if `then` is before it.
  [[nodiscard]] TranslationYaw rate_at(Timestamp then) const;

 private:
  struct Instant {
    Timestamp stamp;
    TranslationYaw displacement = TranslationYaw::Zero();
    TranslationYaw rate = TranslationYaw::Zero();
  };
  [[nodiscard]] Instant at(Timestamp then) const;

  static constexpr std::size_t kInstants = 128;  // two seconds at 60 Hz

  double lag_s_;
  TranslationYaw command_ = TranslationYaw::Zero();
  TranslationYaw rate_ = TranslationYaw::Zero();
  std::array<Instant, kInstants> past_;  // ring buffer, newest at (count_ - 1) % kInstants
  std::size_t count_ = 0;
};

}  // namespace stillkite
