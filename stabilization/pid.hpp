#pragma once

#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

/// PID gains and limits of one axis. [e] is the error's unit, [u] the output's. Default: P alone.
struct PidConfig {
  double proportional = 1.0;
  double integral = 0.0;
  double derivative = 0.0;
  double dead_band = 0.0;
  double integral_limit = 1.0;
  double output_limit = 1.0;
  std::optional<double> slew_limit;
  double derivative_filter_s = 0.1;

  static void fields(auto& self, auto&& field) {
    field("proportional", self.proportional, Range{0, 100}, "gain of the error, [u/e]");
    field("integral", self.integral, Range{0, 100}, "gain of the error's integral, [u/e/s]");
    field("derivative", self.derivative, Range{0, 100}, "gain of the error's rate, [u s/e]");
    field("dead_band", self.dead_band, kNonNegative, "dead band of the error, [e]");
    field("integral_limit", self.integral_limit, kNonNegative, "limit of the integral term, [u]");
    field("output_limit", self.output_limit, kNonNegative, "limit of the output, [u]");
    field("slew_limit", self.slew_limit, kPositive, "slew-rate limit of the output, [u/s]");
    field("derivative_filter_s", self.derivative_filter_s, Range{0, 10},
          "time constant of the low pass on the error's rate, s; 0: none");
  }
};

struct PidState {
  double integral = 0;          ///< in the output's unit
  double error_rate = 0;        ///< filtered
  std::optional<double> error;  ///< of the last step
  double output = 0;
};

struct PidStep {
  double output = 0;
  PidState state;
};

/// One step of u = P e + I + D de/dt. e is the error reduced by the dead band (continuous at its
/// edge), I the bounded integral, and u is within its limit and slew rate. Anti-windup: I is
/// constant while the error drives u into a bound. Returns output 0 and the unchanged state for an
/// error or a step that is not finite, and for a negative step.
[[nodiscard]] PidStep step(const PidConfig& config, const PidState& state, double error,
                           double dt_s);

}  // namespace stillkite
