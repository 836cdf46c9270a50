#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "live/link/line_splitter.hpp"
#include "live/link/port.hpp"
#include "live/sensors/sensor_lines.hpp"

namespace stillkite {

/// Sensor line with its arrival on the local clock.
struct ReceivedSensorLine {
  std::string text;
  SensorLine line;
  Timestamp arrival;
};

struct SensorLinkCounts {
  std::int64_t lines = 0;
  std::int64_t rejected = 0;
  std::int64_t dropped = 0;   ///< lines that the estimator has not taken
  std::string first_problem;  ///< of a rejected line
};

/// Connection to the sender of sensor lines: a UDP port that listens, whose datagrams hold whole
/// lines, or a serial port. Its thread receives.
class SensorLink {
 public:
  /// `address`: udp://:PORT or serial:DEVICE:BAUD. Throws InputError that names live.telemetry.json
  /// for any other, and as Port.
  explicit SensorLink(const std::string& address);

  /// Lines since the last call, in the order of arrival.
  [[nodiscard]] std::vector<ReceivedSensorLine> take();

  [[nodiscard]] SensorLinkCounts counts();

 private:
  void receive(std::span<const std::uint8_t> bytes, Timestamp arrival);
  void reject(std::int64_t lines, const std::string& problem);

  bool is_datagram_;
  std::mutex mutex_;  // of inbox_ and counts_
  std::vector<ReceivedSensorLine> inbox_;
  SensorLinkCounts counts_;
  LineSplitter splitter_;
  std::int64_t overlong_ = 0;
  Port port_;  // last: its thread uses all other members
};

}  // namespace stillkite
