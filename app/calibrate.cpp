#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/board_calibration.hpp"
#include "app/calibrate_config.hpp"
#include "app/commands.hpp"
#include "app/imu_calibration.hpp"
#include "app/interrupt.hpp"
#include "app/options.hpp"
#include "app/results_folder.hpp"
#include "io/config/config_binding.hpp"
#include "io/config/config_node.hpp"
#include "io/config/config_printing.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
  std::optional<fs::path> config;
  std::vector<std::string> overrides;
  fs::path out;
  bool json = false;
  bool print = false;
};

CalibrateConfig config_of(const CalibrateArguments& arguments) {
  return bind_config<CalibrateConfig>(read_config(arguments.config, arguments.overrides));
}

void calibrate(const CalibrateArguments& arguments) {
  const CalibrateConfig config = config_of(arguments);
  if (arguments.print) {
    fmt::print("{}", print_config(config));
    return;
  }
  if (config.run.source.path.empty()) {
    throw InputError("source.path is not set; expected a video or a folder of images");
  }
  const bool has_board = config.calibration_board.has_value();
  if (!has_board && !config.run.imu.path && !config.run.gyro.path) {
    throw InputError(
        "calibration_board is not set; for the lens set calibration_board: {type: charuco, "
        "columns: "
        "..., rows: ..., square_m: ...}, for the rotation and clock of an IMU set imu.path; see "
        "stillkite calibrate --print");
  }
  const fs::path config_file = arguments.config.value_or("calibrate.yaml");
  const fs::path out = results_folder(arguments.out, config_file);
  protect_inputs(out, {"sensor.yaml", "imu.yaml", "calibration.json", "report.html"},
                 inputs_of_run(config_file, config.run));
  nlohmann::json result;
  try {
    result = has_board ? calibrate_by_board(config, flight_name(config_file), out)
                       : calibrate_imu(config.run, out);
  } catch (const Interrupted&) {
    fmt::print(stderr, "stillkite: interrupted; no results in {}\n", out.string());
    throw;
  }
  if (arguments.json) {
    fmt::print("{}\n", json_text(result));
  } else if (!has_board) {
    print_imu_calibration(result);
    fmt::print(stderr,
               "stillkite: results in {}; add the keys of {} to the flight's configuration\n",
               out.string(), (out / "imu.yaml").string());
  } else {
    print_board_calibration(result);
    fmt::print(stderr,
               "stillkite: results in {}; in the flight's configuration: calibration: "
               "{{path: {}}}\n",
               out.string(), (out / "sensor.yaml").string());
  }
}

}  // namespace

void add_calibrate(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Calibrate the lens by images of a board, or camera to IMU by the rotations of a flight");
  const auto arguments = std::make_shared<CalibrateArguments>();
  command->add_option("config", arguments->config,
                      "YAML file: source with calibration_board, or a flight with calibration and "
                      "imu.path; see --print");
  add_overrides(*command, arguments->overrides);
  add_results_folder(*command, arguments->out);
  command->add_flag("--json", arguments->json, "Print only calibration.json on stdout");
  command->add_flag("--print", arguments->print,
                    "Print the configuration with descriptions and exit");
  command->footer(
      "With a board: writes sensor.yaml (calibration.path of a run), calibration.json, "
      "report.html.\n"
      "Record the board over the whole image, tilted by 20 to 45 degrees to each side, sharp.\n"
      "Example: stillkite calibrate --set source.path=board.mp4 --set "
      "'calibration_board={type: charuco, columns: 10, rows: 7, square_m: 0.03}' --out lens\n"
      "Without: writes imu.yaml (rotation_wxyz and time_offset_s of imu) and calibration.json, "
      "from "
      "ten\nseconds of rotation about all axes. Example: stillkite calibrate flight.yaml --out "
      "imu");
  command->callback([arguments] { calibrate(*arguments); });
}

}  // namespace stillkite
