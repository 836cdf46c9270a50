#include "app/flight_telemetry.hpp"

#include <fmt/format.h>

#include <utility>

#include "live/clock/local_clock.hpp"

namespace stillkite {

std::optional<std::string> SilenceMonitor::change(Timestamp now) {
  constexpr double kSilence_s = 2;
  if (!last_) last_ = now;
  const bool is_silent = seconds_between(*last_, now) > kSilence_s;
  if (is_silent == std::exchange(is_silent_, is_silent)) return std::nullopt;
  return is_silent ? fmt::format("{}: no {} for {:.0f} s", link_, message_, kSilence_s)
                   : fmt::format("{}: connected", link_);
}

FlightTelemetry::FlightTelemetry(const LiveConfig& live, Report report)
    : report_(std::move(report)), system_id_(live.system_id) {
  if (live.mavlink) {
    autopilot_.emplace(parse_link_address(*live.mavlink, "live.mavlink"),
                       static_cast<std::uint8_t>(live.system_id), live.send.origin);
  }
  if (live.telemetry.json) sensors_.emplace(*live.telemetry.json);
}

std::int64_t FlightTelemetry::receive(FlightEstimator& estimator, FlightRecord& record) {
  std::int64_t recorded = 0;
  if (autopilot_) {
    for (const ReceivedPacket& received : autopilot_->take()) {
      autopilot_silence_.hear(received.arrival);
      check_system(received.packet);
      const auto bytes = received.packet.raw.bytes();
      record.add_message({.arrival = received.arrival, .bytes = {bytes.begin(), bytes.end()}});
      estimator.receive(received.packet, received.arrival);
      ++recorded;
    }
  }
  if (sensors_) {
    for (const ReceivedSensorLine& received : sensors_->take()) {
      sensor_silence_.hear(received.arrival);
      record.add_message({.arrival = received.arrival,
                          .bytes = {received.text.begin(), received.text.end()},
                          .source = MessageSource::sensors});
      estimator.receive(received.line, received.arrival);
      ++recorded;
    }
  }
  return recorded;
}

void FlightTelemetry::check_system(const mavlink::Packet& packet) {
  const bool is_other = packet.component == mavlink::kAutopilot && packet.system != system_id_;
  if (!is_other || std::exchange(has_reported_system_, true)) return;
  report_(fmt::format("MAVLink: autopilot of system {} is ignored; live.system_id is {}",
                      packet.system, system_id_));
}

void FlightTelemetry::report_changes() {
  const Timestamp now = local_now();
  if (autopilot_) {
    if (const auto change = autopilot_silence_.change(now)) report_(*change);
  }
  if (!sensors_) return;
  if (const auto change = sensor_silence_.change(now)) report_(*change);
  const SensorLinkCounts counts = sensors_->counts();
  if (counts.rejected > 0 && !std::exchange(has_reported_line_, true)) {
    report_("sensors: a line is rejected: " + counts.first_problem);
  }
}

void FlightTelemetry::report_counts() {
  if (autopilot_) {
    const mavlink::ParserCounts packets = autopilot_->counts();
    report_(
        fmt::format("MAVLink: {} packets read, {} of other messages, {} checksum errors, {} lost",
                    packets.packets, packets.unknown, packets.checksum_errors, packets.lost));
  }
  if (sensors_) {
    const SensorLinkCounts counts = sensors_->counts();
    report_(fmt::format("sensors: {} lines read, {} rejected, {} dropped", counts.lines,
                        counts.rejected, counts.dropped));
  }
}

}  // namespace stillkite
