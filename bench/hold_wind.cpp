// How the hold answers wind: the hold paper's ways on the hovers' plant, its tether read at once,
// but the pose told as it is, with noise, instead of by images. Minutes of video become
// milliseconds.

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
  double place_noise_m = 0.001;
  double velocity_noise_m_s = 0.005;
  bool without_velocity = false;
  double delay_s = 0.12;  // from exposure to command
};

struct Told {
  MotionEstimate estimate;
  Eigen::Quaterniond station_from_camera;
};

Vector3d noise(Random& random, double sigma) {
  return sigma * Vector3d(random.normal(), random.normal(), random.normal());
}

Told tell(const Options& options, const HoverPlant& plant, const RigidTransform& reference,
          Random& random) {
  const RigidTransform& camera = plant.truth().world_from_camera;
  const RigidTransform moved = reference.inverse() * camera;
  MotionEstimate estimate;
  estimate.stamp = plant.now();
  estimate.status = EstimateStatus::ok;
  estimate.reference_from_camera = moved.rotation;
  estimate.displacement_kind = DisplacementKind::metric;
  estimate.displacement_in_reference = moved.translation + noise(random, options.place_noise_m);
  if (!options.without_velocity) {
    const Vector3d velocity =
        plant.truth().velocity_in_world_m_s + noise(random, options.velocity_noise_m_s);
    estimate.twist_in_camera = Twist{.velocity_m_s = camera.rotation.conjugate() * velocity};
  }
  return {estimate, plant.world_from_station().rotation.conjugate() * camera.rotation};
}

// Mean distance from where it should be.
double fly(const Options& options, const HoverConfig& config, const Trial& trial) {
  constexpr int kStepsPerFrame = 20;  // 600 / 30 Hz
  HoverPlant plant(config, trial);
  HoverSensors sensors(config.plant.sensors, trial.seed);
  HoldController controller(config.hold);
  Random random(trial.seed);
  const RigidTransform reference = plant.truth().world_from_camera;
  std::deque<Told> on_the_way;
  std::optional<TetherReading> tether;
  TetherCommand command;
  double sum_m = 0;
  int frames = 0;
  for (int step = 0; !plant.is_over(); ++step) {
    for (const TetherSample& sample : sensors.read(plant.truth(), plant.now()).tether) {
      tether = TetherReading{sample.stamp, sample.tether, sample.taut};
    }
    if (step % kStepsPerFrame == 0) {
      on_the_way.push_back(tell(options, plant, reference, random));
      sum_m += (plant.truth().world_from_camera.translation - reference.translation).norm();
      ++frames;
    }
    while (!on_the_way.empty() &&
           seconds_between(on_the_way.front().estimate.stamp, plant.now()) >= options.delay_s) {
      const Told& told = on_the_way.front();
      command = controller
                    .decide({.now = plant.now(),
                             .estimate = told.estimate,
                             .tether = tether,
                             .station_from_camera = told.station_from_camera})
                    .command;
      on_the_way.pop_front();
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
    double axis_m = 0, worst_m = 0;
    for (int i = 0; i < options.flights; ++i) {
      const double m =
          fly(options, config,
              {.axis = axis, .seed = static_cast<std::uint64_t>(options.first_seed + i)});
      axis_m += m / options.flights;
      worst_m = std::max(worst_m, m);
    }
    fmt::print("{:>8.2f} ({:>5.2f})", 100 * axis_m, 100 * worst_m);
    sum_m += axis_m;
  }
  fmt::print("{:>8.2f}\n", 100 * sum_m / 3);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("How far wind moves a held drone, by a pose that is told without images");
  app.option_defaults()->always_capture_default();
  app.add_option("--winds-m-s", options.winds_m_s, "mean winds");
  app.add_option("--towards-deg", options.towards_deg, "directions, from the world's x");
  app.add_option("--flights", options.flights, "an axis")->check(CLI::PositiveNumber);
  app.add_option("--first-seed", options.first_seed)->check(CLI::NonNegativeNumber);
  app.add_option("--place-noise-m", options.place_noise_m)->check(CLI::NonNegativeNumber);
  app.add_option("--velocity-noise-m-s", options.velocity_noise_m_s)->check(CLI::NonNegativeNumber);
  app.add_flag("--without-velocity", options.without_velocity, "a place alone is told");
  app.add_option("--delay-s", options.delay_s, "from exposure to command")
      ->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);

  fmt::print(
      "mean distance from home, cm, of {} flights (of the worst)\n"
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
