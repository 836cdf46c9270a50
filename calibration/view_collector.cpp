#include "calibration/view_collector.hpp"

#include <algorithm>
#include <limits>

namespace stillkite {
namespace {

// Mean displacement of the common corners; infinite without any.
double displacement_px(const BoardView& a, const BoardView& b) {
  double sum_px = 0;
  int count = 0;
  for (std::size_t i = 0; i < a.ids.size(); ++i) {
    const auto found = std::ranges::find(b.ids, a.ids[i]);
    if (found == b.ids.end()) continue;
    const auto j = static_cast<std::size_t>(found - b.ids.begin());
    sum_px += (a.pixels[i] - b.pixels[j]).norm();
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : sum_px / count;
}

}  // namespace

void ViewCollector::add(BoardView view) {
  constexpr double kMinDisplacement_ratio = 0.02;
  constexpr double kMaxInterval_s = 0.5;  // images taken one by one have no speed
  double speed_px_s = std::numeric_limits<double>::infinity();
  if (previous_) {
    const double interval_s = seconds_between(previous_->stamp, view.stamp);
    if (interval_s < kMaxInterval_s) speed_px_s = displacement_px(*previous_, view) / interval_s;
  }
  const bool is_new_group =
      !first_ || displacement_px(*first_, view) >= kMinDisplacement_ratio * width_px_;
  if (is_new_group) {
    if (slowest_) kept_.push_back(*slowest_);
    first_ = view;
  }
  if (is_new_group || speed_px_s < slowest_px_s_) {
    slowest_ = view;
    slowest_px_s_ = speed_px_s;
  }
  previous_ = std::move(view);
}

std::vector<BoardView> ViewCollector::views() const {
  std::vector<BoardView> all = kept_;
  if (slowest_) all.push_back(*slowest_);
  return all;
}

}  // namespace stillkite
