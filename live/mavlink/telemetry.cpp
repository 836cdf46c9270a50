#include "live/mavlink/telemetry.hpp"

#include <cmath>

#include "live/mavlink/axes.hpp"
#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"

namespace stillkite::mavlink {
namespace {

constexpr std::uint8_t kDown = 25;  // MAV_SENSOR_ROTATION_PITCH_270
constexpr double kGravity_m_s2 = 9.80665;
constexpr std::int64_t kNsPerMs = 1'000'000, kNsPerUs = 1000;
constexpr std::uint64_t kMaxTime_us = 1ULL << 52;  // since 1970, until 2112

struct RawSample {
  std::int64_t sender_ns = 0;
  bool is_boot_ms = false;
  Eigen::Vector3d rate_rad_s, force_m_s2;  // forward, right, down
};

// mrad/s and mG.
template <typename M>
RawSample scaled_sample(const M& message, std::int64_t sender_ns, bool is_boot_ms) {
  return {sender_ns, is_boot_ms,
          1e-3 * Eigen::Vector3d(message.xgyro, message.ygyro, message.zgyro),
          1e-3 * kGravity_m_s2 * Eigen::Vector3d(message.xacc, message.yacc, message.zacc)};
}

template <typename M>
std::optional<RawSample> scaled_imu(const Packet& packet) {
  const auto message = decode<M>(packet);
  if (!message) return std::nullopt;
  return scaled_sample(*message, kNsPerMs * message->time_boot_ms, true);
}

std::optional<RawSample> raw_imu(const Packet& packet) {
  const auto message = decode<RawImu>(packet);
  if (!message || message->time_usec > kMaxTime_us) return std::nullopt;
  return scaled_sample(*message, kNsPerUs * static_cast<std::int64_t>(message->time_usec), false);
}

std::optional<RawSample> highres_imu(const Packet& packet) {
  const auto message = decode<HighresImu>(packet);
  if (!message || message->time_usec > kMaxTime_us) return std::nullopt;
  return RawSample{kNsPerUs * static_cast<std::int64_t>(message->time_usec), false,
                   Eigen::Vector3d(message->xgyro, message->ygyro, message->zgyro),
                   Eigen::Vector3d(message->xacc, message->yacc, message->zacc)};
}

std::optional<RawSample> imu_of(const Packet& packet, ImuMessage kind) {
  switch (kind) {
    case ImuMessage::highres:
      return highres_imu(packet);
    case ImuMessage::scaled:
      return scaled_imu<ScaledImu>(packet);
    case ImuMessage::scaled2:
      return scaled_imu<ScaledImu2>(packet);
    case ImuMessage::scaled3:
      return scaled_imu<ScaledImu3>(packet);
    case ImuMessage::raw:
      return raw_imu(packet);
    case ImuMessage::json:
    case ImuMessage::none:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<SensorSample> Telemetry::read(const Packet& packet, Timestamp arrival) {
  if (packet.system != system_id_ || packet.component != kAutopilot) return std::nullopt;
  update_round_trip(packet, arrival);
  if (auto sample = read_imu(packet, arrival)) return sample;
  if (auto sample = read_attitude(packet, arrival)) return sample;
  return read_height(packet, arrival);
}

void Telemetry::update_round_trip(const Packet& packet, Timestamp arrival) {
  constexpr std::int64_t kMax_ns = 1'000'000'000;
  const auto reply = decode<Timesync>(packet);
  if (!reply || reply->tc1 == 0) return;
  // a reply to another component has any ts1
  if (reply->ts1 >= arrival.ns || reply->ts1 < arrival.ns - kMax_ns) return;
  const std::int64_t round_trip_ns = arrival.ns - reply->ts1;
  if (round_trip_ns_ == 0 || round_trip_ns < round_trip_ns_) round_trip_ns_ = round_trip_ns;
}

Timestamp Telemetry::stamp_of(ClockMap& clock, std::int64_t sender_ns, Timestamp arrival) const {
  return {clock.map(sender_ns, arrival).stamp.ns - round_trip_ns_ / 2};
}

std::optional<SensorSample> Telemetry::read_imu(const Packet& packet, Timestamp arrival) {
  const std::optional<RawSample> raw = imu_of(packet, config_.imu);
  if (!raw || !raw->rate_rad_s.allFinite() || !raw->force_m_s2.allFinite()) return std::nullopt;
  ClockMap& clock = raw->is_boot_ms ? boot_clock_ : usec_clock_;
  const Timestamp stamp = stamp_of(clock, raw->sender_ns, arrival);
  if (!is_newer(stamp, last_imu_)) return std::nullopt;
  return ImuSample{.stamp = stamp,
                   .angular_rate_in_body_rad_s = flip_axes(raw->rate_rad_s),
                   .specific_force_in_body_m_s2 = flip_axes(raw->force_m_s2)};
}

std::optional<SensorSample> Telemetry::read_attitude(const Packet& packet, Timestamp arrival) {
  if (config_.attitude != AttitudeMessage::quaternion) return std::nullopt;
  const auto message = decode<AttitudeQuaternion>(packet);
  if (!message) return std::nullopt;
  const Eigen::Quaterniond q(message->q1, message->q2, message->q3, message->q4);
  constexpr double kMaxNormError = 0.05;
  if (!(std::abs(q.norm() - 1) < kMaxNormError)) return std::nullopt;
  const Timestamp stamp = stamp_of(boot_clock_, kNsPerMs * message->time_boot_ms, arrival);
  if (!is_newer(stamp, last_attitude_)) return std::nullopt;
  return AttitudeSample{.stamp = stamp, .world_from_body = flip_axes(q.normalized())};
}

std::optional<SensorSample> Telemetry::read_height(const Packet& packet, Timestamp arrival) {
  double height_m = 0;
  std::int64_t sender_ns = 0;
  if (config_.height == HeightMessage::distance_sensor) {
    const auto message = decode<DistanceSensor>(packet);
    constexpr std::uint8_t kInvalidSignal = 1;
    if (!message || message->orientation != kDown || message->signal_quality == kInvalidSignal) {
      return std::nullopt;
    }
    // outside its range the sensor has no echo
    if (message->current_distance <= message->min_distance ||
        message->current_distance >= message->max_distance) {
      return std::nullopt;
    }
    height_m = 0.01 * message->current_distance;
    sender_ns = kNsPerMs * message->time_boot_ms;
  } else if (config_.height == HeightMessage::global_position) {
    const auto message = decode<GlobalPositionInt>(packet);
    if (!message) return std::nullopt;
    height_m = 1e-3 * message->relative_alt;
    sender_ns = kNsPerMs * message->time_boot_ms;
  } else {
    return std::nullopt;
  }
  const Timestamp stamp = stamp_of(boot_clock_, sender_ns, arrival);
  if (!is_newer(stamp, last_height_)) return std::nullopt;
  return HeightSample{.stamp = stamp, .height_m = height_m};
}

}  // namespace stillkite::mavlink
