#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "app/commands.hpp"
#include "app/flight_files.hpp"
#include "app/interrupt.hpp"
#include "app/options.hpp"
#include "app/progress_bar.hpp"
#include "app/simulate_config.hpp"
#include "io/config/config_binding.hpp"
#include "io/config/config_node.hpp"
#include "io/config/config_printing.hpp"
#include "io/results/output_file.hpp"
#include "io/results/output_folder.hpp"
#include "io/video/video_writer.hpp"
#include "simulation/flight/simulate.hpp"

namespace stillkite {

namespace {

namespace fs = std::filesystem;

constexpr const char* kVideoName = "flight.mp4";

cv::Mat read_photograph(const SimulationConfig& config) {
  if (!config.ground.photograph) return {};
  const std::string name = config.ground.photograph->string();
  cv::Mat grey = cv::imread(name, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) {
    throw InputError("ground.photograph: " + name +
                     " is missing or not an image; set a PNG or JPEG of the ground from above");
  }
  return grey;
}

// Sink of the images, and its completion after the last one.
struct ImageOutput {
  FrameSink sink;
  std::function<void()> finish;
};

ImageOutput video_output(const SimulateConfig& config, const fs::path& top) {
  const Camera camera = config.simulation.camera.lens();
  const auto writer =
      std::make_shared<VideoWriter>(top / kVideoName, cv::Size(camera.width_px, camera.height_px),
                                    config.simulation.camera.frames_per_s, config.output.encoder);
  return {[writer](const Frame& frame) { writer->write(frame.grey); },
          [writer] { writer->commit(); }};
}

ImageOutput euroc_output(const fs::path& camera_folder) {
  fs::create_directories(camera_folder / "data");
  const auto list = std::make_shared<OutputFile>(camera_folder / "data.csv");
  list->write("#timestamp [ns],filename\n");
  const auto write = [list, camera_folder](const Frame& frame) {
    const std::string name = fmt::format("{:019}.png", frame.stamp.ns);
    const std::string file = (camera_folder / "data" / name).string();
    // noise does not compress at higher levels
    if (!cv::imwrite(file, frame.grey, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
      throw std::runtime_error(file + ": cannot be written; check the free disk space");
    }
    list->write(fmt::format("{},{}\n", frame.stamp.ns, name));
  };
  return {write, [list] { list->commit(); }};
}

void check_output(const SimulateConfig& config) {
  if (config.output.format == ImageFormat::video &&
      !config.simulation.clock.has_exact_image_stamps()) {
    throw InputError(
        "clock: image_delay_s, jitter_s and rounding_s change the stamps of images, but a video's "
        "are regular; set output.format: euroc");
  }
}

// A room and a coast have no ground plane for the flow.
std::string estimator_yaml(const SimulateConfig& config) {
  if (config.simulation.scene == FlightScene::ground) return {};
  const bool video = config.output.format == ImageFormat::video;
  return fmt::format("estimator:\n  policy: fused\nimu:\n  path: {}imu0/data.csv\n",
                     video ? "" : "mav0/");
}

// Mean difference of the image stamps from the truth's clock.
std::string truth_clock_yaml(const ClockConfig& clock) {
  const double delay_s = clock.image_delay_s + clock.jitter_s;
  return delay_s > 0 ? fmt::format("  time_offset_s: {}\n", delay_s) : "";
}

std::string sensors_comment(const SimulateConfig& config) {
  if (config.simulation.scene != FlightScene::ground) return {};
  return fmt::format(
      "# Unused sensors of this flight: {}imu0/data.csv (imu.path), range.csv (height.path, source "
      "range)\n",
      config.output.format == ImageFormat::video ? "" : "mav0/");
}

std::string run_yaml(const SimulateConfig& config) {
  const bool video = config.output.format == ImageFormat::video;
  const FlightCameraConfig& camera = config.simulation.camera;
  return fmt::format(
      "# Simulated flight in this folder: stillkite run run.yaml\n"
      "source:\n  path: {}\n{}"
      "truth:\n  path: {}\n{}"
      "initial:\n  from_truth: true\n{}{}{}",
      video ? kVideoName : ".", video ? "calibration:\n  path: sensor.yaml\n" : "",
      video ? "truth.tum" : "mav0/state_groundtruth_estimate0",
      truth_clock_yaml(config.simulation.clock),
      fmt::format("navigator:\n  readout_s: {}\n  lens_sigma_px: {}\n", camera.readout_s,
                  camera.lens_error_px),
      estimator_yaml(config), sensors_comment(config));
}

// Upper bound: noisy images compress to 1/10 (video) ... 2/3 (PNG).
std::uintmax_t bytes_needed(const SimulateConfig& config, std::size_t frames) {
  const Camera camera = config.simulation.camera.lens();
  const std::uintmax_t grey = std::uintmax_t{frames} * camera.width_px * camera.height_px;
  return config.output.format == ImageFormat::video ? grey / 8 : grey;
}

void simulate_flight(const SimulateConfig& config, const fs::path& out) {
  const SimulationConfig& simulation = config.simulation;
  const bool video = config.output.format == ImageFormat::video;
  check_output(config);
  const FlightRecord flight = record_flight(simulation);
  const cv::Mat photograph = read_photograph(simulation);
  OutputFolder folder(out, bytes_needed(config, flight.truth.size()));
  const fs::path& top = folder.part();
  const fs::path dataset = video ? top : top / "mav0";
  const fs::path camera_folder = video ? top : dataset / "cam0";

  write_flight_files(flight, simulation.camera.frames_per_s, top, dataset, camera_folder);
  {
    const ImageOutput images = video ? video_output(config, top) : euroc_output(camera_folder);
    ProgressBar progress("simulate", static_cast<std::int64_t>(flight.truth.size()));
    render_flight(simulation, photograph, [&](const Frame& frame) {
      if (interrupted()) throw Interrupted{};
      images.sink(frame);
      progress.step();
    });
    images.finish();
  }
  write_file(top / "simulation.yaml", print_config(config));
  write_file(top / "run.yaml", run_yaml(config));
  folder.commit();
  fmt::print(stderr, "stillkite: {} frames; to estimate their motion: stillkite run {}\n",
             flight.truth.size(), (out / "run.yaml").string());
}

struct SimulateArguments {
  std::optional<std::string> config;
  std::vector<std::string> overrides;
  std::string out;
};

SimulateConfig config_of(const SimulateArguments& arguments) {
  return bind_config<SimulateConfig>(read_config(arguments.config, arguments.overrides));
}

void simulate(const SimulateArguments& arguments) {
  const SimulateConfig config = config_of(arguments);
  try {
    simulate_flight(config, arguments.out);
  } catch (const Interrupted&) {
    fmt::print(stderr, "stillkite: interrupted; no results in {}\n", arguments.out);
    throw;
  }
}

}  // namespace

void add_simulate(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "simulate", "Simulate the images and sensors of a flight, with ground truth");
  const auto arguments = std::make_shared<SimulateArguments>();
  command->add_option(
      "config", arguments->config,
      "YAML file (default: the flow paper's flight, see stillkite simulate --print)");
  add_overrides(*command, arguments->overrides);
  command->add_option("--out", arguments->out, "New folder for the flight")->type_name("DIR");
  const auto print = std::make_shared<bool>(false);
  command->add_flag("--print", *print, "Print the configuration with descriptions and exit");
  command->footer(
      "Start with: stillkite simulate --print > flight.yaml\n"
      "Example: stillkite simulate flight.yaml --set flight.height_m=50 --out flight");
  command->callback([arguments, print] {
    if (*print) {
      fmt::print("{}", print_config(config_of(*arguments)));
    } else if (arguments->out.empty()) {
      throw InputError("simulate: missing --out DIR, a new folder");
    } else {
      simulate(*arguments);
    }
  });
}

}  // namespace stillkite
