#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "io/import/flight_folder.hpp"
#include "io/results/output_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  std::vector<fs::path> files;
  ImportOptions options;
  fs::path out;
};

const char* name_of_kind(ImportNote::Kind kind) {
  switch (kind) {
    case ImportNote::Kind::found:
      return "found";
    case ImportNote::Kind::missing:
      return "missing";
    case ImportNote::Kind::assumed:
      return "assumed";
  }
  return "";
}

void import_flight(const ImportArguments& arguments) {
  OutputFolder::reject_existing(arguments.out);
  ImportOptions options = arguments.options;
  options.poll = [] {
    if (interrupted()) throw Interrupted{};
  };
  const Recording recording = read_recording(arguments.files, options);
  const std::vector<ImportNote> notes = write_flight_folder(recording, options, arguments.out);
  for (const ImportNote& note : notes) {
    fmt::print("{:<7}  {}\n", name_of_kind(note.kind), note.text);
  }
  const bool has_images = recording.video || recording.image_topic;
  fmt::print(stderr, "stillkite: to estimate the motion: stillkite run {}{}{}\n",
             (arguments.out / "flight.yaml").string(), has_images ? "" : " --set source.path=VIDEO",
             has_images || options.calibration ? "" : " --set calibration.path=FILE");
}

void import_or_report_interrupt(const ImportArguments& arguments) {
  try {
    import_flight(arguments);
  } catch (const Interrupted&) {
    fmt::print(stderr, "stillkite: interrupted; no results in {}\n", arguments.out.string());
    throw;
  }
}

}  // namespace

void add_import(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "import",
      "Convert a video with telemetry, a flight log or a ROS bag to a flight that can be run");
  const auto arguments = std::make_shared<ImportArguments>();
  command
      ->add_option(
          "files", arguments->files,
          "Video (GoPro, DJI), subtitles (SRT), ULog, DataFlash .bin, .tlog, MCAP or ROS bag; a "
          "video and a log together")
      ->required();
  command->add_option("--out", arguments->out, "New folder for the flight")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--calibration", arguments->options.calibration,
                   "Camera calibration (default: nominal values of the camera)")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--horizontal-fov-deg", arguments->options.horizontal_fov_deg,
                   "Horizontal field of view, without a calibration")
      ->check(CLI::Range(5.0, 170.0))
      ->excludes("--calibration");
  command
      ->add_option("--log-start-s", arguments->options.log_start_s,
                   "Time in the video at which the log starts (default: 0)")
      ->check(CLI::Range(-1e6, 1e6));
  command->footer(
      "Formats are recognized by content. Writes imu0/data.csv, attitude, heights, GNSS positions\n"
      "and velocities as CSV and flight.yaml, and prints what was found, is missing or assumed.\n"
      "Example: stillkite import GX010042.MP4 --out flight && stillkite run flight/flight.yaml");
  command->callback([arguments] { import_or_report_interrupt(*arguments); });
}

}  // namespace stillkite
