#pragma once

#include <array>
#include <map>
#include <span>

#include "io/report/hover_report.hpp"

namespace stillkite {

/// How often each cell of a grid was met. Cell k covers ((k - 1/2) size_m, (k + 1/2) size_m], so
/// that the place to hold is the middle of a cell.
struct CellCounts {
  double size_m = 0;
  std::map<int, int> on;  ///< with stabilization
  std::map<int, int> off;
};

/// The same over two axes: (across, up).
struct PlaneCounts {
  double size_m = 0;
  std::map<std::array<int, 2>, int> on;
  std::map<std::array<int, 2>, int> off;
};

/// The displacements along the moved axis of the trials of one set (figure 4 of the hold paper).
[[nodiscard]] CellCounts displacement_histogram(std::span<const HoverReportTrial> trials,
                                                int moved_axis);

/// The same in the upright plane of figure 3: over x, over z where the station moved along z.
[[nodiscard]] PlaneCounts displacement_heat(std::span<const HoverReportTrial> trials,
                                            int moved_axis);

/// The level axis of that plane.
[[nodiscard]] constexpr int axis_across(int moved_axis) {
  return moved_axis == 2 ? 2 : 0;
}

}  // namespace stillkite
