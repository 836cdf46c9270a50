#include "live/sensors/sensor_link.hpp"

#include <fmt/format.h>

#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr const char* kSensorKey = "live.telemetry.json";
constexpr std::size_t kMaxSensorLine_bytes = 2048;
constexpr std::size_t kMaxSensorInbox = 20'000;  // 20 s at 1 kHz

LinkAddress sensor_address(const std::string& text) {
  const LinkAddress address = parse_link_address(text, kSensorKey);
  if (address.kind == LinkAddress::Kind::serial || address.host.empty()) return address;
  throw InputError(std::string(kSensorKey) + ": " + text +
                   " is no port of this machine; expected udp://:PORT or serial:DEVICE:BAUD");
}

}  // namespace

SensorLink::SensorLink(const std::string& address)
    : is_datagram_(parse_link_address(address, kSensorKey).kind == LinkAddress::Kind::udp),
      splitter_(kMaxSensorLine_bytes),
      port_(
          sensor_address(address), kSensorKey,
          [this](std::span<const std::uint8_t> bytes, Timestamp arrival) {
            receive(bytes, arrival);
          },
          [] {}) {
  port_.start();
}

std::vector<ReceivedSensorLine> SensorLink::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(inbox_, {});
}

SensorLinkCounts SensorLink::counts() {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void SensorLink::receive(std::span<const std::uint8_t> bytes, Timestamp arrival) {
  splitter_.add({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (is_datagram_) splitter_.add(std::string_view("\n"));
  while (std::optional<std::string> text = splitter_.next()) {
    ParsedSensorLine parsed = parse_sensor_line(*text);
    const std::lock_guard lock(mutex_);
    if (!parsed.line) {
      reject(1, parsed.problem);
    } else if (inbox_.size() == kMaxSensorInbox) {
      ++counts_.dropped;
    } else {
      ++counts_.lines;
      inbox_.push_back({std::move(*text), std::move(*parsed.line), arrival});
    }
  }
  const std::int64_t overlong = splitter_.dropped() - overlong_;
  if (overlong == 0) return;
  overlong_ += overlong;
  const std::lock_guard lock(mutex_);
  reject(overlong, fmt::format("more than {} bytes", kMaxSensorLine_bytes));
}

// With the mutex locked.
void SensorLink::reject(std::int64_t lines, const std::string& problem) {
  if (counts_.rejected == 0) counts_.first_problem = problem;
  counts_.rejected += lines;
}

}  // namespace stillkite
