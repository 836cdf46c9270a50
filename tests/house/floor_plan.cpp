#include "tests/house/floor_plan.hpp"

#include <algorithm>
#include <optional>

namespace stillkite::house {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Parts between separators; `|a|b|` gives "", a, b, "".
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

// Words in backticks: `a`, `b` gives a, b.
std::vector<std::string> quoted_by_backticks(std::string_view cell) {
  const std::vector<std::string_view> parts = split(cell, '`');
  std::vector<std::string> words;
  for (std::size_t i = 1; i < parts.size(); i += 2) words.emplace_back(parts[i]);
  return words;
}

struct Include {
  std::string header;
  bool quoted = false;  ///< else in angle brackets
};

std::optional<Include> include_of(std::string_view line) {
  for (const std::string_view word : {"#", "include"}) {
    line = trimmed(line);
    if (!line.starts_with(word)) return std::nullopt;
    line.remove_prefix(word.size());
  }
  line = trimmed(line);
  if (!line.starts_with('<') && !line.starts_with('"')) return std::nullopt;
  const bool quoted = line.front() == '"';
  const std::string_view header = line.substr(1, line.find_first_of(">\"", 1) - 1);
  return Include{std::string(header), quoted};
}

std::optional<std::string> project_include_violation(const FloorPlan& plan,
                                                     const std::string& folder,
                                                     const std::string& header) {
  const std::string target = header.substr(0, header.find('/'));
  if (target == folder) return std::nullopt;
  const auto floor = plan.find(target);
  if (floor == plan.end()) return "is in no folder of docs/architecture.md";
  const int from = plan.at(folder).level;
  if (floor->second.level > from) return "is on a higher floor";
  if (floor->second.level == from) return "is on the same floor";
  return std::nullopt;
}

std::optional<std::string> library_include_violation(const Floor& floor,
                                                     const std::string& header) {
  // standard library and plain system headers: no folder, or sys/
  if (header.find('/') == std::string::npos || header.starts_with("sys/")) return std::nullopt;
  const bool permitted =
      floor.includes_everything ||
      std::any_of(floor.library_prefixes.begin(), floor.library_prefixes.end(),
                  [&](const std::string& prefix) { return header.starts_with(prefix); });
  return permitted ? std::nullopt : std::optional<std::string>("is not permitted on this floor");
}

}  // namespace

FloorPlan parse_floor_plan(std::string_view markdown) {
  FloorPlan plan;
  for (const std::string_view line : split(markdown, '\n')) {
    const std::vector<std::string_view> cells = split(line, '|');
    if (cells.size() != 6 || cells[1].find_first_not_of("0123456789") != std::string_view::npos) {
      continue;
    }
    const std::vector<std::string> folder = quoted_by_backticks(cells[2]);
    if (cells[1].empty() || folder.empty() || !folder.front().ends_with('/')) continue;
    plan[folder.front().substr(0, folder.front().size() - 1)] = {
        .level = std::stoi(std::string(cells[1])),
        .includes_everything = cells[4] == "everything",
        .library_prefixes = quoted_by_backticks(cells[4])};
  }
  return plan;
}

WingPlan parse_wing_plan(std::string_view markdown) {
  WingPlan plan;
  for (const std::string_view line : split(markdown, '\n')) {
    const std::vector<std::string_view> cells = split(line, '|');
    if (cells.size() != 5) continue;
    const std::vector<std::string> folder = quoted_by_backticks(cells[1]);
    if (folder.size() != 1 || std::ranges::count(folder.front(), '/') != 2) continue;
    const std::string wing = folder.front().substr(0, folder.front().size() - 1);
    std::vector<std::string>& permitted = plan[wing];
    for (const std::string& other : quoted_by_backticks(cells[3])) {
      permitted.push_back(other.substr(0, other.size() - 1));
    }
  }
  return plan;
}

std::vector<std::string> forbidden_wing_includes(const WingPlan& plan, const std::string& folder,
                                                 const std::string& wing, std::string_view source) {
  std::vector<std::string> violations;
  int number = 0;
  for (const std::string_view line : split(source, '\n')) {
    ++number;
    const std::optional<Include> include = include_of(line);
    if (!include || !include->quoted || !include->header.starts_with(folder + '/')) continue;
    const std::string_view inside = std::string_view(include->header).substr(folder.size() + 1);
    const std::size_t slash = inside.find('/');
    if (slash == std::string_view::npos || inside.substr(0, slash) == wing) continue;
    const std::string target(inside.substr(0, slash));
    const auto own = plan.find(folder + '/' + wing);
    const bool permitted =
        own != plan.end() && std::ranges::find(own->second, target) != own->second.end();
    if (permitted) continue;
    violations.push_back("line " + std::to_string(number) + ": " + include->header +
                         (wing.empty() ? " is in a wing, not permitted outside wings"
                                       : " is not permitted in the wing " + wing));
  }
  return violations;
}

std::vector<std::string> forbidden_includes(const FloorPlan& plan, const std::string& folder,
                                            std::string_view source) {
  std::vector<std::string> violations;
  int number = 0;
  for (const std::string_view line : split(source, '\n')) {
    ++number;
    const std::optional<Include> include = include_of(line);
    if (!include) continue;
    const std::optional<std::string> violation =
        include->quoted ? project_include_violation(plan, folder, include->header)
                        : library_include_violation(plan.at(folder), include->header);
    if (violation) {
      violations.push_back("line " + std::to_string(number) + ": " + include->header + " " +
                           *violation);
    }
  }
  return violations;
}

}  // namespace stillkite::house
