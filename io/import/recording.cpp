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
  std::optional<fs::path> log;
  RecordingFormat log_format = RecordingFormat::ulog;
};

void set_once(std::optional<fs::path>& slot, const fs::path& file, const char* kind) {
  if (slot) {
    throw InputError(fmt::format("{} and {} are both {}s; import one flight at a time",
                                 slot->string(), file.string(), kind));
  }
  slot = file;
}

// A file of no known format may be a video in another container.
Files sort_files(const std::vector<fs::path>& files) {
  Files out;
  for (const fs::path& file : files) {
    if (!fs::exists(file)) throw InputError(file.string() + ": no such file; check the path");
    if (!fs::is_regular_file(file) || is_special_file(file)) {
      throw InputError(file.string() + ": not a file; import reads videos and logs");
    }
    const std::optional<RecordingFormat> format = recording_format_of(file);
    if (!format || *format == RecordingFormat::mp4) {
      set_once(out.video, file, "video");
    } else {
      set_once(out.log, file, "log");
      out.log_format = *format;
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
      files.log = subtitles;
      files.log_format = RecordingFormat::subtitles;
    }
  } else if (!files.video && files.log_format == RecordingFormat::subtitles) {
    files.video = sibling(*files.log, {".MP4", ".mp4", ".MOV", ".mov"});
  }
}

bool is_ros(RecordingFormat format) {
  return format == RecordingFormat::mcap || format == RecordingFormat::rosbag ||
         format == RecordingFormat::ros_database;
}

ImportedFlight read_log(const fs::path& file, RecordingFormat format) {
  switch (format) {
    case RecordingFormat::subtitles:
      return read_dji_subtitles(file);
    case RecordingFormat::ulog:
      return read_ulog(file);
    case RecordingFormat::dataflash:
      return read_dataflash(file);
    case RecordingFormat::tlog:
      return read_telemetry_log(file);
    case RecordingFormat::mcap:
    case RecordingFormat::rosbag:
    case RecordingFormat::ros_database:
    case RecordingFormat::mp4:
      break;
  }
  return {};
}

ImportedVideo read_video(const fs::path& file, bool with_telemetry) {
  try {
    return read_imported_video(file, with_telemetry);
  } catch (const InputError& error) {
    if (recording_format_of(file)) throw;
    std::string known;
    for (const auto& [format, name] : EnumNames<RecordingFormat>::value) {
      known.append(known.empty() ? "" : ", ").append(name);
    }
    throw InputError(file.string() + ": unknown format; known: video, " + known);
  }
}

// Stamps at which the flight's series begin; nullopt without a reading.
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

void set_clock(Recording& recording, RecordingFormat format, const ImportOptions& options) {
  if (recording.image_topic) {  // images and sensors have one clock
    recording.time_offset_s = 0;
    return;
  }
  const std::optional<Timestamp> first = first_stamp(recording.flight);
  if (!first) {
    throw InputError(fmt::format(
        "{}: a {} without a reading of a motion sensor; the file is damaged, or the log "
        "level excludes them",
        recording.log->string(), name_of(format)));
  }
  if (format == RecordingFormat::subtitles) return;  // on the clock of the video
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
  Recording out{.time_offset_s = options.log_start_s};
  if (sorted.video) out.video = read_video(*sorted.video, !sorted.log);
  out.log = sorted.log;
  out.log_format = sorted.log_format;
  if (sorted.log) {
    try {
      if (is_ros(sorted.log_format)) {
        RosFlight ros = read_ros_flight(*sorted.log, sorted.log_format);
        out.flight = std::move(ros.flight);
        if (!sorted.video) out.image_topic = std::move(ros.image_topic);
      } else {
        out.flight = read_log(*sorted.log, sorted.log_format);
      }
    } catch (const InputError& error) {
      const std::string name = sorted.log->string();
      const std::string problem = error.what();
      throw InputError(problem.starts_with(name) ? problem : name + ": " + problem);
    }
    std::vector<ImportNote> notes;
    add_note(notes, ImportNote::Kind::found,
             fmt::format("log: {}, {}", sorted.log->string(), name_of(sorted.log_format)));
    notes.insert(notes.end(), out.flight.notes.begin(), out.flight.notes.end());
    out.flight.notes = std::move(notes);
    set_clock(out, sorted.log_format, options);
  } else if (out.video && out.video->telemetry) {
    out.flight = std::move(*out.video->telemetry);
  }
  return out;
}

}  // namespace stillkite
