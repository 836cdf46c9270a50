#include "app/live_flight.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <thread>
#include <utility>

#include "app/interrupt.hpp"
#include "app/recorded_config.hpp"
#include "io/results/estimates_csv.hpp"

namespace stillkite {

LiveFlight::LiveFlight(const FlyConfig& config, const StreamConfig& source,
                       const std::filesystem::path& folder)
    : tether_(make_tether(config.live)),
      estimator_(config),
      page_(make_page(config.live)),
      luma_(std::make_shared<LumaExtractor>("source.path", std::nullopt)),
      telemetry_(config.live, reporter()),
      output_(config.live, telemetry_.autopilot(), config.navigator.trust.max_gap_s, reporter()) {
  check_recorded_files(config);
  record_.emplace(folder);
  write_recorded_config(config, folder);
  record_->add_estimate(estimates_csv_header());
  if (tether_) tether_->log_to(folder, *record_);
  capture_.emplace(
      source,
      [luma = luma_](const AVFrame& image, cv::Mat recycled) {
        return luma->extract(image, std::move(recycled));
      },
      reporter(), &*record_);
}

void LiveFlight::run() {
  constexpr double kWait_s = 0.1;  // Ctrl-C and telemetry without frames
  while (!interrupted() && !capture_->has_ended()) {
    const std::optional<CapturedFrame> captured = capture_->next(kWait_s);
    receive_messages();
    if (captured) {
      wait_for_telemetry(captured->frame.stamp);
      step(*captured);
      last_image_ = captured->arrival;
    } else {
      output_.report_missing_images(seconds_between(last_image_, local_now()));
    }
    telemetry_.report_changes();
    report_record_failure();
    if (page_) page_->publish(status());
  }
  if (capture_->failure()) std::rethrow_exception(capture_->failure());
}

void LiveFlight::report_counts() {
  const CaptureCounts counts = capture_->counts();
  report(fmt::format("{} images decoded, {} used, {} replaced by newer ones, {} rejected",
                     counts.decoded, used_, counts.replaced, counts.rejected));
  if (const auto median_ms = latency_.quantile_ms(0.5)) {
    report(fmt::format("arrival to estimate: {:.1f} ms (median), {:.1f} ms (99 %)", *median_ms,
                       *latency_.quantile_ms(0.99)));
  }
  output_.report_counts();
  if (tether_) report(tether_->counts());
  telemetry_.report_counts();
}

std::unique_ptr<TetherControl> LiveFlight::make_tether(const LiveConfig& live) {
  return live.tether.port ? std::make_unique<TetherControl>(live, reporter()) : nullptr;
}

std::unique_ptr<FlightPage> LiveFlight::make_page(const LiveConfig& live) {
  OperatorQueue* operators = tether_ ? &tether_->operators() : nullptr;
  return live.listen ? std::make_unique<FlightPage>(live, operators, log_, reporter()) : nullptr;
}

// To standard error and to the page; called on any thread.
void LiveFlight::report(const std::string& message) {
  std::fputs(fmt::format("stillkite: {}\n", message).c_str(), stderr);
  log_.add(local_now(), message);
}

std::function<void(const std::string&)> LiveFlight::reporter() {
  return [this](const std::string& message) { report(message); };
}

void LiveFlight::receive_messages() {
  if (tether_) messages_ += tether_->receive(estimator_, *record_);
  messages_ += telemetry_.receive(estimator_, *record_);
}

// Readings up to the frame's stamp, which may arrive after the frame.
void LiveFlight::wait_for_telemetry(Timestamp stamp) {
  constexpr std::chrono::milliseconds kStep{1};
  constexpr int kMaxSteps = 50;
  for (int i = 0; i < kMaxSteps && !estimator_.has_telemetry_until(stamp); ++i) {
    std::this_thread::sleep_for(kStep);
    receive_messages();
  }
}

void LiveFlight::step(const CapturedFrame& captured) {
  const Timestamp decision = local_now();
  if (!is_ready(captured, decision)) return;
  const PilotStep result = estimator_.step(captured.frame, decision);
  if (tether_) tether_->send(result, estimator_, *record_);
  output_.send(result.estimate, estimator_.inputs());
  const double latency_s = seconds_between(captured.arrival, local_now());
  latency_.add(1e3 * latency_s);
  record_->add_estimate(estimates_csv_row(result.estimate));
  ++used_;
  if (page_) publish(captured, result, latency_s);
}

// Records the image and whether the estimator uses it.
bool LiveFlight::is_ready(const CapturedFrame& captured, Timestamp decision) {
  const Frame& frame = captured.frame;
  const bool is_ready = estimator_.is_ready(frame.stamp);
  record_->add_frame({.index = frame.index,
                      .outcome = is_ready ? FrameOutcome::used : FrameOutcome::settling,
                      .stamp = frame.stamp,
                      .stamp_sigma_s = frame.stamp_sigma_s,
                      .telemetry = messages_,
                      .decision = decision});
  if (!is_ready && !std::exchange(has_reported_wait_, true)) {
    report("waiting for the telemetry of the initial state (live.telemetry, live.tether)");
  }
  return is_ready;
}

void LiveFlight::publish(const CapturedFrame& captured, const PilotStep& result, double latency_s) {
  const FlightInputs& inputs = estimator_.inputs();
  page_->publish({.step = result,
                  .grey = captured.frame.grey,
                  .flow_vectors =
                      page_->is_watched() ? estimator_.flow_vectors() : std::vector<WeightedFlow>(),
                  .camera = inputs.camera,
                  .body_from_camera = inputs.body_from_camera,
                  .estimated = local_now(),
                  .latency_s = latency_s},
                 status());
}

FlightStatus LiveFlight::status() const {
  const CommandGate& gate = estimator_.gate();
  return {.has_station = tether_ != nullptr,
          .is_supervised = !tether_ || tether_->is_supervised(),
          .is_engaged = gate.is_engaged(),
          .is_stopped = gate.is_stopped(),
          .is_waiting_for_telemetry = has_reported_wait_ && used_ == 0,
          .images = capture_->counts(),
          .used_images = used_};
}

void LiveFlight::report_record_failure() {
  if (has_reported_failure_) return;
  if (const auto failure = record_->failure()) {
    report(*failure);
    has_reported_failure_ = true;
  }
}

}  // namespace stillkite
