#include "io/import/ulog.hpp"

#include <fmt/core.h>

#include <array>
#include <string>
#include <string_view>
#include <unordered_map>

#include "io/import/aircraft_axes.hpp"
#include "io/import/byte_source.hpp"
#include "io/import/ulog_format.hpp"

namespace stillkite {
namespace {

std::string_view as_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<Eigen::Vector3d> vector_of(const UlogLayout& layout, Bytes message,
                                         std::string_view name) {
  Eigen::Vector3d out;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> value = layout.number(message, name, i);
    if (!value) return std::nullopt;
    out[i] = *value;
  }
  return out;
}

// Time of the measurement, else of its publication.
std::optional<Timestamp> stamp_of(const UlogLayout& layout, Bytes message) {
  std::optional<std::uint64_t> t_us = layout.integer(message, "timestamp_sample");
  if (!t_us || *t_us == 0) t_us = layout.integer(message, "timestamp");
  return t_us ? from_microseconds(*t_us) : std::nullopt;
}

using Topic = void (*)(const UlogLayout&, Bytes, Timestamp, ImportedFlight&);

void add_imu(const UlogLayout& layout, Bytes message, Timestamp stamp, ImportedFlight& flight) {
  constexpr double kInvalid = -2147483648.0;  // no accelerometer reading
  const auto rate = vector_of(layout, message, "gyro_rad");
  const auto force = vector_of(layout, message, "accelerometer_m_s2");
  if (!rate || !force) return;
  append(flight.angular_rate_in_body_rad_s, stamp, flu_from_frd(*rate), flight.rejected);
  const double late_us =
      layout.number(message, "accelerometer_timestamp_relative").value_or(kInvalid);
  if (late_us == kInvalid) return;
  append(flight.specific_force_in_body_m_s2,
         Timestamp{stamp.ns + static_cast<std::int64_t>(late_us) * 1000}, flu_from_frd(*force),
         flight.rejected);
}

void add_attitude(const UlogLayout& layout, Bytes message, Timestamp stamp,
                  ImportedFlight& flight) {
  std::array<double, 4> q{};
  for (std::size_t i = 0; i < 4; ++i) q[i] = layout.number(message, "q", i).value_or(0);
  append(flight.attitude, stamp, enu_from_flu(Eigen::Quaterniond(q[0], q[1], q[2], q[3])),
         flight.rejected);
}

void add_position(const UlogLayout& layout, Bytes message, Timestamp stamp,
                  ImportedFlight& flight) {
  constexpr double kFix3d = 3;
  if (layout.number(message, "fix_type").value_or(0) < kFix3d) return;
  // since PX4 1.14 in deg and m, before in 1e-7 deg and mm
  const auto read = [&](const char* now, const char* before, double unit) {
    if (const auto value = layout.number(message, now)) return *value;
    return unit * layout.number(message, before).value_or(0);
  };
  append(flight.positions, stamp,
         GeodeticPosition{.latitude_deg = read("latitude_deg", "lat", 1e-7),
                          .longitude_deg = read("longitude_deg", "lon", 1e-7),
                          .altitude_m = read("altitude_msl_m", "alt", 1e-3)},
         flight.rejected);
  if (layout.number(message, "vel_ned_valid").value_or(0) == 0) return;
  const auto component = [&](const char* name) { return layout.number(message, name).value_or(0); };
  append(flight.velocity_in_world_m_s, stamp,
         enu_from_ned({component("vel_n_m_s"), component("vel_e_m_s"), component("vel_d_m_s")}),
         flight.rejected);
}

void add_height(const UlogLayout& layout, Bytes message, Timestamp stamp, ImportedFlight& flight) {
  if (const auto height_m = layout.number(message, "baro_alt_meter")) {
    append(flight.height_m, stamp, *height_m, flight.rejected);
  }
}

void add_range(const UlogLayout& layout, Bytes message, Timestamp stamp, ImportedFlight& flight) {
  constexpr double kFacingDown = 25;
  const auto range_m = layout.number(message, "current_distance");
  if (!range_m || layout.number(message, "orientation") != kFacingDown) return;
  if (layout.number(message, "signal_quality") == 0) return;
  if (*range_m < layout.number(message, "min_distance").value_or(0) ||
      *range_m > layout.number(message, "max_distance").value_or(1e5)) {
    return;
  }
  append(flight.range_m, stamp, *range_m, flight.rejected);
}

Topic topic_of(std::string_view name) {
  if (name == "sensor_combined") return add_imu;
  if (name == "vehicle_attitude") return add_attitude;
  if (name == "vehicle_gps_position" || name == "sensor_gps") return add_position;
  if (name == "vehicle_air_data") return add_height;
  if (name == "distance_sensor") return add_range;
  return nullptr;
}

struct Subscription {
  Topic topic;
  UlogLayout layout;
};

class UlogReader {
 public:
  explicit UlogReader(const std::filesystem::path& file) : source_(file) {}

  ImportedFlight read() {
    constexpr std::size_t kFileHeader = 16, kMessageHeader = 3;
    source_.skip(kFileHeader);
    for (Bytes head; (head = source_.peek(kMessageHeader)).size() == kMessageHeader;) {
      const std::size_t size = little_endian<std::uint16_t>(head, 0);
      const char type = static_cast<char>(head[2]);
      source_.skip(kMessageHeader);
      const Bytes message = source_.peek(size);
      if (message.size() < size) {
        flight_.missing("end of the log: the last message is cut off");
        break;
      }
      take(type, message);
      source_.skip(size);
    }
    if (unknown_messages_ > 0) {
      flight_.missing(fmt::format("{} messages of unknown type: parts of the log are damaged",
                                  unknown_messages_));
    }
    if (dropout_ms_ > 0) {
      flight_.missing(
          fmt::format("{} ms of the log: the autopilot could not write fast enough", dropout_ms_));
    }
    return std::move(flight_);
  }

 private:
  void take(char type, Bytes message) {
    constexpr std::string_view kTypes = "BFIMPQARDLCSO";  // of the format's definition
    if (type == 'F') {
      formats_.add(as_text(message));
    } else if (type == 'A' && message.size() > 3) {
      subscribe(message);
    } else if (type == 'O') {
      dropout_ms_ += little_endian<std::uint16_t>(message, 0);
    } else if (type == 'D' && message.size() > 2) {
      const auto found = subscriptions_.find(little_endian<std::uint16_t>(message, 0));
      if (found == subscriptions_.end()) return;
      const Subscription& subscription = found->second;
      const Bytes data = message.subspan(2);
      if (const auto stamp = stamp_of(subscription.layout, data)) {
        subscription.topic(subscription.layout, data, *stamp, flight_);
      }
    } else if (kTypes.find(type) == std::string_view::npos) {
      ++unknown_messages_;
    }
  }

  // Instance, number and name of a topic. Of the two names of the GNSS receiver the first is read.
  void subscribe(Bytes message) {
    const std::string_view name = as_text(message.subspan(3));
    const Topic topic = topic_of(name);
    if (topic == nullptr) return;
    const std::uint16_t id = little_endian<std::uint16_t>(message, 1);
    for (const auto& [other, subscription] : subscriptions_) {
      if (subscription.topic == topic && topic != add_range) return;
    }
    if (message[0] != 0 && topic != add_range) return;
    if (std::optional<UlogLayout> layout = formats_.layout(name)) {
      subscriptions_.insert_or_assign(id, Subscription{topic, std::move(*layout)});
    }
  }

  ByteSource source_;
  UlogFormats formats_;
  std::unordered_map<std::uint16_t, Subscription> subscriptions_;
  std::uint64_t dropout_ms_ = 0, unknown_messages_ = 0;
  ImportedFlight flight_;
};

}  // namespace

ImportedFlight read_ulog(const std::filesystem::path& file) {
  return UlogReader(file).read();
}

}  // namespace stillkite
