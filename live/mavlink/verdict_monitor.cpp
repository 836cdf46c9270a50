#include "live/mavlink/verdict_monitor.hpp"

#include <fmt/format.h>

#include "live/mavlink/vision_output.hpp"

namespace stillkite::mavlink {
namespace {

constexpr double kLasting_s = 1;

}  // namespace

std::uint8_t ResetCounter::update(const NavigationEstimate& estimate) {
  const bool measured = is_measured(estimate.verdict);
  const bool after_gap =
      measured && last_measured_ && seconds_between(*last_measured_, estimate.stamp) > max_gap_s_;
  const bool is_metric = estimate.scale != ScaleSource::none;
  const bool regained_scale = is_metric && has_lost_scale_;
  const bool relocalized =
      estimate.relocalized || (estimate.reference && estimate.reference->relocalized);
  if (after_gap || regained_scale || relocalized) ++count_;
  if (measured) last_measured_ = estimate.stamp;
  has_been_metric_ = has_been_metric_ || is_metric;
  has_lost_scale_ = has_been_metric_ && !is_metric;
  return count_;
}

std::optional<Statustext> VerdictMonitor::update(Timestamp stamp, Verdict verdict) {
  const bool measured = is_measured(verdict);
  if (!since_ || measured != is_measured_) since_ = stamp;
  is_measured_ = measured;
  if (measured == !has_warned_ || seconds_between(*since_, stamp) < kLasting_s) return std::nullopt;
  has_warned_ = !measured;
  if (measured) return status_text(Severity::info, "vision: measured again");
  return status_text(Severity::warning,
                     fmt::format("vision: {} for {:.0f} s", name_of(verdict), kLasting_s));
}

std::optional<Statustext> VerdictMonitor::without_image(double silence_s) {
  if (has_warned_ || silence_s < kLasting_s) return std::nullopt;
  has_warned_ = true;
  is_measured_ = false;
  return status_text(Severity::warning, fmt::format("vision: no image for {:.0f} s", kLasting_s));
}

}  // namespace stillkite::mavlink
