#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillkite::house {

/// Row of the table in docs/architecture.md.
struct Floor {
  int level = 0;
  bool includes_everything = false;
  std::vector<std::string> library_prefixes;  ///< path prefixes of permitted library includes
};

/// Floors by folder name.
using FloorPlan = std::map<std::string, Floor>;

/// Permitted wings of the same folder by "folder/wing".
using WingPlan = std::map<std::string, std::vector<std::string>>;

/// Parses the rows `| level | folder/ | job | may include |` of a Markdown text.
[[nodiscard]] FloorPlan parse_floor_plan(std::string_view markdown);

/// Parses the rows `| folder/wing/ | job | may include |` of a Markdown text.
[[nodiscard]] WingPlan parse_wing_plan(std::string_view markdown);

/// Forbidden includes of wings of the same folder in a source text of `folder/wing` (empty wing:
/// the folder itself), as "line N: ...".
[[nodiscard]] std::vector<std::string> forbidden_wing_includes(const WingPlan& plan,
                                                               const std::string& folder,
                                                               const std::string& wing,
                                                               std::string_view source);

/// Forbidden includes in a source text of `folder`, as "line N: ...".
[[nodiscard]] std::vector<std::string> forbidden_includes(const FloorPlan& plan,
                                                          const std::string& folder,
                                                          std::string_view source);

}  // namespace stillkite::house
