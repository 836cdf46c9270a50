#include "io/report/hover_distribution.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

constexpr double kMinCellSize_m = 0.05;
constexpr double kMaxCells = 60;  // on each side of zero

/// Smallest of 0.05, 0.1, 0.2, 0.5 ... m for which kMaxCells cover all displacements.
double cell_size_m(std::span<const HoverReportTrial> trials, int moved_axis,
                   std::span<const int> axes) {
  double range_m = 0;
  for (const HoverReportTrial& trial : trials) {
    if (trial.moved_axis != moved_axis) continue;
    for (const HoverReportSample& sample : trial.samples) {
      for (const int axis : axes) {
        const double size_m = std::abs(sample.displacement_m(axis));
        if (std::isfinite(size_m)) range_m = std::max(range_m, size_m);
      }
    }
  }
  for (double step_m = kMinCellSize_m;; step_m *= 10) {
    for (const double factor : {1.0, 2.0, 4.0}) {
      if (range_m <= kMaxCells * factor * step_m) return factor * step_m;
    }
  }
}

int cell_of(double displacement_m, double size_m) {
  return static_cast<int>(std::ceil(displacement_m / size_m - 0.5));
}

}  // namespace

CellCounts displacement_histogram(std::span<const HoverReportTrial> trials, int moved_axis) {
  CellCounts counts{.size_m = cell_size_m(trials, moved_axis, std::array{moved_axis})};
  for (const HoverReportTrial& trial : trials) {
    if (trial.moved_axis != moved_axis) continue;
    std::map<int, int>& cells = trial.stabilized ? counts.on : counts.off;
    for (const HoverReportSample& sample : trial.samples) {
      const double d_m = sample.displacement_m(moved_axis);
      if (std::isfinite(d_m)) ++cells[cell_of(d_m, counts.size_m)];
    }
  }
  return counts;
}

PlaneCounts displacement_heat(std::span<const HoverReportTrial> trials, int moved_axis) {
  const int across = axis_across(moved_axis);
  constexpr int kUp = 1;
  PlaneCounts counts{.size_m = cell_size_m(trials, moved_axis, std::array{across, kUp})};
  for (const HoverReportTrial& trial : trials) {
    if (trial.moved_axis != moved_axis) continue;
    auto& cells = trial.stabilized ? counts.on : counts.off;
    for (const HoverReportSample& sample : trial.samples) {
      const double across_m = sample.displacement_m(across);
      const double up_m = sample.displacement_m(kUp);
      if (!std::isfinite(across_m) || !std::isfinite(up_m)) continue;
      ++cells[{cell_of(across_m, counts.size_m), cell_of(up_m, counts.size_m)}];
    }
  }
  return counts;
}

}  // namespace stillkite
