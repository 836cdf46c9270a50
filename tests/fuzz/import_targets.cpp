// Readers of recordings of cameras and autopilots, and of our own flights.
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "geometry/fields.hpp"
#include "io/import/dataflash.hpp"
#include "io/import/dji_subtitles.hpp"
#include "io/import/gopro_telemetry.hpp"
#include "io/import/ros_flight.hpp"
#include "io/import/telemetry_log.hpp"
#include "io/import/ulog.hpp"
#include "io/recording_format.hpp"
#include "live/record/flight_files.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/io/import/reading_checks.hpp"
#include "tests/io/import/ros_samples.hpp"
#include "tests/io/import/samples.hpp"

namespace stillkite::fuzz {
namespace {

// File in memory that is written again for each input.
const std::filesystem::path& file_of(Input input) {
  static const int descriptor = memfd_create("recording", MFD_CLOEXEC);
  static const std::filesystem::path path = "/proc/self/fd/" + std::to_string(descriptor);
  if (ftruncate(descriptor, 0) != 0 ||
      pwrite(descriptor, input.data(), input.size(), 0) != static_cast<ssize_t>(input.size())) {
    throw std::runtime_error("no file in memory");
  }
  return path;
}

template <typename Read>
void read_flight(Read&& read) {
  try {
    const std::optional<std::string> problem = problem_of(read());
    require(!problem, problem ? problem->c_str() : "");
  } catch (const InputError& error) {
    require(std::string_view(error.what()).size() > 10, "an error names its cause");
  }
}

template <auto kReader>
void read_file(Input input) {
  const std::filesystem::path& file = file_of(input);
  static_cast<void>(recording_format_of(file));
  read_flight([&] { return kReader(file); });
}

void read_gpmf(Input input) {
  read_flight([&] {
    GoproTelemetry telemetry;
    for (int i = 0; i < 3; ++i) telemetry.add(input, from_seconds(i), from_seconds(i + 1));
    return telemetry.finish();
  });
}

template <RecordingFormat kFormat>
ImportedFlight read_ros(const std::filesystem::path& file) {
  return read_ros_flight(file, kFormat, [] {}).flight;
}

// First byte: file of the record.
void read_record(Input input) {
  static const std::filesystem::path folder = [] {
    std::string pattern = (std::filesystem::temp_directory_path() / "stillkite_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    static const struct Removal {
      std::filesystem::path path;
      ~Removal() { std::filesystem::remove_all(path); }
    } removal{pattern};
    return removal.path;
  }();
  if (input.empty()) return;
  const auto write = [&](const char* name) {
    std::ofstream(folder / name, std::ios::binary) << text_of(input.subspan(1));
  };
  try {
    switch (input[0] % 4) {
      case 0:
        write(kSessionsFile);
        static_cast<void>(read_sessions(folder));
        break;
      case 1:
        write(kPacketsFile);
        static_cast<void>(read_packets(folder));
        break;
      case 2:
        write(kFramesFile);
        static_cast<void>(read_frames(folder));
        break;
      default:
        write(kTelemetryFile);
        for (const RecordedMessage& message : read_messages(folder)) {
          require(message_row(message).ends_with('\n'), "a row is a line");
        }
    }
  } catch (const InputError& error) {
    require(std::string_view(error.what()).size() > 10, "an error names its cause");
  }
}

constexpr std::array kImportTargets{
    Target{"gpmf", read_gpmf, [] { return std::vector{samples::gopro_payload()}; }},
    Target{"subtitles", read_file<read_dji_subtitles>,
           [] { return std::vector<std::string>{samples::kSubtitles}; }},
    Target{"ulog", read_file<read_ulog>, [] { return std::vector{samples::ulog()}; }},
    Target{"dataflash", read_file<read_dataflash>,
           [] { return std::vector{samples::dataflash()}; }},
    Target{"tlog", read_file<read_telemetry_log>, [] { return std::vector{samples::tlog()}; }},
    Target{"rosbag", read_file<read_ros<RecordingFormat::rosbag>>,
           [] {
             return std::vector{samples::rosbag("none"), samples::rosbag("lz4")};
           }},
    Target{"mcap", read_file<read_ros<RecordingFormat::mcap>>,
           [] {
             return std::vector{samples::mcap(true, ""), samples::mcap(false, "zstd")};
           }},
    Target{"flight_record", read_record},
};

}  // namespace

std::span<const Target> import_targets() {
  return kImportTargets;
}

}  // namespace stillkite::fuzz
