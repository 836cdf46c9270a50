#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// Sampled yaw error over time; spans of equal length.
struct YawErrors {
  std::span<const double> t_s;  ///< ascending
  std::span<const double> error_rad;
};

/// Settling time: time from `from_s` until |error| stays within `limit_rad` up to `until_s`.
/// std::nullopt if the last sample before `until_s` exceeds the limit, or without samples.
[[nodiscard]] std::optional<double> settling_time_s(const YawErrors& errors, double from_s,
                                                    double until_s, double limit_rad);

}  // namespace stillkite
