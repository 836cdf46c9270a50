#pragma once

#include <array>
#include <map>
#include <span>

#include "io/report/hover_report.hpp"

namespace stillkite {

/// Histogram of displacements. Cell k covers ((k - 1/2) size_m, (k + 1/2) size_m]; the reference
/// position is the centre of cell 0.
struct CellCounts {
  double size_m = 0;
  std::map<int, int> on;  ///< cell -> samples, with stabilization
  std::map<int, int> off;
};

/// Histogram over two axes, cells (horizontal, vertical).
struct PlaneCounts {
  double size_m = 0;
  std::map<std::array<int, 2>, int> on;
  std::map<std::array<int, 2>, int> off;
};

/// Histogram of the displacement along the moved axis, of one set of trials (hold paper, Fig. 4).
[[nodiscard]] CellCounts displacement_histogram(std::span<const HoverReportTrial> trials,
                                                int moved_axis);

/// Histogram in the vertical plane of the moved axis: x-y, or z-y for axis z (hold paper, Fig. 3).
[[nodiscard]] PlaneCounts displacement_heat(std::span<const HoverReportTrial> trials,
                                            int moved_axis);

/// Horizontal axis of that plane.
[[nodiscard]] constexpr int axis_across(int moved_axis) {
  return moved_axis == 2 ? 2 : 0;
}

}  // namespace stillkite
