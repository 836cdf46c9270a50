#include "live/sensors/sensor_lines.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

// Why a value is rejected.
struct Rejected {
  std::string reason;
};

std::optional<double> finite_number(const json& value, const Range& range) {
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  return std::isfinite(number) && range.contains(number) ? std::optional(number) : std::nullopt;
}

double number_of(const char* key, const json& value, const Range& range) {
  if (const auto number = finite_number(value, range)) return *number;
  throw Rejected{fmt::format("{}: expected a number in [{}, {}]", key, range.min, range.max)};
}

template <std::size_t N>
std::array<double, N> numbers_of(const char* key, const json& value, double max) {
  std::array<double, N> out{};
  bool is_valid = value.is_array() && value.size() == N;
  for (std::size_t i = 0; is_valid && i < N; ++i) {
    const auto number = finite_number(value[i], {-max, max});
    is_valid = number.has_value();
    out[i] = number.value_or(0);
  }
  if (!is_valid) throw Rejected{fmt::format("{}: expected {} numbers within +-{}", key, N, max)};
  return out;
}

Eigen::Vector3d vector_of(const char* key, const json& value, double max) {
  return Eigen::Vector3d(numbers_of<3>(key, value, max).data());
}

Eigen::Quaterniond attitude_of(const json& value) {
  constexpr double kMaxNormError = 0.05;
  const auto [w, x, y, z] = numbers_of<4>("attitude", value, 1 + kMaxNormError);
  const Eigen::Quaterniond q(w, x, y, z);
  if (std::abs(q.norm() - 1) < kMaxNormError) return q.normalized();
  throw Rejected{"attitude: expected a unit quaternion w, x, y, z"};
}

std::int64_t timestamp_of(const json& value) {
  constexpr std::int64_t kMax_ns = std::int64_t{1} << 62;  // differences do not overflow
  if (value.is_number_integer()) {
    const auto ns = value.get<std::int64_t>();
    if (ns >= 0 && ns < kMax_ns) return ns;
  }
  throw Rejected{"timestamp: expected a whole number of nanoseconds in [0, 2^62)"};
}

SensorLine line_of(const json& object) {
  constexpr double kMaxRate_rad_s = 100, kMaxForce_m_s2 = 1000, kMaxHeight_m = 1e5;
  SensorLine out;
  std::optional<Eigen::Vector3d> rate, force;
  bool has_schema = false;
  for (const auto& [key, value] : object.items()) {
    if (key == "schema") {
      has_schema = value == kSensorSchema;
    } else if (key == "timestamp") {
      out.sender_ns = timestamp_of(value);
    } else if (key == "angular_rate") {
      rate = vector_of("angular_rate", value, kMaxRate_rad_s);
    } else if (key == "specific_force") {
      force = vector_of("specific_force", value, kMaxForce_m_s2);
    } else if (key == "attitude") {
      out.world_from_body = attitude_of(value);
    } else if (key == "range") {
      out.range_m = number_of("range", value, {0, kMaxHeight_m});
    } else if (key == "height") {
      out.height_m = number_of("height", value, {-kMaxHeight_m, kMaxHeight_m});
    } else {
      throw Rejected{
          "unknown key; known: schema, timestamp, angular_rate, specific_force, attitude, range, "
          "height"};
    }
  }
  if (!has_schema) throw Rejected{fmt::format("expected \"schema\": {}", kSensorSchema)};
  if (rate.has_value() != force.has_value()) {
    throw Rejected{"angular_rate and specific_force belong together"};
  }
  if (rate) out.imu = {.angular_rate_in_body_rad_s = *rate, .specific_force_in_body_m_s2 = *force};
  if (!out.imu && !out.world_from_body && !out.range_m && !out.height_m) {
    throw Rejected{"no reading"};
  }
  return out;
}

}  // namespace

ParsedSensorLine parse_sensor_line(std::string_view text) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) return {.line = std::nullopt, .problem = "no JSON object"};
  try {
    return {.line = line_of(object), .problem = {}};
  } catch (Rejected& rejected) {
    return {.line = std::nullopt, .problem = std::move(rejected.reason)};
  }
}

std::vector<SensorSample> SensorLineReader::read(const SensorLine& line, Timestamp arrival) {
  const Timestamp stamp = line.sender_ns ? clock_.map(*line.sender_ns, arrival).stamp : arrival;
  std::vector<SensorSample> out;
  if (config_.imu == ImuMessage::json && line.imu && is_newer(stamp, last_imu_)) {
    out.emplace_back(
        ImuSample{.stamp = stamp,
                  .angular_rate_in_body_rad_s = line.imu->angular_rate_in_body_rad_s,
                  .specific_force_in_body_m_s2 = line.imu->specific_force_in_body_m_s2});
  }
  if (config_.attitude == AttitudeMessage::json && line.world_from_body &&
      is_newer(stamp, last_attitude_)) {
    out.emplace_back(AttitudeSample{.stamp = stamp, .world_from_body = *line.world_from_body});
  }
  const std::optional<double> height_m = config_.height == HeightMessage::json_range ? line.range_m
                                         : config_.height == HeightMessage::json_height
                                             ? line.height_m
                                             : std::nullopt;
  if (height_m && is_newer(stamp, last_height_)) {
    out.emplace_back(HeightSample{.stamp = stamp, .height_m = *height_m});
  }
  return out;
}

}  // namespace stillkite
