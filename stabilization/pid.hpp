#pragma once

#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

/// Gains and bounds of one controlled quantity. Units follow from the error's [e] and the output's
/// [u]. Of itself proportional.
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
    field("dead_band", self.dead_band, kNotNegative, "error, [e], up to which it counts as none");
    field("integral_limit", self.integral_limit, kNotNegative,
          "most that the integral may add to the output, [u]");
    field("output_limit", self.output_limit, kNotNegative, "most of the output, [u]");
    field("slew_limit", self.slew_limit, kPositive, "most change of the output, [u/s]");
    field("derivative_filter_s", self.derivative_filter_s, Range{0, 10},
          "time constant of the low pass on the error's rate, s; 0: none");
  }
};

struct PidState {
  double integral = 0;          ///< already in the output's unit
  double error_rate = 0;        ///< filtered
  std::optional<double> error;  ///< of the last step
  double output = 0;
};

struct PidStep {
  double output = 0;
  PidState state;
};

/// One step of u = P e + I + D de/dt, with e the error less its dead band (continuous: it starts
/// from 0 at the band's edge), I the bounded integral, which rests while the output is at a bound
/// that the error pushes against, and the output within its limit and its slew. An error or a step
/// that is not finite, or a negative step, gives 0 and leaves the state as it was.
[[nodiscard]] PidStep step(const PidConfig& config, const PidState& state, double error,
                           double dt_s);

}  // namespace stillkite
