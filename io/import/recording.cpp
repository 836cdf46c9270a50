#include "io/import/recording.hpp"

#include <fmt/core.h>

#include <initializer_list>
#include <string_view>
#include <utility>

#include "io/import/dataflash.hpp"
#include "io/import/dji_subtitles.hpp"
#include "io/import/ros_flight.hpp"
#include "io/import/telemetry_log.hpp"
#include "io/import/ulog.hpp"
#include "io/recording_format.hpp"
#include "io/text_file.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

struct Files {
  std::optional<fs::path> video;
  std::optional<RecordedLog> log;
};

InputError two_of_a_kind(const fs::path& first, const fs::path& second, const char* kind) {
  return InputError(fmt::format("{} and {} are both {}s; import one flight at a time",
                                first.string(), second.string(), kind));
}

// Format of a file; a video in another container is MP4's kind.
RecordingFormat format_of(const fs::path& file) {
  if (!fs::exists(file)) throw InputError(file.string() + ": no such file; check the path");
  if (!fs::is_regular_file(file) || is_special_file(file)) {
    throw InputError(file.string() + ": not a file; import reads videos and logs");
  }
  if (fs::file_size(file) == 0) {
    throw InputError(file.string() + ": the file is empty; copy it from the device again");
  }
  if (const std::optional<RecordingFormat> format = recording_format_of(file)) return *format;
  try {
    (void)read_imported_video(file, false);
    return RecordingFormat::mp4;
  } catch (const InputError&) {
    std::string known;
    for (const auto& [format, name] : EnumNames<RecordingFormat>::value) {
      if (format != RecordingFormat::mp4) known.append(", ").append(name);
    }
    throw InputError(file.string() + ": unknown format; known: video" + known);
  }
}

Files sort_files(const std::vector<fs::path>& files) {
  Files out;
  for (const fs::path& file : files) {
    const RecordingFormat format = format_of(file);
    if (format == RecordingFormat::mp4) {
      if (out.video) throw two_of_a_kind(*out.video, file, "video");
      out.video = file;
    } else {
      if (out.log) throw two_of_a_kind(out.log->file, file, "log");
      out.log = {file, format};
    }
  }
  return out;
}

// File of the same name with one of the extensions.
std::optional<fs::path> sibling(const fs::path& file,
                                std::initializer_list<const char*> extensions) {
  for (const char* extension : extensions) {
    fs::path other = file;
    other.replace_extension(extension);
    if (fs::is_regular_file(other)) return other;
  }
  return std::nullopt;
}

void find_siblings(Files& files) {
  if (!files.log && files.video) {
    const std::optional<fs::path> subtitles = sibling(*files.video, {".SRT", ".srt"});
    if (subtitles && recording_format_of(*subtitles) == RecordingFormat::subtitles) {
      files.log = {*subtitles, RecordingFormat::subtitles};
    }
  } else if (!files.video && files.log->format == RecordingFormat::subtitles) {
    files.video = sibling(files.log->file, {".MP4", ".mp4", ".MOV", ".mov"});
  }
}

// Sensors of a log; of a ROS recording also the topic of its images.
RosFlight read_log(const RecordedLog& log, const ImportOptions& options) {
  switch (log.format) {
    case RecordingFormat::subtitles:
      return {read_dji_subtitles(log.file), std::nullopt};
    case RecordingFormat::ulog:
      return {read_ulog(log.file), std::nullopt};
    case RecordingFormat::dataflash:
      return {read_dataflash(log.file), std::nullopt};
    case RecordingFormat::tlog:
      return {read_telemetry_log(log.file), std::nullopt};
    case RecordingFormat::mp4:
    case RecordingFormat::mcap:
    case RecordingFormat::rosbag:
    case RecordingFormat::ros_database:
      break;
  }
  return read_ros_flight(log.file, log.format, options.poll);
}

// First stamp of all series; nullopt without a reading.
std::optional<Timestamp> first_stamp(const ImportedFlight& flight) {
  std::optional<Timestamp> first;
  const auto include = [&](const auto& series) {
    if (series.stamps.empty()) return;
    if (!first || series.stamps.front() < *first) first = series.stamps.front();
  };
  include(flight.angular_rate_in_body_rad_s);
  include(flight.specific_force_in_body_m_s2);
  include(flight.range_m);
  include(flight.height_m);
  include(flight.attitude);
  include(flight.positions);
  include(flight.velocity_in_world_m_s);
  return first;
}

void set_clock(Recording& recording, const ImportOptions& options) {
  if (recording.image_topic) {  // images and sensors have one clock
    recording.time_offset_s = 0;
    return;
  }
  const std::optional<Timestamp> first = first_stamp(recording.flight);
  if (!first) {
    throw InputError(
        fmt::format("{}: {} without a reading of a motion sensor; the file is damaged, or the log "
                    "level excludes them",
                    recording.log->file.string(), name_of(recording.log->format)));
  }
  if (recording.log->format == RecordingFormat::subtitles) return;  // on the clock of the video
  recording.flight.found(
      fmt::format("clock: of the log; the first reading is at {:.3f} s", to_seconds(*first)));
  recording.time_offset_s -= to_seconds(*first);
  if (recording.video) {
    recording.flight.assumed(fmt::format(
        "clock: the log starts {:.3f} s after the video's first frame (--log-start-s, and "
        "time_offset_s in flight.yaml)",
        options.log_start_s));
  }
}

}  // namespace

Recording read_recording(const std::vector<fs::path>& files, const ImportOptions& options) {
  Files sorted = sort_files(files);
  find_siblings(sorted);
  Recording out{.log = sorted.log, .time_offset_s = options.log_start_s};
  if (sorted.video) {
    out.video = read_imported_video(*sorted.video, true);
    if (out.video->telemetry) {
      out.flight = std::move(*out.video->telemetry);
    } else if (!out.log) {
      out.flight.missing(
          "telemetry: the video has no GoPro or subtitle track, and no log is given");
    }
  }
  options.poll();
  if (!out.log) return out;
  const ImportedFlight of_video = std::exchange(out.flight, {});
  try {
    RosFlight read = read_log(*out.log, options);
    out.flight = std::move(read.flight);
    if (!out.video) out.image_topic = std::move(read.image_topic);
  } catch (const InputError& error) {
    const std::string name = out.log->file.string();
    const std::string problem = error.what();
    throw InputError(problem.starts_with(name) ? problem : name + ": " + problem);
  }
  if (!out.flight.horizontal_fov_deg) {
    out.flight.horizontal_fov_deg = of_video.horizontal_fov_deg;
    out.flight.is_fisheye = of_video.is_fisheye;
  }
  out.flight.notes.insert(
      out.flight.notes.begin(),
      {.kind = ImportNote::Kind::found,
       .text = fmt::format("log: {}, {}", out.log->file.string(), name_of(out.log->format))});
  set_clock(out, options);
  return out;
}

}  // namespace stillkite
