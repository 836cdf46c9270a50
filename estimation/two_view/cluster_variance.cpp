#include "estimation/two_view/cluster_variance.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace stillkite {

std::vector<BearingColumns> columns_by_cell(const BearingColumns& columns) {
  constexpr int kAcross = 6;
  constexpr int kDown = 4;
  const auto count = static_cast<std::ptrdiff_t>(columns.size());
  const auto [left, right] = std::minmax_element(columns.ax.begin(), columns.ax.begin() + count);
  const auto [top, bottom] = std::minmax_element(columns.ay.begin(), columns.ay.begin() + count);
  const auto cell_of = [](double at, double from, double to, int cells) {
    return to > from ? std::min(cells - 1, static_cast<int>((at - from) / (to - from) * cells)) : 0;
  };
  std::array<std::vector<std::size_t>, kAcross * kDown> members;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const int column = cell_of(columns.ax[i], *left, *right, kAcross);
    const int row = cell_of(columns.ay[i], *top, *bottom, kDown);
    members[static_cast<std::size_t>(row * kAcross + column)].push_back(i);
  }
  std::vector<BearingColumns> cells;
  for (const std::vector<std::size_t>& indices : members) {
    if (!indices.empty()) cells.emplace_back(columns, indices);
  }
  return cells;
}

}  // namespace stillkite
