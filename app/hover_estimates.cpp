#include "app/hover_estimates.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "evaluation/median_interval.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

json mean_of(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

json rms_of(const std::vector<double>& values) {
  std::vector<double> squares;
  squares.reserve(values.size());
  for (const double value : values) squares.push_back(value * value);
  const json mean = mean_of(squares);
  return mean.is_null() ? mean : json(std::sqrt(mean.get<double>()));
}

json percentile_95_of(const std::vector<double>& values) {
  const std::optional<double> found = nearest_rank_quantile(values, 0.95);
  return found ? json(*found) : json();
}

std::string scaled_or_dash(const json& value, double factor) {
  return value.is_number() ? fmt::format("{:.1f}", factor * value.get<double>()) : "-";
}

}  // namespace

json hover_estimate_json(std::span<const TrialRecord> records) {
  std::vector<double> positions_m;
  std::vector<double> velocities_m_s;
  std::vector<double> nees;
  std::vector<double> available;
  for (const TrialRecord& record : records) {
    for (const EstimateError& error : record.estimate_errors) {
      if (error.position_error_m) positions_m.push_back(*error.position_error_m);
      if (error.velocity_error_m_s) velocities_m_s.push_back(*error.velocity_error_m_s);
      if (error.pose_nees) nees.push_back(*error.pose_nees);
      available.push_back(is_measured(error.verdict) ? 1 : 0);
    }
  }
  return {{"position_rmse_m", rms_of(positions_m)},
          {"velocity_rmse_m_s", rms_of(velocities_m_s)},
          {"velocity_p95_m_s", percentile_95_of(velocities_m_s)},
          {"nees_mean", mean_of(nees)},
          {"available_ratio", mean_of(available)}};
}

std::string hover_estimates_csv(std::span<const TrialRecord> records) {
  std::string out =
      "#trial,t [s],verdict,place_error [m],place_sigma [m],velocity_error [m/s],"
      "turn_error [rad],turn_sigma [rad],nees\n";
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.6g}", *value) : std::string();
  };
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (const EstimateError& e : records[i].estimate_errors) {
      fmt::format_to(std::back_inserter(out), "{},{:.4f},{},{},{:.6g},{},{:.6g},{:.6g},{}\n", i,
                     to_seconds(e.stamp), name_of(e.verdict), number(e.position_error_m),
                     e.position_sigma_m, number(e.velocity_error_m_s), e.rotation_error_rad,
                     e.rotation_sigma_rad, number(e.pose_nees));
    }
  }
  return out;
}

std::string hover_estimate_line(const json& estimate) {
  return fmt::format(
      "estimate: position error {} mm (RMS), velocity error {} cm/s (RMS), {} (95 %), "
      "NEES {} of 6, available {} %\n",
      scaled_or_dash(estimate["position_rmse_m"], 1000),
      scaled_or_dash(estimate["velocity_rmse_m_s"], 100),
      scaled_or_dash(estimate["velocity_p95_m_s"], 100), scaled_or_dash(estimate["nees_mean"], 1),
      scaled_or_dash(estimate["available_ratio"], 100));
}

}  // namespace stillkite
