#pragma once

#include <optional>

#include "geometry/time.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Where a tethered drone keeps itself by its commands: its rates follow them with a first-order
/// lag, r' = (u - r) / lag_s. Wind moves it off from there, and the sensors see it where it is; but
/// what an elevation or azimuth rate moves it along is told by where it is kept.
class HeldTether {
 public:
  explicit HeldTether(double lag_s) : lag_s_(lag_s) {}

  /// To `now`, under the command that was given last. What is not later changes nothing.
  void advance(Timestamp now);
  /// From `now` of the last `advance` on.
  void set_command(const TetherCommand& command) { command_ = command; }

  /// Length as read. The direction is that of the first reading, moved by the commands since;
  /// afresh where the reading is farther off than wind blows a drone. What is seen overhead at
  /// first, less than half a metre aside, has taken off from its station: it is kept at the zenith,
  /// azimuth 0.
  TetherState take(const TetherState& read);

 private:
  double lag_s_;
  TetherCommand command_, rate_;
  std::optional<TetherState> held_;
  std::optional<Timestamp> last_;
};

}  // namespace stillkite
