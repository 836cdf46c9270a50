#include "app/recorded_flight.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <utility>

#include "io/video/luma.hpp"
#include "live/operator/operator_command.hpp"
#include "live/sensors/sensor_lines.hpp"
#include "live/tether/station_lines.hpp"

namespace stillkite {
namespace {

FlightReplay::GreyOf grey_reader() {
  return [luma = std::make_shared<LumaExtractor>("source.path", std::nullopt)](const AVFrame& image,
                                                                               cv::Mat recycled) {
    return luma->extract(image, std::move(recycled));
  };
}

}  // namespace

bool is_flight_record(const std::filesystem::path& path) {
  return std::filesystem::is_directory(path) && std::filesystem::exists(path / kFlightConfig);
}

RecordedFlight::RecordedFlight(const std::filesystem::path& folder,
                               const std::vector<std::string>& overrides, Report report)
    : estimator_(load_fly_config(folder / kFlightConfig, overrides)),
      replay_(folder, grey_reader()),
      report_(std::move(report)) {}

std::optional<RecordedStep> RecordedFlight::next() {
  using Clock = std::chrono::steady_clock;
  std::optional<ReplayedFrame> replayed = replay_.next();
  if (!replayed) return std::nullopt;
  for (const RecordedMessage& message : replayed->telemetry) receive(message);
  const Clock::time_point start = Clock::now();
  PilotStep result = estimator_.step(replayed->frame, replayed->decision);
  const std::chrono::duration<float, std::milli> duration_ms = Clock::now() - start;
  return RecordedStep{.frame = std::move(replayed->frame),
                      .decision = replayed->decision,
                      .images = replayed->images,
                      .result = std::move(result),
                      .step_ms = duration_ms.count()};
}

void RecordedFlight::receive(const RecordedMessage& message) {
  const std::string text(message.bytes.begin(), message.bytes.end());
  switch (message.source) {
    case MessageSource::mavlink:
      parser_.add(message.bytes);
      while (const auto packet = parser_.next()) estimator_.receive(*packet, message.arrival);
      break;
    case MessageSource::station:
      if (const auto line = parse_station_line(text)) estimator_.receive(*line, message.arrival);
      break;
    case MessageSource::sensors:
      if (const auto parsed = parse_sensor_line(text); parsed.line) {
        estimator_.receive(*parsed.line, message.arrival);
      }
      break;
    case MessageSource::operator_command:
      if (const auto command = parse_operator_command(text, message.arrival)) {
        const auto refusal = estimator_.receive(*command);  // as in flight
        report_(fmt::format("operator: {}{}", text, refusal ? " refused: " + *refusal : ""));
      }
      break;
  }
}

}  // namespace stillkite
