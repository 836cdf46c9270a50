#include "live/link/autopilot_link.hpp"

#include <utility>

#include "live/clock/local_clock.hpp"
#include "live/mavlink/system_messages.hpp"
#include "live/mavlink/vision_output.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMaxInbox = 20'000;  // 30 s of a fast link; the estimator takes them all
constexpr int kOrigins = 10;
constexpr std::uint8_t kInvalidAutopilot = 8;  // MAV_AUTOPILOT of other components

}  // namespace

AutopilotLink::AutopilotLink(const LinkAddress& address, std::uint8_t system_id,
                             const std::optional<std::array<double, 3>>& origin)
    : origin_(origin),
      sender_{.system = system_id},
      port_(
          address, "live.mavlink",
          [this](std::span<const std::uint8_t> bytes, Timestamp arrival) {
            receive(bytes, arrival);
          },
          [this] { tick(); }) {
  port_.start();
}

std::vector<ReceivedPacket> AutopilotLink::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(inbox_, {});
}

mavlink::ParserCounts AutopilotLink::counts() {
  const std::lock_guard lock(mutex_);
  return parser_.counts();
}

void AutopilotLink::receive(std::span<const std::uint8_t> bytes, Timestamp arrival) {
  std::vector<mavlink::Packet> packets;
  {
    const std::lock_guard lock(mutex_);
    parser_.add(bytes);
    while (const std::optional<mavlink::Packet> packet = parser_.next()) {
      packets.push_back(*packet);
      if (inbox_.size() < kMaxInbox) inbox_.push_back({*packet, arrival});
    }
  }
  for (const mavlink::Packet& packet : packets) answer(packet, arrival);
}

void AutopilotLink::answer(const mavlink::Packet& packet, Timestamp arrival) {
  if (const auto request = mavlink::decode<mavlink::Timesync>(packet);
      request && request->tc1 == 0) {
    send(mavlink::Timesync{.tc1 = arrival.ns,
                           .ts1 = request->ts1,
                           .target_system = packet.system,
                           .target_component = packet.component});
  }
  const auto heartbeat = mavlink::decode<mavlink::Heartbeat>(packet);
  if (!heartbeat || heartbeat->autopilot == kInvalidAutopilot) return;
  if (!std::exchange(has_heard_autopilot_, true)) origins_to_send_ = kOrigins;
}

void AutopilotLink::tick() {
  send(mavlink::heartbeat());
  send(mavlink::Timesync{.tc1 = 0, .ts1 = local_now().ns});
  if (!origin_ || origins_to_send_ == 0) return;
  --origins_to_send_;
  const auto& [latitude_deg, longitude_deg, altitude_m] = *origin_;
  send(mavlink::gps_origin(latitude_deg, longitude_deg, altitude_m, sender_.system));
}

}  // namespace stillkite
