#include "app/page_history.hpp"

#include <algorithm>
#include <utility>

namespace stillkite {

HistorySample history_sample(const PageSnapshot& snapshot, const FlightStatus& status) {
  const NavigationEstimate& estimate = snapshot.step.estimate;
  const MotionEstimate& motion = snapshot.step.motion;
  HistorySample out{.time = snapshot.estimated,
                    .latency_ms = 1e3 * snapshot.latency_s,
                    .verdict = estimate.verdict,
                    .used_images = status.used_images,
                    .decoded_images = status.images.decoded,
                    .replaced_images = status.images.replaced};
  if (estimate.scale != ScaleSource::none || is_in_heights(estimate)) {
    out.speed = estimate.velocity_in_world_m_s.norm();
    out.height = estimate.world_from_body.translation.z();
  }
  if (motion.displacement_kind == DisplacementKind::metric) {
    out.displacement_m = motion.displacement_in_reference.norm();
  } else if (motion.displacement_kind == DisplacementKind::zero) {
    out.displacement_m = 0;
  }
  return out;
}

void PageHistory::add(const HistorySample& sample) {
  constexpr double kInterval_s = 0.25;
  if (current_ && seconds_between(begin_, sample.time) < kInterval_s) {
    const HistorySample before = *std::exchange(current_, sample);
    current_->number = before.number;
    current_->latency_ms = std::max(before.latency_ms, sample.latency_ms);
    if (is_measured(sample.verdict) && !is_measured(before.verdict)) {
      current_->verdict = before.verdict;
    }
    return;
  }
  const std::int64_t number = current_ ? current_->number + 1 : 0;
  if (current_) ended_.push_back(*current_);
  current_ = sample;
  current_->number = number;
  begin_ = sample.time;
}

std::vector<HistorySample> PageHistory::take() {
  return std::exchange(ended_, {});
}

}  // namespace stillkite
