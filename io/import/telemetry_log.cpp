#include "io/import/telemetry_log.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "geometry/gravity.hpp"
#include "io/import/aircraft_axes.hpp"
#include "io/import/mavlink_packet.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kStampBytes = 8;
constexpr int kRawImu = 1;  // rank of RAW_IMU

// Fields of a payload, in the wire order of MAVLink: by descending size.
struct Payload {
  Bytes bytes;

  template <typename T>
  [[nodiscard]] T at(std::size_t offset) const {
    return little_endian<T>(bytes, offset);
  }
  template <typename T>
  [[nodiscard]] Eigen::Vector3d vector_at(std::size_t offset) const {
    return {static_cast<double>(at<T>(offset)), static_cast<double>(at<T>(offset + sizeof(T))),
            static_cast<double>(at<T>(offset + 2 * sizeof(T)))};
  }
};

// Message types that measure the same quantity; the best one is kept.
struct BestRank {
  int rank = 0;  // 0: no message so far
};

template <typename Value>
bool prefers(BestRank& best, int rank, TimeSeries<Value>& series) {
  if (rank < best.rank) return false;
  if (rank > best.rank) series = {};
  best.rank = rank;
  return true;
}

class TelemetryReader {
 public:
  explicit TelemetryReader(const std::filesystem::path& file) : source_(file) {}

  ImportedFlight read() {
    for (Bytes record;
         (record = source_.peek(kStampBytes + kMaxMavlinkBytes)).size() > kStampBytes;) {
      const Bytes packet = record.subspan(kStampBytes);
      const std::size_t bytes = mavlink_packet_bytes(packet);
      if (bytes == 0) {
        ++skipped_bytes_;
        source_.skip(1);
        continue;
      }
      if (bytes > packet.size()) {
        flight_.missing("end of the log: the last packet is cut off");
        break;
      }
      if (const auto parsed = parse_mavlink(packet)) take(*parsed);
      source_.skip(kStampBytes + bytes);
    }
    if (skipped_bytes_ > 0) {
      flight_.missing(fmt::format("{} bytes of the log are damaged", skipped_bytes_));
    }
    if (imu_.rank == kRawImu) {
      flight_.assumed("imu: RAW_IMU in mrad/s and 9.80665e-3 m/s^2, as ArduPilot sends it");
    }
    if (!flight_.velocity_in_world_m_s.stamps.empty()) {
      flight_.assumed("GNSS velocity: the autopilot's estimate (GLOBAL_POSITION_INT)");
    }
    return std::move(flight_);
  }

 private:
  void take(const MavlinkPacket& packet) {
    const std::pair sender(packet.system, packet.component);
    if (!sender_) sender_ = sender;
    if (sender != *sender_) return;
    const Payload p{packet.payload};
    switch (packet.message) {
      case 105:
        if (begin(p.at<std::uint64_t>(0)))
          take_imu(3, p.vector_at<float>(20), p.vector_at<float>(8));
        break;
      case 26:
        if (begin_ms(p.at<std::uint32_t>(0))) take_raw_imu(2, p, 4);
        break;
      case 27:
        if (begin(p.at<std::uint64_t>(0))) take_raw_imu(kRawImu, p, 8);
        break;
      case 31:
        if (begin_ms(p.at<std::uint32_t>(0))) {
          take_attitude(2, enu_from_flu(Eigen::Quaterniond(p.at<float>(4), p.at<float>(8),
                                                           p.at<float>(12), p.at<float>(16))));
        }
        break;
      case 30:
        if (begin_ms(p.at<std::uint32_t>(0))) {
          take_attitude(1, enu_from_flu(p.at<float>(4), p.at<float>(8), p.at<float>(12)));
        }
        break;
      case 24:
        if (begin(p.at<std::uint64_t>(0))) take_position(p);
        break;
      case 33:
        if (begin_ms(p.at<std::uint32_t>(0))) {
          append(flight_.velocity_in_world_m_s, now_,
                 enu_from_ned(0.01 * p.vector_at<std::int16_t>(20)), flight_.rejected);
        }
        break;
      case 29:
        if (begin_ms(p.at<std::uint32_t>(0))) take_pressure(p.at<float>(4));
        break;
      case 132:
        if (begin_ms(p.at<std::uint32_t>(0))) take_distance(p);
        break;
      case 173:
        take_range(1, p.at<float>(0));
        break;
      default:
        break;
    }
  }

  // Sets the stamp of a message; false if it has none.
  bool begin(std::uint64_t t_us) {
    const std::optional<Timestamp> stamp = from_microseconds(t_us);
    if (stamp) now_ = *stamp;
    return stamp.has_value();
  }
  bool begin_ms(std::uint32_t t_ms) { return begin(std::uint64_t{1000} * t_ms); }

  void take_imu(int rank, const Eigen::Vector3d& rate_rad_s, const Eigen::Vector3d& force_m_s2) {
    if (rank > imu_.rank) flight_.specific_force_in_body_m_s2 = {};
    if (!prefers(imu_, rank, flight_.angular_rate_in_body_rad_s)) return;
    append(flight_.angular_rate_in_body_rad_s, now_, flu_from_frd(rate_rad_s), flight_.rejected);
    append(flight_.specific_force_in_body_m_s2, now_, flu_from_frd(force_m_s2), flight_.rejected);
  }

  // Accelerometer, then gyroscope, in thousandths; ArduPilot sends RAW_IMU in these units, too.
  void take_raw_imu(int rank, const Payload& p, std::size_t at) {
    take_imu(rank, 1e-3 * p.vector_at<std::int16_t>(at + 6),
             1e-3 * kGravity_m_s2 * p.vector_at<std::int16_t>(at));
  }

  void take_attitude(int rank, const Eigen::Quaterniond& attitude) {
    if (!prefers(attitude_, rank, flight_.attitude)) return;
    append(flight_.attitude, now_, attitude, flight_.rejected);
  }

  void take_position(const Payload& p) {
    constexpr std::uint8_t kFix3d = 3;
    if (p.at<std::uint8_t>(28) < kFix3d) return;
    append(flight_.positions, now_,
           GeodeticPosition{.latitude_deg = 1e-7 * p.at<std::int32_t>(8),
                            .longitude_deg = 1e-7 * p.at<std::int32_t>(12),
                            .altitude_m = 1e-3 * p.at<std::int32_t>(16)},
           flight_.rejected);
  }

  // Standard atmosphere up to 11 km.
  void take_pressure(double pressure_hPa) {
    constexpr double kSeaLevel_hPa = 1013.25;
    if (!(pressure_hPa > 100 && pressure_hPa < 1200)) return;
    append(flight_.height_m, now_,
           44330.77 * (1 - std::pow(pressure_hPa / kSeaLevel_hPa, 0.190263)), flight_.rejected);
  }

  void take_distance(const Payload& p) {
    constexpr std::uint8_t kFacingDown = 25;
    const auto least_cm = p.at<std::uint16_t>(4), most_cm = p.at<std::uint16_t>(6);
    const auto distance_cm = p.at<std::uint16_t>(8);
    if (p.at<std::uint8_t>(12) != kFacingDown) return;
    if (distance_cm < least_cm || distance_cm > most_cm) return;
    take_range(2, 0.01 * distance_cm);
  }

  void take_range(int rank, double range_m) {
    if (now_.ns == 0 || !(range_m > 0) || !prefers(range_, rank, flight_.range_m)) return;
    if (!flight_.range_m.stamps.empty() && flight_.range_m.stamps.back() == now_) return;
    append(flight_.range_m, now_, range_m, flight_.rejected);
  }

  ByteSource source_;
  std::optional<std::pair<std::uint8_t, std::uint8_t>> sender_;  // system, component
  Timestamp now_;
  BestRank imu_, attitude_, range_;
  std::uint64_t skipped_bytes_ = 0;
  ImportedFlight flight_;
};

}  // namespace

ImportedFlight read_telemetry_log(const std::filesystem::path& file) {
  return TelemetryReader(file).read();
}

}  // namespace stillkite
