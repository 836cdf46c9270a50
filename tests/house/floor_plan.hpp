#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillkite::house {

/// One row of the table in docs/architecture.md.
struct Floor {
  int level = 0;
  bool includes_everything = false;
  std::vector<std::string> library_prefixes;  ///< beginnings of permitted library includes
};

/// Floors by folder name, in the order of the names.
using FloorPlan = std::map<std::string, Floor>;

/// The wings of a folder that each of its wings may include, by "folder/wing".
using WingPlan = std::map<std::string, std::vector<std::string>>;

/// Reads the rows `| level | folder/ | job | may include |` of a Markdown text.
[[nodiscard]] FloorPlan parse_floor_plan(std::string_view markdown);

/// Reads the rows `| folder/wing/ | job | may include |` of a Markdown text.
[[nodiscard]] WingPlan parse_wing_plan(std::string_view markdown);

/// Every include of a source text in `folder/wing` (empty: in the folder itself) that leads to a
/// wing of the same folder and that the plan forbids, as "line N: ... ".
[[nodiscard]] std::vector<std::string> forbidden_wing_includes(const WingPlan& plan,
                                                               const std::string& folder,
                                                               const std::string& wing,
                                                               std::string_view source);

/// Every include of a source text in `folder` that the plan forbids, as "line N: ... ".
[[nodiscard]] std::vector<std::string> forbidden_includes(const FloorPlan& plan,
                                                          const std::string& folder,
                                                          std::string_view source);

}  // namespace stillkite::house
