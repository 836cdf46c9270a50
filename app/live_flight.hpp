#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/flight_estimator.hpp"
#include "app/flight_output.hpp"
#include "app/flight_page.hpp"
#include "app/flight_telemetry.hpp"
#include "app/latency_histogram.hpp"
#include "app/message_log.hpp"
#include "app/tether_control.hpp"
#include "io/video/luma.hpp"
#include "live/clock/local_clock.hpp"
#include "live/record/flight_record.hpp"
#include "live/stream/video_capture.hpp"

namespace stillkite {

/// One live flight: takes the newest image, passes it with the telemetry to the estimator, and its
/// result to ground station, outputs, page and record.
class LiveFlight {
 public:
  /// `source`: with the environment's variables. Throws InputError if a connection or file is
  /// missing; then there is no record.
  LiveFlight(const FlyConfig& config, const StreamConfig& source,
             const std::filesystem::path& folder);

  /// Estimates until the end of the input or Ctrl-C.
  void run();

  [[nodiscard]] bool has_images() const { return capture_->counts().decoded > 0; }
  [[nodiscard]] bool has_estimates() const { return used_ > 0; }

  void report_counts();

 private:
  [[nodiscard]] std::unique_ptr<TetherControl> make_tether(const LiveConfig& live);
  [[nodiscard]] std::unique_ptr<FlightPage> make_page(const LiveConfig& live);
  [[nodiscard]] std::function<void(const std::string&)> reporter();
  void report(const std::string& message);

  void receive_messages();
  void wait_for_telemetry(Timestamp stamp);
  void step(const CapturedFrame& captured);
  [[nodiscard]] bool is_ready(const CapturedFrame& captured, Timestamp decision);
  void publish(const CapturedFrame& captured, const PilotStep& result, double latency_s);
  [[nodiscard]] FlightStatus status() const;
  void report_record_failure();

  MessageLog log_;
  std::unique_ptr<TetherControl> tether_;  // forks before any thread starts
  FlightEstimator estimator_;
  std::unique_ptr<FlightPage> page_;  // before the record: a page that cannot start leaves none
  std::shared_ptr<LumaExtractor> luma_;
  FlightTelemetry telemetry_;
  FlightOutput output_;
  std::optional<FlightRecord> record_;
  LatencyHistogram latency_;
  std::int64_t used_ = 0, messages_ = 0;
  Timestamp last_image_ = local_now();
  bool has_reported_wait_ = false, has_reported_failure_ = false;
  std::optional<VideoCapture> capture_;  // last: its thread uses record_ and luma_
};

}  // namespace stillkite
