#pragma once

#include <optional>

#include "geometry/time.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Tether direction that the commands alone produce: each rate follows its command with a
/// first-order lag, r' = (u - r) / lag_s. Wind deflects the drone from it, so a measured direction
/// differs; elevation and azimuth rates move the drone along the axes of the modelled direction.
class TetherModel {
 public:
  explicit TetherModel(double lag_s) : lag_s_(lag_s) {}

  /// Predicts to `now` under the last command. Does nothing unless `now` is later.
  void advance(Timestamp now);
  /// Sets the command from the last `advance` on.
  void set_command(const TetherCommand& command) { command_ = command; }

  /// Returns the modelled direction with the measured length. The first measurement initializes
  /// the direction; one within half a metre of the zenith horizontally is a take-off and
  /// initializes the zenith, azimuth 0. A measurement beyond any wind deflection resets it.
  TetherState update(const TetherState& measured);

 private:
  double lag_s_;
  TetherCommand command_, rate_;
  std::optional<TetherState> state_;
  std::optional<Timestamp> last_;
};

}  // namespace stillkite
