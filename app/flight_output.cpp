#include "app/flight_output.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace stillkite {

FlightOutput::FlightOutput(const LiveConfig& live, AutopilotLink* autopilot, double max_gap_s,
                           Report report)
    : report_(std::move(report)) {
  if (live.json) json_.emplace(*live.json);
  if (autopilot != nullptr) autopilot_.emplace(*autopilot, live.send, max_gap_s);
}

void FlightOutput::send(const NavigationEstimate& estimate, const FlightInputs& inputs) {
  if (autopilot_) {
    autopilot_->send(estimate, inputs.body_from_camera, inputs.camera.focal_x_px);
  }
  send_json(estimate);
}

void FlightOutput::report_missing_images(double silence_s) {
  if (autopilot_) autopilot_->report_missing_images(silence_s);
}

void FlightOutput::report_counts() {
  if (!json_ || json_->dropped() == 0) return;
  report_(fmt::format("live.json: {} lines dropped: the reader of standard output is too slow",
                      json_->dropped()));
}

// Without a reader of the lines the flight continues only for the autopilot.
void FlightOutput::send_json(const NavigationEstimate& estimate) {
  if (!json_ || json_->send(estimate)) return;
  if (!autopilot_) throw std::runtime_error("live.json: standard output is closed");
  report_("live.json: standard output is closed; no further lines");
  json_.reset();
}

}  // namespace stillkite
