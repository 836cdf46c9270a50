#include "stabilization/pid.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

double beyond_dead_band(double error, double band) {
  return std::copysign(std::max(std::abs(error) - band, 0.0), error);
}

double within_bounds(const PidConfig& config, const PidState& state, double output, double dt_s) {
  const double limited = std::clamp(output, -config.output_limit, config.output_limit);
  if (!config.slew_limit) return limited;
  const double max_change = *config.slew_limit * dt_s;
  return std::clamp(limited, state.output - max_change, state.output + max_change);
}

}  // namespace

PidStep step(const PidConfig& config, const PidState& state, double error, double dt_s) {
  if (!std::isfinite(error) || !std::isfinite(dt_s) || dt_s < 0) return {0, state};
  PidState next = state;
  const double e = beyond_dead_band(error, config.dead_band);
  if (state.error && dt_s > 0) {
    // backward Euler of the first-order low pass
    const double rate = (e - *state.error) / dt_s;
    next.error_rate += dt_s / (dt_s + config.derivative_filter_s) * (rate - state.error_rate);
  }
  next.error = e;
  next.integral = std::clamp(state.integral + config.integral * e * dt_s, -config.integral_limit,
                             config.integral_limit);
  const double without_integral = config.proportional * e + config.derivative * next.error_rate;
  const double unlimited = without_integral + next.integral;
  next.output = within_bounds(config, state, unlimited, dt_s);
  if ((unlimited - next.output) * e > 0) next.integral = state.integral;
  return {next.output, next};
}

}  // namespace stillkite
