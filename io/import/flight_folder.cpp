#include "io/import/flight_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "io/import/flight_config.hpp"
#include "io/import/imu_series.hpp"
#include "io/import/local_frame.hpp"
#include "io/import/ros_flight.hpp"
#include "io/results/output_file.hpp"
#include "io/results/output_folder.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

// One row per reading; print(value) are its cells.
template <typename Value, typename Print>
void write_series(const fs::path& file, std::string_view header, const TimeSeries<Value>& series,
                  Print print) {
  if (series.stamps.empty()) return;
  OutputFile out(file);
  out.write(header);
  for (std::size_t i = 0; i < series.stamps.size(); ++i) {
    out.write(fmt::format("{},{}\n", series.stamps[i].ns, print(series.values[i])));
  }
  out.commit();
}

std::string cells(const Eigen::Vector3d& v) {
  return fmt::format("{:.9g},{:.9g},{:.9g}", v.x(), v.y(), v.z());
}

// Number of readings, rate and duration.
template <typename Value>
std::string extent_of(const TimeSeries<Value>& series) {
  const double duration_s = seconds_between(series.stamps.front(), series.stamps.back());
  std::string text = fmt::format("{} readings", series.stamps.size());
  if (duration_s > 0) {
    text += fmt::format(", {:.4g} Hz, {:.1f} s",
                        static_cast<double>(series.stamps.size() - 1) / duration_s, duration_s);
  }
  const double max_gap = max_gap_s(series.stamps);
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < series.stamps.size(); ++i) {
    if (seconds_between(series.stamps[i - 1], series.stamps[i]) > max_gap) ++gaps;
  }
  if (gaps > 0) text += fmt::format(", {} gap{}", gaps, gaps == 1 ? "" : "s");
  return text;
}

template <typename Value>
void note_series(std::vector<ImportNote>& notes, const char* name, const char* file,
                 const TimeSeries<Value>& series) {
  if (series.stamps.empty()) {
    add_note(notes, ImportNote::Kind::missing, name);
  } else {
    add_note(notes, ImportNote::Kind::found,
             fmt::format("{}: {} ({})", name, extent_of(series), file));
  }
}

// True if the series end before, or begin after, those of the reference.
template <typename Value>
bool is_on_another_clock(const TimeSeries<Value>& series, const std::vector<Timestamp>& reference) {
  return !series.stamps.empty() && !reference.empty() &&
         (series.stamps.back() < reference.front() || series.stamps.front() > reference.back());
}

// Images of a ROS recording. Throws InputError if none can be written.
ImageSize write_images(const Recording& recording, const ImportOptions& options,
                       const fs::path& camera_folder, std::vector<ImportNote>& notes) {
  const RosImages images = write_ros_images(recording.log->file, recording.log->format,
                                            *recording.image_topic, camera_folder, options.poll);
  const std::string rejected =
      fmt::format("{} of {} images of topic {}, encoding '{}'", images.rejected,
                  images.rejected + images.written, *recording.image_topic, images.encoding);
  if (images.written == 0) {
    throw InputError(fmt::format(
        "{}: cannot read {}; known: mono, bgr, rgb and bayer of 8 bits, mono16, JPEG, PNG; give "
        "the images as a video file after the recording",
        recording.log->file.string(), rejected));
  }
  add_note(notes, ImportNote::Kind::found,
           fmt::format("images: {} of topic {}, {}x{} (cam0/data.csv)", images.written,
                       *recording.image_topic, images.width_px, images.height_px));
  if (images.rejected > 0) add_note(notes, ImportNote::Kind::missing, "images: " + rejected);
  return {images.width_px, images.height_px};
}

// Median speed between successive positions; 0 below two.
double median_speed_m_s(const TimeSeries<Eigen::Vector3d>& positions_m) {
  std::vector<double> speeds_m_s;
  for (std::size_t i = 1; i < positions_m.stamps.size(); ++i) {
    speeds_m_s.push_back((positions_m.values[i] - positions_m.values[i - 1]).norm() /
                         seconds_between(positions_m.stamps[i - 1], positions_m.stamps[i]));
  }
  if (speeds_m_s.empty()) return 0;
  const auto middle = speeds_m_s.begin() + std::ssize(speeds_m_s) / 2;
  std::ranges::nth_element(speeds_m_s, middle);
  return *middle;
}

}  // namespace

std::vector<ImportNote> write_flight_folder(const Recording& recording,
                                            const ImportOptions& options, const fs::path& out) {
  const ImportedFlight& flight = recording.flight;
  FlightFiles files{.imu = imu_series(flight)};
  const TimeSeries<Vector6d>& imu = files.imu;
  std::optional<LocalFrame>& frame = files.frame;
  TimeSeries<Eigen::Vector3d> positions_m{.stamps = flight.positions.stamps};
  if (!flight.positions.values.empty()) {
    GeodeticPosition origin = flight.positions.values.front();
    origin.altitude_m = flight.takeoff_altitude_m.value_or(origin.altitude_m);
    frame.emplace(origin);
    for (const GeodeticPosition& position : flight.positions.values) {
      positions_m.values.push_back(frame->position_m(position));
    }
  }

  constexpr std::uintmax_t kRowBytes = 120;
  const std::size_t rows = imu.stamps.size() + flight.attitude.stamps.size() +
                           flight.positions.stamps.size() + flight.height_m.stamps.size();
  OutputFolder folder(out, kRowBytes * rows);
  const fs::path& top = folder.part();
  if (!imu.stamps.empty()) fs::create_directories(top / "imu0");
  write_series(top / "imu0" / "data.csv",
               "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
               "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n",
               imu,
               [](const Vector6d& v) { return cells(v.head<3>()) + "," + cells(v.tail<3>()); });
  write_series(
      top / "attitude.csv", "#timestamp [ns],qw,qx,qy,qz\n", flight.attitude,
      [](const Eigen::Quaterniond& q) { return fmt::format("{:.9f},{}", q.w(), cells(q.vec())); });
  write_series(top / "range.csv", "#timestamp [ns],range [m]\n", flight.range_m,
               [](double range_m) { return fmt::format("{:.9g}", range_m); });
  write_series(top / "height.csv", "#timestamp [ns],height [m]\n", flight.height_m,
               [](double height_m) { return fmt::format("{:.9g}", height_m); });
  write_series(top / "gnss_positions.csv", "#timestamp [ns],x [m],y [m],z [m]\n", positions_m,
               [](const Eigen::Vector3d& p) {
                 return fmt::format("{:.4f},{:.4f},{:.4f}", p.x(), p.y(), p.z());
               });
  write_series(top / "gnss_velocity.csv", "#timestamp [ns],vx [m/s],vy [m/s],vz [m/s]\n",
               flight.velocity_in_world_m_s, cells);

  std::vector<ImportNote> notes = flight.notes;
  if (recording.image_topic) {
    files.images = write_images(recording, options, top / "cam0", notes);
  } else if (recording.video) {
    files.images = {recording.video->width_px, recording.video->height_px};
  }
  note_series(notes, "imu", "imu0/data.csv", imu);
  note_series(notes, "attitude", "attitude.csv", flight.attitude);
  note_series(notes, "range finder", "range.csv", flight.range_m);
  note_series(notes, "barometric height", "height.csv", flight.height_m);
  note_series(notes, "GNSS position", "gnss_positions.csv", flight.positions);
  note_series(notes, "GNSS velocity", "gnss_velocity.csv", flight.velocity_in_world_m_s);
  const std::vector<Timestamp>& clock = imu.stamps.empty() ? flight.attitude.stamps : imu.stamps;
  for (const auto& [name, is_other] :
       {std::pair("attitude", is_on_another_clock(flight.attitude, clock)),
        std::pair("range finder", is_on_another_clock(flight.range_m, clock)),
        std::pair("barometric height", is_on_another_clock(flight.height_m, clock)),
        std::pair("GNSS position", is_on_another_clock(flight.positions, clock)),
        std::pair("GNSS velocity", is_on_another_clock(flight.velocity_in_world_m_s, clock))}) {
    if (is_other) {
      add_note(
          notes, ImportNote::Kind::missing,
          fmt::format("common clock: no reading of {} is at a time of the imu or attitude; set "
                      "its time_offset_s in flight.yaml",
                      name));
    }
  }
  if (flight.rejected > 0) {
    add_note(notes, ImportNote::Kind::missing,
             fmt::format("{} rejected readings: out of range, or time stamps out of order",
                         flight.rejected));
  }
  constexpr double kMaxSpeed_m_s = 340;  // of a truth that a run accepts
  if (const double speed_m_s = median_speed_m_s(positions_m); speed_m_s > kMaxSpeed_m_s) {
    add_note(notes, ImportNote::Kind::missing,
             fmt::format("truth: the GNSS positions move at {:.0f} m/s (median); not used by "
                         "flight.yaml",
                         speed_m_s));
    frame.reset();
  }
  write_file(top / "flight.yaml", flight_yaml(recording, options, files, out, notes));
  options.poll();
  folder.commit();
  return notes;
}

}  // namespace stillkite
