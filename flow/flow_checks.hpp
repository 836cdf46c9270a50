#pragma once

#include <fmt/format.h>

#include <opencv2/core/mat.hpp>
#include <type_traits>

#include "geometry/fields.hpp"

namespace stillkite {

/// Returns the config; throws InputError with the first value that is out of range.
template <typename Config>
[[nodiscard]] const Config& in_range(const Config& config) {
  Config::fields(config, [](const char* name, const auto& value, const auto&... about) {
    const auto check = [&](const auto& range) {
      if constexpr (std::is_same_v<std::decay_t<decltype(range)>, Range>) {
        if (!range.contains(static_cast<double>(value))) {
          throw InputError(fmt::format("flow: {} = {} is outside {}{}, {}]", name, value,
                                       range.open_min ? "(" : "[", range.min, range.max));
        }
      }
    };
    (check(about), ...);
  });
  return config;
}

/// Throws InputError unless both are CV_8UC1 and of the same size.
inline void check_frames(const cv::Mat& previous, const cv::Mat& current) {
  if (previous.empty() || previous.type() != CV_8UC1 || current.type() != CV_8UC1 ||
      previous.size() != current.size()) {
    throw InputError(fmt::format(
        "flow: frames of {}x{} and {}x{} px; give two 8-bit grey frames of the same size",
        previous.cols, previous.rows, current.cols, current.rows));
  }
}

}  // namespace stillkite
