// Position error of the hold controller in wind: the hover trials' plant with undelayed tether
// readings and the true pose plus noise instead of images.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <deque>
#include <exception>
#include <optional>
#include <vector>

#include "simulation/hover/hover_plant.hpp"
#include "simulation/hover/hover_sensors.hpp"
#include "simulation/random.hpp"
#include "stabilization/hold_controller.hpp"

namespace {

using namespace stillkite;
using Eigen::Vector3d;

struct Options {
  std::vector<double> winds_m_s{0, 3, 6, 9};
  std::vector<double> towards_deg{0, 30, 60, 90};
  int flights = 20;
  int first_seed = 1;
  double position_noise_m = 0.001;
  double velocity_noise_m_s = 0.005;
  bool without_velocity = false;
  double delay_s = 0.12;  // exposure to command
};

struct SimulatedEstimate {
  MotionEstimate estimate;
  Eigen::Quaterniond station_from_camera;
};

Vector3d noise(Random& random, double sigma) {
  return sigma * Vector3d(random.normal(), random.normal(), random.normal());
}

SimulatedEstimate estimate_with_noise(const Options& options, const HoverPlant& plant,
                                      const RigidTransform& reference, Random& random) {
  const RigidTransform& camera = plant.truth().world_from_camera;
  const RigidTransform moved = reference.inverse() * camera;
  MotionEstimate estimate;
  estimate.stamp = plant.now();
  estimate.status = EstimateStatus::ok;
  estimate.reference_from_camera = moved.rotation;
  estimate.displacement_kind = DisplacementKind::metric;
  estimate.displacement_in_reference = moved.translation + noise(random, options.position_noise_m);
  if (!options.without_velocity) {
    const Vector3d velocity =
        plant.truth().velocity_in_world_m_s + noise(random, options.velocity_noise_m_s);
    estimate.twist_in_camera = Twist{.velocity_m_s = camera.rotation.conjugate() * velocity};
  }
  return {estimate, plant.world_from_station().rotation.conjugate() * camera.rotation};
}

// Mean position error, m.
double fly(const Options& options, const HoverConfig& config, const Trial& trial) {
  constexpr int kStepsPerFrame = 20;  // 600 / 30 Hz
  HoverPlant plant(config, trial);
  HoverSensors sensors(config.plant.sensors, trial.seed);
  HoldController controller(config.hold);
  Random random(trial.seed);
  const RigidTransform reference = plant.truth().world_from_camera;
  std::deque<SimulatedEstimate> delayed;
  std::optional<TetherReading> tether;
  TetherCommand command;
  double sum_m = 0;
  int frames = 0;
  for (int step = 0; !plant.is_over(); ++step) {
    for (const TetherSample& sample : sensors.read(plant.truth(), plant.now()).tether) {
      tether = TetherReading{sample.stamp, sample.tether, sample.taut};
    }
    if (step % kStepsPerFrame == 0) {
      delayed.push_back(estimate_with_noise(options, plant, reference, random));
      sum_m += (plant.truth().world_from_camera.translation - reference.translation).norm();
      ++frames;
    }
    while (!delayed.empty() &&
           seconds_between(delayed.front().estimate.stamp, plant.now()) >= options.delay_s) {
      const SimulatedEstimate& current = delayed.front();
      command = controller
                    .decide({.now = plant.now(),
                             .estimate = current.estimate,
                             .tether = tether,
                             .station_from_camera = current.station_from_camera})
                    .command;
      delayed.pop_front();
    }
    plant.step(command);
  }
  return sum_m / frames;
}

void print_row(const Options& options, double wind_m_s, double towards_deg) {
  HoverConfig config;
  config.plant.wind.mean_m_s = wind_m_s;
  config.plant.wind.towards_deg = towards_deg;
  fmt::print("{:>5.0f}{:>9.0f}", wind_m_s, towards_deg);
  double sum_m = 0;
  for (const PaperAxis axis : {PaperAxis::x, PaperAxis::y, PaperAxis::z}) {
    double axis_m = 0, max_m = 0;
    for (int i = 0; i < options.flights; ++i) {
      const double m =
          fly(options, config,
              {.axis = axis, .seed = static_cast<std::uint64_t>(options.first_seed + i)});
      axis_m += m / options.flights;
      max_m = std::max(max_m, m);
    }
    fmt::print("{:>8.2f} ({:>5.2f})", 100 * axis_m, 100 * max_m);
    sum_m += axis_m;
  }
  fmt::print("{:>8.2f}\n", 100 * sum_m / 3);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Position error of the hold controller in wind, with simulated pose estimates");
  app.option_defaults()->always_capture_default();
  app.add_option("--winds-m-s", options.winds_m_s, "mean wind speeds, m/s");
  app.add_option("--towards-deg", options.towards_deg, "wind directions from world x, deg");
  app.add_option("--flights", options.flights, "flights per axis")->check(CLI::PositiveNumber);
  app.add_option("--first-seed", options.first_seed, "seed of the first flight")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--place-noise-m", options.position_noise_m,
                 "standard deviation of the position, per axis, m")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--velocity-noise-m-s", options.velocity_noise_m_s,
                 "standard deviation of the velocity, per axis, m/s")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--without-velocity", options.without_velocity, "position only");
  app.add_option("--delay-s", options.delay_s, "delay from exposure to command, s")
      ->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);

  fmt::print(
      "mean position error, cm, over {} flights (maximum)\n"
      "{:>5}{:>9}{:>16}{:>16}{:>16}{:>8}\n",
      options.flights, "m/s", "towards", "x", "y (up)", "z", "all");
  for (const double wind_m_s : options.winds_m_s) {
    for (const double towards_deg : options.towards_deg) {
      print_row(options, wind_m_s, towards_deg);
      if (wind_m_s == 0) break;  // no direction
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_hold_wind: {}\n", error.what());
    return 1;
  }
}
