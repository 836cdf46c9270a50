#include "io/results/estimate_json.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include "io/results/estimates_csv.hpp"

namespace stillkite {
namespace {

// Cells of a CSV line without its line break.
std::vector<std::string_view> cells_of(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

// Column names without `#` and unit.
std::vector<std::string> column_names() {
  const std::string header = estimates_csv_header().substr(1);
  std::vector<std::string> names;
  for (const std::string_view cell : cells_of(header)) {
    names.emplace_back(cell.substr(0, cell.find(" [")));
  }
  return names;
}

std::string json_value(std::string_view cell) {
  if (cell.empty()) return "null";
  double number = 0;
  const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (result.ec != std::errc() || result.ptr != cell.data() + cell.size()) {
    return fmt::format("\"{}\"", cell);
  }
  return std::isfinite(number) ? std::string(cell) : "null";
}

}  // namespace

std::string estimate_json(const NavigationEstimate& estimate) {
  static const std::vector<std::string> names = column_names();
  const std::string row = estimates_csv_row(estimate);
  std::string out = fmt::format("{{\"schema\":{}", kEstimateSchema);
  std::size_t column = 0;
  for (const std::string_view cell : cells_of(row)) {
    fmt::format_to(std::back_inserter(out), ",\"{}\":{}", names[column++], json_value(cell));
  }
  return out + "}\n";
}

}  // namespace stillkite
