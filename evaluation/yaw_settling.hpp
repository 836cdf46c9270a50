#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// A yaw error over time, sample for sample.
struct YawErrors {
  std::span<const double> t_s;  ///< ascending
  std::span<const double> error_rad;
};

/// How long after `from_s` the error comes within `limit_rad` to stay there up to `until_s`.
/// Nothing where it is beyond at the last sample before `until_s`, or where there is no sample.
[[nodiscard]] std::optional<double> settling_time_s(const YawErrors& errors, double from_s,
                                                    double until_s, double limit_rad);

}  // namespace stillkite
