#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/comparison_results.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

/// Row of the table: JSON pointer within an estimator's entry, and the display unit.
struct TableFigure {
  const char* label;
  const char* pointer;
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
     {"from the reference: directions", "/evaluation/reference/directions"},
     {"from the reference: displacement, m", "/evaluation/reference/displacement_rmse_m"}}};
constexpr std::array<TableFigure, 4> kFrameFigures{
    {{"mean error: position, m", "/mean_error/position_m"},
     {"mean error: velocity, m/s", "/mean_error/velocity_m_s"},
     {"mean error: attitude, deg", "/mean_error/attitude_rad", kDegree},
     {"mean error: angular rate, deg/s", "/mean_error/angular_rate_rad_s", kDegree}}};
constexpr std::array<TableFigure, 4> kCostFigures{
    {{"availability, %", "/availability_ratio", 0.01},
     {"ms per frame, median", "/timing/frame_ms/median"},
     {"ms per frame, 99 %", "/timing/frame_ms/p99"},
     {"total time, s", "/timing/total_s"}}};

json value_at(const json& entry, const std::string& pointer) {
  const json::json_pointer at(pointer);
  return entry.contains(at) ? entry.at(at) : json(nullptr);
}

// Three axes are shown as the norm of the vector.
std::string number_text(const json& value, double unit) {
  if (value.is_number()) return fmt::format("{:.4g}", value.get<double>() / unit);
  if (!value.is_array()) return "-";
  double squares = 0;
  for (const json& axis : value) squares += std::pow(axis.get<double>() / unit, 2);
  return fmt::format("{:.4g}", std::sqrt(squares));
}

std::string mark_of(const json& comparison, const json& entry, const std::string& pointer) {
  const json& first = comparison["estimators"][0]["name"];
  for (const json& difference : comparison["differences"]) {
    if (difference["against"] != first || difference["of"] != entry["name"]) continue;
    if (!pointer.ends_with(fmt::format("/{}", difference["figure"].get<std::string>()))) continue;
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
    bool has_value = false;
    for (const json& entry : entries()) {
      const json value = value_at(entry, figure.pointer);
      has_value = has_value || !value.is_null();
      cells.push_back(number_text(value, figure.unit));
      if (is_marked)
        cells.back() += fmt::format(" {:<8}", mark_of(comparison_, entry, figure.pointer));
    }
    if (has_value) add_row(figure.label, cells);
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

  // Right-aligns numbers and reserves space for a mark.
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
  std::string line = fmt::format("{} frames in {:.2f} s: decoding {:.2f} s (in parallel)",
                                 comparison["frames_read"].dump(), timing["wall_s"].get<double>(),
                                 timing["decoding_s"].get<double>());
  for (const json& entry : comparison["estimators"]) {
    line += fmt::format(", {} {:.2f} s", entry["name"].get<std::string>(),
                        entry["timing"]["total_s"].get<double>());
  }
  const auto threads = timing["threads"].get<int>();
  return line + fmt::format("; {} per estimator\n",
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
        "better, worse: significant difference from {} on the same frames (95 %, batch means);\n"
        "n.s.: not significant; drifting: error correlation time too long for one flight\n",
        comparison["estimators"][0]["name"].get<std::string>());
  }
  return text + timing_line(comparison);
}

}  // namespace stillkite
