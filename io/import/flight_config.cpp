#include "io/import/flight_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "geometry/angle.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

// In double quotes, for any name.
std::string quoted(const fs::path& file) {
  std::string out = "\"";
  for (const char c : file.string()) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// Path relative to the folder of flight.yaml.
std::string path_from(const fs::path& folder, const fs::path& file) {
  return quoted(fs::absolute(file).lexically_normal().lexically_proximate(
      fs::absolute(folder).lexically_normal()));
}

// Builds the text section by section.
class FlightYaml {
 public:
  FlightYaml(const Recording& recording, const ImportOptions& options,
             std::vector<ImportNote>& notes)
      : recording_(recording), flight_(recording.flight), options_(options), notes_(notes) {}

  void add_source(const fs::path& out) {
    if (recording_.image_topic) {
      text_ += "source:\n  path: .  # EuRoC data set: cam0\n";
      add_calibration(out, std::nullopt);
      return;
    }
    if (!recording_.video) {
      missing("video: stillkite run needs one; set source.path and calibration in flight.yaml");
      text_ += "# source: {path: video.mp4}  # missing\n";
      if (options_.calibration) add_calibration(out, std::nullopt);
      return;
    }
    const ImportedVideo& video = *recording_.video;
    found(fmt::format("video: {}, {}x{}{}", video.file.string(), video.width_px, video.height_px,
                      video.duration_s ? fmt::format(", {:.1f} s", *video.duration_s) : ""));
    text_ += fmt::format("source:\n  path: {}\n", path_from(out, video.file));
    add_calibration(out, ImageSize{video.width_px, video.height_px});
  }

  void add_mount() {
    constexpr double kDown_deg = 90;
    const double down_deg = flight_.mount_down_deg.value_or(kDown_deg);
    if (!flight_.mount_down_deg) {
      assumed("mount: the camera looks straight down, image top forward (mount.down_deg: 90)");
    }
    text_ +=
        fmt::format("mount:\n  down_deg: {:g}  # optical axis below the body's x axis\n", down_deg);
  }

  void add_initial_state(const TimeSeries<Vector6d>& imu) {
    const bool has_range = !flight_.range_m.stamps.empty();
    std::string keys;
    if (flight_.initial_height_m && !has_range) {
      assumed(fmt::format("initial height: {:.2f} m above the ground, as above the take-off point",
                          *flight_.initial_height_m));
      keys += fmt::format("  height_m: {:g}\n", *flight_.initial_height_m);
    } else if (!has_range) {
      missing("initial height: set initial.height_m; without it lengths are in initial heights");
      keys += "  # height_m:  # above the ground at the first image\n";
    }
    if (flight_.attitude.stamps.empty()) keys += initial_attitude(imu);
    if (!keys.empty()) text_ += "initial:\n" + keys;
  }

  void add_sensors(const TimeSeries<Vector6d>& imu) {
    if (is_fast(imu)) add_log("imu", "imu0/data.csv");
    if (!flight_.attitude.stamps.empty()) add_log("attitude", "attitude.csv");
    if (!flight_.range_m.stamps.empty()) {
      add_log("height", "range.csv", "range");
    } else if (!flight_.height_m.stamps.empty() && flight_.initial_height_m) {
      add_log("height", "height.csv", "barometer");
    }
  }

  void add_truth(const std::optional<LocalFrame>& frame) {
    if (!frame && flight_.velocity_in_world_m_s.stamps.empty()) return;
    text_ += "truth:  # GNSS, without attitude; x east, y north, z up\n";
    if (frame) {
      const GeodeticPosition& origin = frame->origin();
      const std::string where =
          fmt::format("latitude {:.7f} deg, longitude {:.7f} deg, altitude {:.3f} m",
                      origin.latitude_deg, origin.longitude_deg, origin.altitude_m);
      found("origin of the GNSS positions: " + where);
      text_ += "  positions: gnss_positions.csv  # origin: " + where + "\n";
    }
    if (!flight_.velocity_in_world_m_s.stamps.empty()) text_ += "  velocity: gnss_velocity.csv\n";
    add_offset();
  }

  void add_estimator(const TimeSeries<Vector6d>& imu) {
    if (imu.stamps.empty()) return;
    if (!is_fast(imu)) {
      missing("imu for policy fused: below 20 readings per second, not used by flight.yaml");
      return;
    }
    assumed("estimator: policy fused, for any scene; over flat ground set estimator.policy: flow");
    text_ += "estimator:\n  policy: fused\n";
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  // Telemetry at a few readings per second does not measure the motion between them.
  static bool is_fast(const TimeSeries<Vector6d>& imu) {
    constexpr double kMaxInterval_s = 0.05;
    const std::optional<double> interval_s = median_interval_s(imu.stamps);
    return interval_s && *interval_s <= kMaxInterval_s;
  }

  void found(std::string text) { note(ImportNote::Kind::found, std::move(text)); }
  void missing(std::string text) { note(ImportNote::Kind::missing, std::move(text)); }
  void assumed(std::string text) { note(ImportNote::Kind::assumed, std::move(text)); }
  void note(ImportNote::Kind kind, std::string text) { add_note(notes_, kind, std::move(text)); }

  struct ImageSize {
    int width_px, height_px;
  };

  // By the option, else of the recording, else assumed for images of a known size.
  void add_calibration(const fs::path& out, std::optional<ImageSize> size) {
    if (options_.calibration) {
      found("calibration: " + options_.calibration->string());
      text_ += fmt::format("calibration:\n  path: {}\n", path_from(out, *options_.calibration));
    } else if (flight_.camera) {
      found("calibration: in the recording");
      add_camera(*flight_.camera);
    } else if (size) {
      add_camera(assumed_camera(*size));
    } else {
      missing("calibration: --calibration FILE, or calibration.path in flight.yaml");
    }
  }

  void add_camera(const CameraConfig& camera) {
    text_ += fmt::format(
        "calibration:\n  camera:\n    width_px: {}\n    height_px: {}\n    focal_x_px: {:.9g}\n"
        "    focal_y_px: {:.9g}\n    centre_x_px: {:.9g}\n    centre_y_px: {:.9g}\n"
        "    distortion: {}\n    coefficients: [{:.9g}]\n",
        camera.width_px, camera.height_px, camera.focal_x_px, camera.focal_y_px, camera.centre_x_px,
        camera.centre_y_px, name_of(camera.distortion), fmt::join(camera.coefficients, ", "));
  }

  CameraConfig assumed_camera(ImageSize size) {
    constexpr double kUnknown_deg = 70;
    const bool is_given = options_.horizontal_fov_deg.has_value();
    const double fov_deg =
        is_given ? *options_.horizontal_fov_deg : flight_.horizontal_fov_deg.value_or(kUnknown_deg);
    const bool is_fisheye = flight_.is_fisheye && !is_given;
    const double half_rad = fov_deg / 2 * kDegree;
    const double focal_px =
        (is_fisheye ? 0.5 / half_rad : 0.5 / std::tan(half_rad)) * size.width_px;
    assumed(
        fmt::format("calibration: horizontal field of view {:.1f} deg {}, {} lens: scale errors of "
                    "10 % and more; "
                    "measure it (--calibration FILE)",
                    fov_deg,
                    is_given                     ? "as given"
                    : flight_.horizontal_fov_deg ? "by the camera's nominal values"
                                                 : "of an unknown camera (--horizontal-fov-deg)",
                    is_fisheye ? "equidistant" : "distortion-free"));
    return {.width_px = size.width_px,
            .height_px = size.height_px,
            .focal_x_px = focal_px,
            .focal_y_px = focal_px,
            .centre_x_px = 0.5 * (size.width_px - 1),
            .centre_y_px = 0.5 * (size.height_px - 1),
            .distortion = is_fisheye ? DistortionModel::equidistant : DistortionModel::none,
            .coefficients = std::vector<double>(is_fisheye ? 4 : 0)};
  }

  // Roll and pitch from the mean specific force of the first half second of the video.
  std::string initial_attitude(const TimeSeries<Vector6d>& imu) {
    constexpr double kMean_s = 0.5;
    const Timestamp start = from_seconds(-recording_.time_offset_s);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
      const double t_s = seconds_between(start, imu.stamps[i]);
      if (t_s >= 0 && t_s <= kMean_s) sum += imu.values[i].tail<3>();
    }
    if (sum.norm() == 0) {
      assumed("initial attitude: level (initial.pitch_deg, roll_deg)");
      return {};
    }
    const Eigen::Vector3d up = sum.normalized();  // of R = Rz Ry Rx: the last row
    const double pitch_deg = -std::asin(up.x()) / kDegree;
    const double roll_deg = std::atan2(up.y(), up.z()) / kDegree;
    assumed(
        fmt::format("initial attitude: pitch {:.1f} deg, roll {:.1f} deg by the accelerometer, at "
                    "rest or uniform "
                    "motion in the first {:g} s",
                    pitch_deg, roll_deg, kMean_s));
    return fmt::format("  pitch_deg: {:.2f}\n  roll_deg: {:.2f}\n", pitch_deg, roll_deg);
  }

  void add_log(const char* section, const char* file, const char* source = nullptr) {
    text_ += fmt::format("{}:\n", section);
    if (source != nullptr) text_ += fmt::format("  source: {}\n", source);
    text_ += fmt::format("  path: {}\n", file);
    add_offset();
  }

  void add_offset() {
    if (recording_.time_offset_s != 0) {
      text_ += fmt::format("  time_offset_s: {:.6f}\n", recording_.time_offset_s);
    }
  }

  const Recording& recording_;
  const ImportedFlight& flight_;
  const ImportOptions& options_;
  std::vector<ImportNote>& notes_;
  std::string text_ = "# Written by stillkite import; body: x forward, y left, z up\n";
};

}  // namespace

std::string flight_yaml(const Recording& recording, const ImportOptions& options,
                        const TimeSeries<Vector6d>& imu, const std::optional<LocalFrame>& frame,
                        const fs::path& out, std::vector<ImportNote>& notes) {
  FlightYaml yaml(recording, options, notes);
  yaml.add_source(out);
  yaml.add_mount();
  yaml.add_initial_state(imu);
  yaml.add_sensors(imu);
  yaml.add_truth(frame);
  yaml.add_estimator(imu);
  return yaml.text();
}

}  // namespace stillkite
