// An hour's patrol over landmarks that a map knows to a metre, at the level of measurements: the
// largest error of the corrected pose at any frame, beside dead reckoning's, and its NEES.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <thread>
#include <vector>

#include "evaluation/chi_square.hpp"
#include "tests/estimation/fusion/landmark_flight.hpp"

namespace {

using namespace stillkite;

struct Options {
  PatrolScene scene;
  int first_seed = 2001;
  int seeds = 10;
  int threads = 2;
  double most_m = 1;
};

constexpr std::size_t kStamps = 12;  // evenly over the flight

struct FlightResult {
  double most_m = 0;
  double most_at_s = 0;
  double rms_m = 0;
  double dead_reckoned_most_m = 0;
  double dead_reckoned_rms_early_m = 0;  // over 150 s, as the flow paper's flight lasts
  std::array<double, kStamps> nees{};
  LandmarkFlight::Sightings sightings;
};

FlightResult fly(const PatrolScene& scene, int seed) {
  constexpr double kEarly_s = 150;
  LandmarkFlight flight(scene, static_cast<std::uint64_t>(seed));
  FlightResult result;
  double squares = 0, early_squares = 0;
  int frames = 0, early_frames = 0;
  for (std::size_t stamp = 0; stamp < kStamps;) {
    flight.step();
    const double error_m = flight.error_of(flight.filter().world_from_camera()).head<3>().norm();
    const double alone_m = flight.error_of(flight.dead_reckoned()).head<3>().norm();
    if (!(error_m <= result.most_m)) {
      result.most_m = error_m;
      result.most_at_s = flight.time_s();
    }
    result.dead_reckoned_most_m = std::max(result.dead_reckoned_most_m, alone_m);
    squares += error_m * error_m;
    ++frames;
    if (flight.time_s() <= kEarly_s) {
      early_squares += alone_m * alone_m;
      ++early_frames;
    }
    const double next_s = scene.seconds * static_cast<double>(stamp + 1) / kStamps;
    if (flight.time_s() > next_s - 1e-6) result.nees[stamp++] = flight.nees();
  }
  result.rms_m = std::sqrt(squares / frames);
  result.dead_reckoned_rms_early_m = std::sqrt(early_squares / early_frames);
  result.sightings = flight.sightings();
  return result;
}

std::vector<FlightResult> fly_all(const Options& options) {
  std::vector<FlightResult> results(static_cast<std::size_t>(options.seeds));
  std::atomic<int> next{0};
  std::vector<std::jthread> threads;
  threads.reserve(static_cast<std::size_t>(options.threads));
  for (int k = 0; k < options.threads; ++k) {
    threads.emplace_back([&] {
      for (int i = next++; i < options.seeds; i = next++) {
        results[static_cast<std::size_t>(i)] = fly(options.scene, options.first_seed + i);
      }
    });
  }
  threads.clear();  // joins them
  return results;
}

double print_flights(const std::vector<FlightResult>& flights, int first_seed) {
  fmt::print("{:>6}{:>12}{:>9}{:>9}{:>20}{:>18}{:>11}{:>9}{:>7}{:>13}\n", "seed", "largest, m",
             "at, s", "rms, m", "dead reckoning, m", "rms in 150 s, m", "sightings", "used",
             "false", "false, used");
  double most_m = 0;
  for (const FlightResult& flight : flights) {
    fmt::print("{:>6}{:>12.3f}{:>9.0f}{:>9.3f}{:>20.1f}{:>18.2f}{:>11}{:>9}{:>7}{:>13}\n",
               first_seed++, flight.most_m, flight.most_at_s, flight.rms_m,
               flight.dead_reckoned_most_m, flight.dead_reckoned_rms_early_m, flight.sightings.all,
               flight.sightings.used, flight.sightings.falsehoods,
               flight.sightings.used_falsehoods);
    most_m = std::max(most_m, flight.most_m);
  }
  fmt::print("largest error of all flights: {:.3f} m\n", most_m);
  return most_m;
}

void print_nees(const std::vector<FlightResult>& flights, double seconds) {
  constexpr int kDegreesOfFreedom = 6;
  const auto count = static_cast<double>(flights.size());
  const auto band = [&](double probability) {
    return chi_square_quantile(probability, kDegreesOfFreedom * count) / count;
  };
  fmt::print("NEES of the pose's {} degrees of freedom, 99 % of honest means in {:.2f} to {:.2f}\n",
             kDegreesOfFreedom, band(0.005), band(0.995));
  int inside = 0;
  for (std::size_t stamp = 0; stamp < kStamps; ++stamp) {
    double mean = 0;
    for (const FlightResult& flight : flights) mean += flight.nees[stamp] / count;
    inside += mean >= band(0.005) && mean <= band(0.995) ? 1 : 0;
    fmt::print("{:>8.0f} s{:>8.2f}\n", seconds * static_cast<double>(stamp + 1) / kStamps, mean);
  }
  fmt::print("{} of {} inside\n", inside, kStamps);
}

int run(int argc, char** argv) {
  Options options;
  PatrolScene& scene = options.scene;
  CLI::App app("An hour over landmarks that a map knows to a metre, beside dead reckoning");
  app.option_defaults()->always_capture_default();
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_option("--first-seed", options.first_seed);
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  app.add_option("--most-m", options.most_m, "exit status 1 where an error is larger");
  app.add_option("--seconds", scene.seconds)->check(CLI::PositiveNumber);
  app.add_option("--landmarks-per-km2", scene.landmarks_per_km2)->check(CLI::PositiveNumber);
  app.add_option("--landmark-sigma-m", scene.landmark_sigma_m)->check(CLI::PositiveNumber);
  app.add_option("--pixel-sigma-px", scene.pixel_sigma_px)->check(CLI::PositiveNumber);
  app.add_option("--false-ratio", scene.false_ratio, "of the sightings")->check(CLI::Range(0., 1.));
  app.add_option("--frames-per-sighting", scene.frames_per_sighting, "of 25 a second")
      ->check(CLI::PositiveNumber);
  app.add_option("--velocity-noise-m-s", scene.velocity_noise_m_s, "dead reckoning's, white");
  app.add_option("--rate-noise-rad-s", scene.rate_noise_rad_s, "the same of its angular rate");
  app.add_option("--velocity-bias-m-s", scene.velocity_bias_m_s, "its slow error");
  app.add_option("--rate-bias-rad-s", scene.rate_bias_rad_s, "the same of its angular rate");
  CLI11_PARSE(app, argc, argv);

  const std::vector<FlightResult> flights = fly_all(options);
  const double most_m = print_flights(flights, options.first_seed);
  print_nees(flights, scene.seconds);
  return most_m <= options.most_m ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
