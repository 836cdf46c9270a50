#include "app/comparison_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

/// A figure of one estimator: where it stands in its entry, and in what unit it is shown.
struct TableFigure {
  const char* label;
  const char* place;
  double unit = 1;
};

constexpr std::array<TableFigure, 9> kErrorFigures{
    {{"position RMSE, m", "/evaluation/position_rmse_m"},
     {"drift, % of the path", "/evaluation/drift_percent"},
     {"velocity RMSE, m/s", "/evaluation/velocity_rmse_m_s"},
     {"tilt RMSE, deg", "/evaluation/tilt_rmse_rad", kDegree},
     {"yaw RMSE, deg", "/evaluation/yaw_rmse_rad", kDegree},
     {"from the reference: rotation, deg", "/evaluation/reference/rotation_median_deg"},
     {"from the reference: direction, deg", "/evaluation/reference/direction_median_deg"},
     {"from the reference: frames with one", "/evaluation/reference/directions"},
     {"from the reference: displacement, m", "/evaluation/reference/displacement_rmse_m"}}};
constexpr std::array<TableFigure, 4> kFrameFigures{
    {{"mean error: position, m", "/mean_error/position_m"},
     {"mean error: velocity, m/s", "/mean_error/velocity_m_s"},
     {"mean error: attitude, deg", "/mean_error/attitude_rad", kDegree},
     {"mean error: angular rate, deg/s", "/mean_error/angular_rate_rad_s", kDegree}}};
constexpr std::array<TableFigure, 4> kCostFigures{
    {{"availability, %", "/availability_ratio", 0.01},
     {"ms a frame, median", "/timing/frame_ms/median"},
     {"ms a frame, 99 %", "/timing/frame_ms/p99"},
     {"own time, s", "/timing/total_s"}}};

json found_at(const json& entry, const std::string& place) {
  const json::json_pointer pointer(place);
  return entry.contains(pointer) ? entry.at(pointer) : json(nullptr);
}

// Of three axes the length of the vector.
std::string shown_number(const json& value, double unit) {
  if (value.is_number()) return fmt::format("{:.4g}", value.get<double>() / unit);
  if (!value.is_array()) return "-";
  double squares = 0;
  for (const json& axis : value) squares += std::pow(axis.get<double>() / unit, 2);
  return fmt::format("{:.4g}", std::sqrt(squares));
}

std::string mark_of(const json& comparison, const json& entry, const std::string& place) {
  const json& first = comparison["estimators"][0]["name"];
  for (const json& difference : comparison["differences"]) {
    if (difference["against"] != first || difference["of"] != entry["name"]) continue;
    if (!place.ends_with(fmt::format("/{}", difference["figure"].get<std::string>()))) continue;
    const auto verdict = difference["verdict"].get<std::string>();
    return verdict == "not_significant" ? "n.s." : verdict;
  }
  return "";
}

class ColumnTable {
 public:
  explicit ColumnTable(const json& comparison) : comparison_(comparison) {
    std::vector<std::string> names;
    for (const json& entry : entries()) names.push_back(entry["name"].get<std::string>());
    add_row("", names);
  }

  void add_row(const TableFigure& figure, bool is_marked = false) {
    std::vector<std::string> cells;
    bool is_known = false;
    for (const json& entry : entries()) {
      const json value = found_at(entry, figure.place);
      is_known = is_known || !value.is_null();
      cells.push_back(shown_number(value, figure.unit));
      if (is_marked)
        cells.back() += fmt::format(" {:<8}", mark_of(comparison_, entry, figure.place));
    }
    if (is_known) add_row(figure.label, cells);
  }

  void add_verdicts() {
    for (const auto& [verdict, count] : entries()[0]["verdicts"].items()) {
      std::vector<std::string> cells;
      bool occurs = false;
      for (const json& entry : entries()) {
        cells.push_back(entry["verdicts"][verdict].dump());
        occurs = occurs || entry["verdicts"][verdict] != 0;
      }
      if (occurs) add_row("frames " + verdict, cells);
    }
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  [[nodiscard]] const json& entries() const { return comparison_["estimators"]; }

  void add_row(const std::string& label, const std::vector<std::string>& cells) {
    text_ += fmt::format("{:<36}", label);
    for (const std::string& cell : cells) add_cell(cell);
    text_.erase(text_.find_last_not_of(' ') + 1);
    text_ += '\n';
  }

  // Numbers stand under each other, with room for a mark behind.
  void add_cell(std::string cell) {
    const std::size_t mark = cell.find(' ');
    if (mark == std::string::npos) cell += std::string(9, ' ');
    std::size_t width = 21;
    for (const json& entry : entries()) {
      width = std::max(width, entry["name"].get_ref<const std::string&>().size() + 11);
    }
    text_ += fmt::format("{:>{}}", cell, width);
  }

  const json& comparison_;
  std::string text_;
};

std::string timing_line(const json& comparison) {
  const json& timing = comparison["timing"];
  std::string line = fmt::format("{} frames in {:.2f} s: decoding {:.2f} s (beside the rest)",
                                 comparison["frames_read"].dump(), timing["wall_s"].get<double>(),
                                 timing["decoding_s"].get<double>());
  for (const json& entry : comparison["estimators"]) {
    line += fmt::format(", {} {:.2f} s", entry["name"].get<std::string>(),
                        entry["timing"]["total_s"].get<double>());
  }
  const auto threads = timing["threads"].get<int>();
  return line + fmt::format("; {} an estimator\n",
                            threads == 1 ? "one thread" : fmt::format("{} threads", threads));
}

}  // namespace

std::string comparison_table(const json& comparison) {
  ColumnTable table(comparison);
  for (const TableFigure& figure : kErrorFigures) table.add_row(figure);
  for (const TableFigure& figure : kFrameFigures) table.add_row(figure, true);
  for (const TableFigure& figure : kCostFigures) table.add_row(figure);
  table.add_verdicts();
  std::string text = table.text();
  if (!comparison["differences"].empty()) {
    text += fmt::format(
        "better, worse: than {} on the same frames, significantly (95 %, batch means); n.s.: not;\n"
        "drifting: errors that hang together for so long that one flight cannot tell\n",
        comparison["estimators"][0]["name"].get<std::string>());
  }
  return text + timing_line(comparison);
}

}  // namespace stillkite
