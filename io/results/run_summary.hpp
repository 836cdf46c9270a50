#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/results/command_recorder.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Counts and times of a run's frames.
struct RunTally {
  std::int64_t frames = 0;
  std::array<std::int64_t, EnumNames<Verdict>::value.size()> verdicts{};
  std::array<std::vector<float>, kStageCount> stage_ms;
  std::optional<Timestamp> first_stamp;
  std::optional<NavigationEstimate> last;
  double max_masked_ratio = 0;

  void add(const NavigationEstimate& estimate);
};

/// Facts of a run for summary.json, in addition to its estimates.
struct RunFacts {
  std::int64_t frames_read = 0;     ///< undecodable ones included
  std::span<const float> frame_ms;  ///< estimator time of each frame
  double wall_s = 0;                ///< whole loop, decoding included
  bool interrupted = false;
  std::optional<std::string> problem;     ///< of the source: undecodable or truncated images
  std::optional<CommandCounts> commands;  ///< nullopt without a controller
};

/// summary.json; every number is finite or null. `frames.used`: verdicts ok and first_frame; all
/// other frames read are `rejected`; `availability_ratio`: used / read. `evaluation` may be null.
[[nodiscard]] nlohmann::json run_summary(const RunTally& tally, const RunFacts& facts,
                                         nlohmann::json evaluation);

/// Peak resident memory of this process.
[[nodiscard]] double peak_rss_mib();

}  // namespace stillkite
