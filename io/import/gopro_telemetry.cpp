#include "io/import/gopro_telemetry.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "geometry/angle.hpp"
#include "io/import/gopro_orientation.hpp"

namespace stillkite {
namespace {

// Axes of the columns of models that do not record ORIN.
struct ModelAxes {
  std::string_view model;
  std::string_view axes;
};
constexpr std::array kModelAxes{ModelAxes{"Camera", "ZXY"},  // HERO5
                                ModelAxes{"Hero5", "ZXY"}, ModelAxes{"Hero6", "ZXY"},
                                ModelAxes{"Fusion", "yXZ"}};

std::optional<std::string_view> axes_of_model(std::string_view model) {
  for (const ModelAxes& entry : kModelAxes) {
    if (model.starts_with(entry.model)) return entry.axes;
  }
  return std::nullopt;
}

bool are_axes(std::string_view axes) {
  std::string sorted;
  for (const char c : axes)
    sorted += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::ranges::sort(sorted);
  return sorted == "XYZ";
}

// Columns on the axes x left, y backward, z up, to x forward, y left, z up.
Eigen::Vector3d in_body(const Eigen::Vector<double, 5>& columns, std::string_view axes) {
  Eigen::Vector3d v;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const char axis = axes[static_cast<std::size_t>(i)];
    const bool is_negative = std::islower(static_cast<unsigned char>(axis)) != 0;
    v[std::toupper(static_cast<unsigned char>(axis)) - 'X'] =
        is_negative ? -columns[i] : columns[i];
  }
  return {-v.y(), v.x(), v.z()};
}

void add_vectors(TimeSeries<Eigen::Vector3d>& series, const GoproStream& stream,
                 const std::vector<Timestamp>& stamps, std::string_view axes,
                 std::size_t& rejected) {
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    append(series, stamps[i], in_body(stream.samples[i], axes), rejected);
  }
}

void shift(std::vector<Timestamp>& stamps, double offset_s) {
  for (Timestamp& stamp : stamps) stamp.ns += from_seconds(offset_s).ns;
}

// Angle between the mean specific force and the mean direction opposite to gravity.
double gravity_disagreement_rad(const ImportedFlight& flight,
                                const TimeSeries<Eigen::Quaterniond>& attitude) {
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), up = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& f : flight.specific_force_in_body_m_s2.values) force += f;
  for (const Eigen::Quaterniond& q : attitude.values)
    up += q.conjugate() * Eigen::Vector3d::UnitZ();
  return std::acos(std::clamp(force.normalized().dot(up.normalized()), -1.0, 1.0));
}

}  // namespace

void GoproTelemetry::add(Bytes payload, Timestamp start, Timestamp end) {
  while (const std::optional<GpmfElement> element = take_gpmf(payload)) {
    if (element->key == "DEVC" && element->is_nested()) add_device(element->data, start, end);
  }
}

void GoproTelemetry::add_device(Bytes device, Timestamp start, Timestamp end) {
  while (const std::optional<GpmfElement> element = take_gpmf(device)) {
    if (element->key == "DVNM" && model_.empty()) model_ = element->text();
    if (element->key != "STRM" || !element->is_nested()) continue;
    const std::string_view key = samples_key(element->data);
    const auto* const found = std::ranges::find(kKeys, key);
    if (found == kKeys.end()) continue;
    append_samples(streams_[static_cast<std::size_t>(found - kKeys.begin())], element->data, key,
                   start, end);
  }
}

void GoproTelemetry::add_imu(ImportedFlight& flight, std::optional<Timestamp> origin) const {
  if (streams_[gyro].samples.empty() && streams_[accel].samples.empty()) return;
  std::string axes = streams_[gyro].axes;
  if (!are_axes(axes)) {
    const std::optional<std::string_view> known = axes_of_model(model_);
    axes = known.value_or("ZXY");
    flight.assumed(fmt::format("imu: axes {} of {}", axes,
                               known ? "the model" : "most models; this one's are unknown"));
  }
  const std::vector<Timestamp> rate_stamps = sample_stamps(streams_[gyro], origin);
  const std::vector<Timestamp> force_stamps = sample_stamps(streams_[accel], origin);
  add_vectors(flight.angular_rate_in_body_rad_s, streams_[gyro], rate_stamps, axes,
              flight.rejected);
  add_vectors(flight.specific_force_in_body_m_s2, streams_[accel], force_stamps, axes,
              flight.rejected);
}

void GoproTelemetry::add_positions(ImportedFlight& flight, std::optional<Timestamp> origin) const {
  const GoproStream& gps = streams_[streams_[gps9].samples.empty() ? gps5 : gps9];
  const std::vector<Timestamp> stamps = sample_stamps(gps, origin);
  std::size_t without_fix = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const Eigen::Vector<double, 5>& sample = gps.samples[i];
    if (std::isnan(sample[0])) {
      ++without_fix;
      continue;
    }
    append(flight.positions, stamps[i],
           GeodeticPosition{
               .latitude_deg = sample[0], .longitude_deg = sample[1], .altitude_m = sample[2]},
           flight.rejected);
  }
  if (without_fix > 0) {
    flight.missing(
        fmt::format("position: {} of {} samples without GNSS fix", without_fix, stamps.size()));
  }
}

ImportedFlight GoproTelemetry::finish() {
  ImportedFlight flight;
  constexpr double kWide_deg = 118;  // field of view 'wide' at 16:9
  flight.mount_down_deg = 0;
  flight.assumed("mount: the body is the camera (mount.down_deg: 0)");
  flight.horizontal_fov_deg = kWide_deg;
  flight.is_fisheye = true;
  if (!model_.empty()) flight.found("camera: GoPro, device name '" + model_ + "'");
  // camera's clock at the first frame
  const std::optional<Timestamp> origin = first_sensor_stamp(streams_[camera_orientation]);
  add_imu(flight, origin);
  add_positions(flight, origin);
  const GoproOrientation orientation = gopro_orientation(
      streams_[camera_orientation], streams_[image_orientation], streams_[gravity], origin);
  if (!orientation.empty()) {
    if (const auto offset_s = imu_clock_offset_s(orientation, flight.angular_rate_in_body_rad_s)) {
      shift(flight.angular_rate_in_body_rad_s.stamps, *offset_s);
      shift(flight.specific_force_in_body_m_s2.stamps, *offset_s);
      flight.found(fmt::format("imu: clock offset {:.0f} ms, by the orientations of the frames",
                               1e3 * *offset_s));
    }
    constexpr double kMaxDisagreement_rad = 0.35, kStabilized_rad = 0.02;
    const double rotation_rad = max_image_rotation_rad(orientation);
    const bool is_stabilized = rotation_rad > kStabilized_rad;
    if (flight.specific_force_in_body_m_s2.values.empty() ||
        gravity_disagreement_rad(flight, gopro_attitude(orientation, false)) <
            kMaxDisagreement_rad) {
      flight.attitude = gopro_attitude(orientation, is_stabilized);
    } else {
      flight.missing("attitude: gravity vector and accelerometer disagree; not used");
    }
    if (is_stabilized) {
      flight.assumed(fmt::format(
          "imu, attitude: rotated with the images, which electronic stabilization rotates by up to "
          "{:.1f} deg against the camera; lens and rolling shutter vary: switch it off",
          rotation_rad / kDegree));
      rotate_imu_with_image(orientation, flight);
    }
  }
  if (flight.angular_rate_in_body_rad_s.stamps.empty() && flight.positions.stamps.empty()) {
    throw InputError("the telemetry track has no gyroscope and no position");
  }
  return flight;
}

}  // namespace stillkite
