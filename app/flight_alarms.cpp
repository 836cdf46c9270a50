#include "app/flight_alarms.hpp"

#include <fmt/format.h>

namespace stillkite {
namespace {

// Reasons of a controller that works as intended.
bool is_regular(HoldReason reason) {
  switch (reason) {
    case HoldReason::none:
    case HoldReason::not_engaged:
    case HoldReason::stopped:
    case HoldReason::angle_first:
    case HoldReason::within_dead_band:
      return true;
    default:
      return false;
  }
}

bool is_of_station(HoldReason reason) {
  return reason == HoldReason::station_mode || reason == HoldReason::station_fault ||
         reason == HoldReason::station_silent;
}

void add_command_alarms(const PageState& state, std::vector<std::string>& alarms) {
  const FlightStatus& status = state.status;
  if (!status.has_station) return;
  if (!status.is_supervised) {
    alarms.emplace_back(
        "Supervising process has ended: nothing is commanded until the next flight");
  }
  if (status.is_stopped) alarms.emplace_back("Stopped: no commands for the rest of the flight");
  if (!state.newest) return;
  const HoldReason reason = state.newest->step.decision.reason;
  if (status.is_engaged && !is_regular(reason)) {
    alarms.push_back(fmt::format("Engaged, but {}", reason_words(reason)));
  } else if (!status.is_engaged && is_of_station(reason)) {
    alarms.push_back(fmt::format("Engage is not possible: {}", reason_words(reason)));
  }
}

void add_image_alarms(const PageState& state, Timestamp now, std::vector<std::string>& alarms) {
  constexpr double kMaxImageAge_s = 1;
  if (!state.newest) {
    alarms.emplace_back(state.status.is_waiting_for_telemetry
                            ? "Waiting for the telemetry of the initial state"
                            : "No image yet");
    return;
  }
  const PageSnapshot& newest = *state.newest;
  if (state.status.replay && state.status.replay->has_ended) {
    alarms.emplace_back("End of the record");
    return;
  }
  const double age_s = seconds_between(newest.estimated, now);
  if (age_s > kMaxImageAge_s) {
    alarms.push_back(fmt::format("No image for {:.0f} s", age_s));
    return;
  }
  const NavigationEstimate& estimate = newest.step.estimate;
  if (!is_measured(estimate.verdict)) {
    const std::string since =
        newest.measured
            ? fmt::format(" for {:.1f} s", seconds_between(*newest.measured, newest.estimated))
            : "";
    alarms.push_back(
        fmt::format("Motion not measured{}: {}", since, verdict_words(estimate.verdict)));
  }
  if (estimate.scale == ScaleSource::none) {
    alarms.emplace_back(is_in_heights(estimate) ? "No metric scale: lengths are in initial heights"
                                                : "No metric scale: speed and height are unknown");
  }
}

void add_rate_alarms(const PageState& state, std::vector<std::string>& alarms) {
  constexpr double kMaxDroppedRatio = 0.3, kMaxLatency_s = 0.2;
  const ImageRates rates = image_rates(state.samples);
  if (rates.dropped_ratio && *rates.dropped_ratio > kMaxDroppedRatio) {
    alarms.push_back(fmt::format("{:.0f} % of the images are dropped: the computer is too slow",
                                 100 * *rates.dropped_ratio));
  }
  if (state.newest && state.newest->latency_s > kMaxLatency_s) {
    alarms.push_back(fmt::format("Latency of {:.0f} ms", 1e3 * state.newest->latency_s));
  }
}

}  // namespace

const char* verdict_words(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "measured";
    case Verdict::first_frame:
      return "first image";
    case Verdict::still:
      return "camera at rest";
    case Verdict::too_little_texture:
      return "too little texture";
    case Verdict::too_few_inliers:
      return "no single motion fits the image";
    case Verdict::not_flat:
      return "ground is not flat";
    case Verdict::ill_conditioned:
      return "a direction of motion is not observable";
    case Verdict::horizon:
      return "too little ground below the horizon";
    case Verdict::frozen:
      return "repeated image";
    case Verdict::lost:
      return "alignment lost";
    case Verdict::time_gap:
      return "gap between images";
    case Verdict::gated:
      return "rotation rejected";
  }
  return "";
}

const char* reason_words(HoldReason reason) {
  switch (reason) {
    case HoldReason::none:
      return "position and yaw are controlled";
    case HoldReason::not_engaged:
      return "not engaged";
    case HoldReason::stopped:
      return "stopped";
    case HoldReason::station_mode:
      return "the ground station is in another mode";
    case HoldReason::station_fault:
      return "the ground station reports a fault";
    case HoldReason::station_silent:
      return "the ground station is silent";
    case HoldReason::not_measured:
      return "no image is measured";
    case HoldReason::estimator_silent:
      return "the estimator is silent";
    case HoldReason::estimator_ended:
      return "the estimator has ended";
    case HoldReason::no_estimate:
      return "there is no estimate";
    case HoldReason::estimate_lost:
      return "the motion is not measured";
    case HoldReason::estimate_gated:
      return "the rotation is rejected";
    case HoldReason::estimate_stale:
      return "the estimate is too old";
    case HoldReason::not_finite:
      return "a value is not finite";
    case HoldReason::no_tether_reading:
      return "there is no tether reading";
    case HoldReason::tether_stale:
      return "the tether reading is too old";
    case HoldReason::tether_slack:
      return "the tether is slack";
    case HoldReason::tether_out_of_range:
      return "the tether reading is out of range";
    case HoldReason::at_limit:
      return "length or elevation is at its limit";
    case HoldReason::angle_first:
      return "yaw is corrected first";
    case HoldReason::displacement_unknown:
      return "the displacement is unknown";
    case HoldReason::within_dead_band:
      return "in position";
  }
  return "";
}

std::vector<std::string> flight_alarms(const PageState& state, Timestamp now) {
  std::vector<std::string> alarms;
  add_command_alarms(state, alarms);
  add_image_alarms(state, now, alarms);
  add_rate_alarms(state, alarms);
  return alarms;
}

}  // namespace stillkite
