#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "io/report/comparison_report.hpp"
#include "tests/browser/synthetic_flight.hpp"

namespace stillkite {

/// Estimates of two synthetic estimators on one flight; the second has twice the position error.
// NOLINTNEXTLINE(bugprone-exception-escape): nlohmann::json moves without throwing
struct SyntheticComparison {
  SyntheticFlight first;
  SyntheticFlight second;
  std::vector<float> frame_ms;
  std::array<std::string, 2> names{"flow", "reference"};
  nlohmann::json comparison;

  [[nodiscard]] ComparisonReportContent content(const std::string& title, bool with_truth) const {
    ComparisonReportContent content{.title = title, .runs = {}, .config_yaml = first.config_yaml};
    for (const SyntheticFlight* flight : {&first, &second}) {
      content.runs.push_back({.name = names[content.runs.size()],
                              .charts = flight->content(title, with_truth).charts,
                              .frame_ms = std::span(frame_ms).first(flight->estimates.size())});
    }
    return content;
  }
};

inline void compare_synthetic_flights(SyntheticComparison& made, int frames,
                                      bool second_has_scale) {
  made.first = synthetic_flight(frames);
  made.second = made.first;
  for (std::size_t i = 0; i < made.second.estimates.size(); ++i) {
    NavigationEstimate& estimate = made.second.estimates[i];
    const RigidTransform& truth = *made.second.truth[i];
    estimate.world_from_body.translation +=
        estimate.world_from_body.translation - truth.translation;
    if (!second_has_scale) estimate.scale = ScaleSource::none;
  }
  made.frame_ms.assign(made.first.estimates.size(), 2.5F);
  nlohmann::json entry = synthetic_summary(made.first);
  entry["name"] = "flow";
  entry["availability_ratio"] = 0.97;
  entry["mean_error"] = {{"position_m", 0.163}, {"velocity_m_s", nullptr}};
  nlohmann::json other = entry;
  other["name"] = "reference";
  other["mean_error"]["position_m"] = 0.326;
  made.comparison = {{"estimators", {entry, other}},
                     {"differences",
                      {{{"of", "reference"},
                        {"against", "flow"},
                        {"figure", "position_m"},
                        {"frames", frames},
                        {"mean", 0.163},
                        {"low", 0.101},
                        {"high", 0.225},
                        {"verdict", "worse"}}}},
                     {"frames_read", frames},
                     {"timing", {{"wall_s", 9.5}, {"decoding_s", 1.5}, {"threads", 1}}},
                     {"interrupted", false}};
}

}  // namespace stillkite
