#include "app/hover_results.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/hover_estimates.hpp"
#include "app/orientation_results.hpp"
#include "app/trial_statistics_json.hpp"
#include "evaluation/trial_statistics.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

// Hold paper, table I, cm: x, y, z, all.
struct PaperRow {
  const char* trials;
  const char* figure;
  std::array<int, 4> cm;
};
constexpr std::array<PaperRow, 4> kPaperTable{{{"on", "mean_m", {36, 26, 35, 34}},
                                               {"on", "std_m", {45, 31, 43, 42}},
                                               {"off", "mean_m", {106, 43, 108, 98}},
                                               {"off", "std_m", {122, 52, 119, 118}}}};
constexpr std::array<const char*, 4> kTableColumns{"x", "y", "z", "all"};

std::string policy_of(const Trial& trial, const std::string& policy) {
  return trial.stabilized ? policy : "none";
}

std::string cm_text(const json& metres) {
  return metres.is_number() ? fmt::format("{:.1f}", 100 * metres.get<double>()) : "-";
}

}  // namespace

std::vector<double> displacements_m(const TrialRecord& record) {
  const Eigen::Vector3d axis = paper_axis_in_world(record.trial.axis);
  std::vector<double> values;
  values.reserve(record.samples.size());
  for (const TrialSample& sample : record.samples) {
    values.push_back(axis.dot(sample.displacement_in_world_m));
  }
  return values;
}

json hover_summary(std::span<const TrialRecord> records, const std::string& policy, double wall_s) {
  json trials = json::array();
  double flown_s = 0;
  for (const TrialRecord& record : records) {
    json trial = statistics_json(displacements_m(record), "m");
    trial["axis"] = name_of(record.trial.axis);
    trial["stabilization"] = record.trial.stabilized;
    trial["policy"] = policy_of(record.trial, policy);
    trial["seed"] = record.trial.seed;
    trial["estimate"] = hover_estimate_json({&record, 1});
    trials.push_back(std::move(trial));
    if (!record.samples.empty()) flown_s += record.samples.back().t_s;
  }
  const auto table_row = [&](bool stabilized) {
    return statistics_by_axis(records, stabilized, "m", displacements_m);
  };
  return {{"table", {{"on", table_row(true)}, {"off", table_row(false)}}},
          {"trials", std::move(trials)},
          {"estimate", hover_estimate_json(records)},
          {"orientation", orientation_summary(records)},
          {"timing", {{"wall_s", wall_s}, {"real_time_factor", flown_s / wall_s}}}};
}

std::string trials_csv(std::span<const TrialRecord> records, const std::string& policy) {
  std::string out = "#trial,axis,stabilization,policy,seed,samples,mean [m],std [m],max [m]\n";
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Trial& trial = records[i].trial;
    const auto found = signed_statistics(displacements_m(records[i]));
    if (!found) continue;
    fmt::format_to(std::back_inserter(out), "{},{},{},{},{},{},{:.6g},{:.6g},{:.6g}\n", i,
                   name_of(trial.axis), trial.stabilized ? "on" : "off", policy_of(trial, policy),
                   trial.seed, found->samples, found->mean, found->deviation, found->max);
  }
  return out;
}

std::string samples_csv(std::span<const TrialRecord> records) {
  std::string out =
      "#trial,t [s],dx [m],dy [m],dz [m],station_x [m],station_y [m],station_z [m],yaw [deg],"
      "verdict,action,reason,length_rate [m/s],elevation_rate [rad/s],azimuth_rate [rad/s],"
      "yaw_rate [rad/s]\n";
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (const TrialSample& s : records[i].samples) {
      const Eigen::Vector3d& d = s.displacement_in_world_m;
      const Eigen::Vector3d& at = s.station_in_world_m;
      fmt::format_to(std::back_inserter(out),
                     "{},{:.4f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.4f},{},{},{},"
                     "{:.5f},{:.5f},{:.5f},{:.5f}\n",
                     i, s.t_s, d.x(), d.y(), d.z(), at.x(), at.y(), at.z(), s.yaw_rad / kDegree,
                     name_of(s.verdict), name_of(s.action), name_of(s.reason),
                     s.command.length_rate_m_s, s.command.elevation_rate_rad_s,
                     s.command.azimuth_rate_rad_s, s.command.yaw_rate_rad_s);
    }
  }
  return out;
}

std::string hover_table(const json& summary) {
  std::string out = fmt::format("{:<28}", "displacement, cm (paper)");
  for (const char* column : kTableColumns) out += fmt::format("{:>16}", column);
  out += '\n';
  for (const PaperRow& row : kPaperTable) {
    const std::string figure = row.figure == std::string("mean_m") ? "mean |d|" : "deviation";
    out += fmt::format("stabilization {:<4}{:<10}", row.trials, figure);
    for (std::size_t i = 0; i < kTableColumns.size(); ++i) {
      const json& value = summary["table"][row.trials][kTableColumns[i]][row.figure];
      out += fmt::format("{:>10} ({:>3})", cm_text(value), row.cm[i]);
    }
    out += '\n';
  }
  return out + hover_estimate_line(summary["estimate"]) + orientation_table(summary["orientation"]);
}

}  // namespace stillkite
