#include "app/fly_config.hpp"

#include <fmt/format.h>

#include <cmath>

#include "io/config/config_binding.hpp"
#include "io/text_file.hpp"
#include "live/page/page_address.hpp"
#include "live/tether/command_lines.hpp"

namespace stillkite {
namespace {

void check_estimator(const FlyConfig& config) {
  if (config.initial.from_truth) {
    throw InputError("initial.from_truth: a live flight has no truth; set initial.height_m");
  }
  const bool needs_imu = config.estimator.policy == Policy::fused &&
                         config.navigator.fusion.solver == FusionSolver::window;
  if (needs_imu && config.live.telemetry.imu == ImuMessage::none) {
    throw InputError(
        "fusion.solver: window needs an IMU; set live.telemetry.imu, or fusion.solver to filter");
  }
  const TelemetryConfig& telemetry = config.live.telemetry;
  if (telemetry.uses_mavlink() && !config.live.mavlink) {
    throw InputError("live.telemetry needs a link to the autopilot; set live.mavlink");
  }
  if (telemetry.uses_json() && !telemetry.json) {
    throw InputError(
        "live.telemetry needs the sensor lines' port; set live.telemetry.json, for example "
        "udp://:14600");
  }
  if (telemetry.json && !telemetry.uses_json()) {
    throw InputError(
        "live.telemetry.json: no sensor of it is used; set live.telemetry.imu or attitude to JSON, "
        "or height to JSON_RANGE or JSON_HEIGHT");
  }
  if (is_relative_height(telemetry.height) && !config.initial.height_m) {
    throw InputError(
        fmt::format("live.telemetry.height: {} is a relative height; set initial.height_m too",
                    name_of(telemetry.height)));
  }
}

void check_rate(double rate, double limit, const char* key) {
  if (rate <= limit) return;
  throw InputError(
      fmt::format("hold.limits.{}: {} exceeds the ground station's limit of {}", key, rate, limit));
}

void check_tether(const FlyConfig& config) {
  const LiveConfig& live = config.live;
  const bool reads_standard_input = live.operator_source == "-";
  if (reads_standard_input && config.source.path == "-") {
    throw InputError("live.operator: standard input is the video; set unix:PATH");
  }
  if (!live.tether.port) {
    if (!live.operator_source) return;
    throw InputError("live.operator needs a ground station; set live.tether.port");
  }
  if (live.telemetry.attitude != AttitudeMessage::none) {
    throw InputError(
        "live.telemetry.attitude: the ground station's !Attitude is used; set it to none");
  }
  const VehicleLimits& limits = config.hold.limits;
  check_rate(limits.elevation_rate_rad_s, kStationElevationRate_rad_s, "elevation_rate_rad_s");
  check_rate(limits.azimuth_rate_rad_s, kStationAzimuthRate_rad_s, "azimuth_rate_rad_s");
  check_rate(limits.yaw_rate_rad_s, kStationYawRate_rad_s, "yaw_rate_rad_s");
}

void check_page(const LiveConfig& live) {
  if (live.listen) {
    static_cast<void>(parse_page_address(*live.listen));
  } else if (live.public_host) {
    throw InputError("live.public_host needs the page; set live.listen");
  }
}

void check_origin(const std::array<double, 3>& origin) {
  const auto& [latitude_deg, longitude_deg, altitude_m] = origin;
  constexpr double kMaxAltitude_m = 1e5;
  if (std::abs(latitude_deg) <= 90 && std::abs(longitude_deg) <= 180 &&
      std::abs(altitude_m) <= kMaxAltitude_m) {
    return;
  }
  throw InputError(
      "live.send.origin: out of range; expected latitude [-90, 90] deg, longitude [-180, 180] deg, "
      "altitude [m]");
}

}  // namespace

FlyConfig load_fly_config(const std::optional<std::filesystem::path>& file,
                          const std::vector<std::string>& overrides) {
  const ConfigNode root = read_config(file, overrides);
  FlyConfig config = bind_config<FlyConfig>(root);
  const ConfigNode* source = root.find("source");
  const ConfigNode* path = source != nullptr ? source->find("path") : nullptr;
  if (path != nullptr && config.source.path.ends_with(".sdp")) {
    config.source.path = resolve_path(config.source.path, path->base_folder, path->where());
  }
  check_estimator(config);
  check_tether(config);
  check_page(config.live);
  if (config.live.send.origin) check_origin(*config.live.send.origin);
  return config;
}

RunConfig run_config_of(const FlyConfig& config) {
  RunConfig run;
  run.source.path = config.source.path;
  run.calibration = config.calibration;
  run.mount = config.mount;
  run.initial = config.initial;
  run.imu.rotation_wxyz = config.imu.rotation_wxyz;
  run.imu.noise = config.imu.noise;
  run.estimator = config.estimator;
  run.navigator = config.navigator;
  run.hold = config.hold;
  run.shadow.enabled = false;
  return run;
}

}  // namespace stillkite
