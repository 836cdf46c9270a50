#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "io/results/command_recorder.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// What summary.json says beside the estimates themselves.
struct RunFacts {
  std::int64_t frames_read = 0;     ///< those that could not be decoded too
  std::span<const float> frame_ms;  ///< the estimator's time for each frame
  double wall_s = 0;                ///< of the whole loop, decoding included
  bool interrupted = false;
  std::optional<std::string> complaint;   ///< about the source
  std::optional<CommandCounts> commands;  ///< where a controller ran
};

/// summary.json: every number is finite or null. A frame is used if its image moved the estimate
/// (verdict ok, or first_frame); all others that were read are rejected. `evaluation` may be null.
[[nodiscard]] nlohmann::json run_summary(std::span<const NavigationEstimate> estimates,
                                         const RunFacts& facts, nlohmann::json evaluation);

/// The most memory that this process has used so far.
[[nodiscard]] double peak_rss_mib();

}  // namespace stillkite
