#include "io/import/flight_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/dataset/calibration.hpp"
#include "io/import/calibration_section.hpp"

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

// Path relative to the folder of flight.yaml; absolute if a link leads to the folder, whose ".." is
// elsewhere.
std::string path_from(const fs::path& folder, const fs::path& file) {
  const fs::path from = fs::absolute(folder).lexically_normal();
  const fs::path to = fs::absolute(file).lexically_normal();
  return quoted(fs::weakly_canonical(from) == from ? to.lexically_proximate(from) : to);
}

// Builds the text section by section.
class FlightYaml {
 public:
  FlightYaml(const Recording& recording, const ImportOptions& options, const FlightFiles& files,
             std::vector<ImportNote>& notes)
      : recording_(recording),
        flight_(recording.flight),
        options_(options),
        files_(files),
        notes_(notes) {}

  void add_source(const fs::path& out) {
    if (recording_.image_topic) {
      text_ += "source:\n  path: .  # EuRoC data set: cam0\n";
      add_calibration(out);
      return;
    }
    if (!recording_.video) {
      missing("video: stillkite run needs one; set source.path and calibration in flight.yaml");
      text_ += "# source: {path: video.mp4}  # missing\n";
      if (options_.calibration) add_calibration(out);
      return;
    }
    const ImportedVideo& video = *recording_.video;
    found(fmt::format("video: {}, {}x{}{}", video.file.string(), video.width_px, video.height_px,
                      video.duration_s ? fmt::format(", {:.1f} s", *video.duration_s) : ""));
    text_ += fmt::format("source:\n  path: {}\n", path_from(out, video.file));
    add_calibration(out);
  }

  void add_mount() {
    if (!flight_.mount_down_deg && options_.calibration &&
        read_calibration(*options_.calibration).body_from_camera) {
      found("mount: extrinsics of the calibration");
      return;
    }
    constexpr double kDown_deg = 90;
    const double down_deg = flight_.mount_down_deg.value_or(kDown_deg);
    if (!flight_.mount_down_deg) {
      assumed("mount: the camera looks straight down, image top forward (mount.down_deg: 90)");
    }
    text_ +=
        fmt::format("mount:\n  down_deg: {:g}  # optical axis below the body's x axis\n", down_deg);
  }

  void add_initial_state() {
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
    if (flight_.attitude.stamps.empty()) keys += initial_attitude();
    if (!keys.empty()) text_ += "initial:\n" + keys;
  }

  void add_sensors() {
    if (is_fast(files_.imu)) add_log("imu", "imu0/data.csv");
    if (!flight_.attitude.stamps.empty()) add_log("attitude", "attitude.csv");
    if (!flight_.range_m.stamps.empty()) {
      add_log("height", "range.csv", "range");
    } else if (!flight_.height_m.stamps.empty() && flight_.initial_height_m) {
      add_log("height", "height.csv", "barometer");
    } else if (!flight_.height_m.stamps.empty()) {
      missing("barometer without initial height: not used by flight.yaml");
    }
  }

  void add_truth() {
    const std::optional<LocalFrame>& frame = files_.frame;
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
    if (!has_heading()) {
      assumed(
          "heading: 0 at the first image, of unknown direction to the GNSS positions; a run "
          "reports the rotation that explains their difference");
    }
  }

  void add_estimator() {
    const TimeSeries<Vector6d>& imu = files_.imu;
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

  // True if the yaw of the attitude log is relative to the world's axes: that of autopilots.
  [[nodiscard]] bool has_heading() const {
    if (!recording_.log || flight_.attitude.stamps.empty()) return false;
    const RecordingFormat format = recording_.log->format;
    return format == RecordingFormat::ulog || format == RecordingFormat::dataflash ||
           format == RecordingFormat::tlog;
  }

  void add_calibration(const fs::path& out) {
    const std::string path =
        options_.calibration ? path_from(out, *options_.calibration) : std::string();
    text_ += calibration_section(flight_, options_, files_.images, path, notes_);
  }

  // Roll and pitch from the mean specific force of the first half second of video and IMU.
  std::string initial_attitude() {
    constexpr double kMean_s = 0.5;
    const TimeSeries<Vector6d>& imu = files_.imu;
    Timestamp start = from_seconds(-recording_.time_offset_s);
    if (!imu.stamps.empty()) start = std::max(start, imu.stamps.front());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
      const double t_s = seconds_between(start, imu.stamps[i]);
      if (t_s >= 0 && t_s <= kMean_s) sum += imu.values[i].tail<3>();
    }
    if (sum.norm() == 0) {
      assumed("initial attitude: level (initial.pitch_deg, roll_deg)");
      return {};
    }
    const EulerAngles attitude = attitude_of_up(sum);
    const double pitch_deg = attitude.pitch_rad / kDegree;
    const double roll_deg = attitude.roll_rad / kDegree;
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
  const FlightFiles& files_;
  std::vector<ImportNote>& notes_;
  std::string text_ = "# Written by stillkite import; body: x forward, y left, z up\n";
};

}  // namespace

std::string flight_yaml(const Recording& recording, const ImportOptions& options,
                        const FlightFiles& files, const fs::path& out,
                        std::vector<ImportNote>& notes) {
  FlightYaml yaml(recording, options, files, notes);
  yaml.add_source(out);
  yaml.add_mount();
  yaml.add_initial_state();
  yaml.add_sensors();
  yaml.add_truth();
  yaml.add_estimator();
  return yaml.text();
}

}  // namespace stillkite
