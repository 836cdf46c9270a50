#include "io/import/dataflash.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <utility>

#include "geometry/angle.hpp"
#include "io/import/aircraft_axes.hpp"
#include "io/import/dataflash_format.hpp"

namespace stillkite {
namespace {

constexpr std::uint8_t kFirst = 0xA3, kSecond = 0x95, kFormatMessage = 128;
constexpr std::size_t kFormatBytes = 89;

// Fields of one message.
struct Record {
  const DataflashLayout& layout;
  Bytes bytes;

  [[nodiscard]] std::optional<double> find(std::string_view field) const {
    return layout.number(bytes, field);
  }
  [[nodiscard]] double operator[](std::string_view field) const {
    return layout.number_or_zero(bytes, field);
  }
};

// Logs before 2015 have milliseconds; TimeMS of their GPS messages is the time of the GPS week.
std::optional<Timestamp> stamp_of(const Record& record) {
  std::optional<double> t_us = record.find("TimeUS");
  if (!t_us) {
    if (const auto t_ms = record.find(record.layout.name == "GPS" ? "T" : "TimeMS")) {
      t_us = 1000 * *t_ms;
    }
  }
  return t_us && *t_us >= 0 && *t_us < 9e15 ? from_microseconds(static_cast<std::uint64_t>(*t_us))
                                            : std::nullopt;
}

void log_imu(const Record& r, Timestamp stamp, ImportedFlight& flight) {
  append(flight.angular_rate_in_body_rad_s, stamp, flu_from_frd({r["GyrX"], r["GyrY"], r["GyrZ"]}),
         flight.rejected);
  append(flight.specific_force_in_body_m_s2, stamp, flu_from_frd({r["AccX"], r["AccY"], r["AccZ"]}),
         flight.rejected);
}

void log_attitude(const Record& r, Timestamp stamp, ImportedFlight& flight) {
  append(flight.attitude, stamp,
         enu_from_flu(r["Roll"] * kDegree, r["Pitch"] * kDegree, r["Yaw"] * kDegree),
         flight.rejected);
}

void log_position(const Record& r, Timestamp stamp, ImportedFlight& flight) {
  constexpr double kFix3d = 3;
  if (r["Status"] < kFix3d) return;
  append(
      flight.positions, stamp,
      GeodeticPosition{.latitude_deg = r["Lat"], .longitude_deg = r["Lng"], .altitude_m = r["Alt"]},
      flight.rejected);
  if (!r.find("VZ")) return;
  const double course_rad = r["GCrs"] * kDegree;  // clockwise from north
  append(
      flight.velocity_in_world_m_s, stamp,
      Eigen::Vector3d(r["Spd"] * std::sin(course_rad), r["Spd"] * std::cos(course_rad), -r["VZ"]),
      flight.rejected);
}

void log_height(const Record& r, Timestamp stamp, ImportedFlight& flight) {
  append(flight.height_m, stamp, r["Alt"], flight.rejected);
}

void log_range(const Record& r, Timestamp stamp, ImportedFlight& flight) {
  constexpr double kFacingDown = 25, kGood = 4;
  for (const char* orientation : {"Orient", "Orient1"}) {
    if (r.find(orientation).value_or(kFacingDown) != kFacingDown) return;
  }
  if (r.find("Stat").value_or(kGood) != kGood) return;
  const double range_m = r.find("Dist") ? r["Dist"] : r["Dist1"];
  if (range_m > 0) append(flight.range_m, stamp, range_m, flight.rejected);
}

class DataflashReader {
 public:
  explicit DataflashReader(const std::filesystem::path& file) : source_(file) {}

  ImportedFlight read() {
    layouts_[kFormatMessage].bytes = kFormatBytes;
    for (Bytes head; (head = source_.peek(3)).size() == 3;) {
      const std::size_t bytes =
          head[0] == kFirst && head[1] == kSecond ? layouts_[head[2]].bytes : 0;
      if (bytes == 0) {
        ++skipped_bytes_;
        source_.skip(1);
        continue;
      }
      const Bytes message = source_.peek(bytes);
      if (message.size() < bytes) {
        flight_.missing("end of the log: the last message is cut off");
        break;
      }
      take(message);
      source_.skip(bytes);
    }
    if (skipped_bytes_ > 0) {
      flight_.missing(fmt::format("{} bytes of the log are damaged", skipped_bytes_));
    }
    return std::move(flight_);
  }

 private:
  void take(Bytes message) {
    if (message[2] == kFormatMessage) {
      if (auto layout = read_dataflash_layout(message)) {
        layouts_[layout->first] = std::move(layout->second);
      }
      return;
    }
    const Record record{layouts_[message[2]], message};
    const std::string& name = record.layout.name;
    // first instance: since 2020 in I or Instance, before in the name (IMU2)
    if (record["I"] != 0 || record["Instance"] != 0) return;
    const std::optional<Timestamp> stamp = stamp_of(record);
    if (!stamp) return;
    if (name == "IMU") log_imu(record, *stamp, flight_);
    if (name == "ATT") log_attitude(record, *stamp, flight_);
    if (name == "GPS") log_position(record, *stamp, flight_);
    if (name == "BARO") log_height(record, *stamp, flight_);
    if (name == "RFND") log_range(record, *stamp, flight_);
  }

  ByteSource source_;
  std::array<DataflashLayout, 256> layouts_;
  std::uint64_t skipped_bytes_ = 0;
  ImportedFlight flight_;
};

}  // namespace

ImportedFlight read_dataflash(const std::filesystem::path& file) {
  return DataflashReader(file).read();
}

}  // namespace stillkite
