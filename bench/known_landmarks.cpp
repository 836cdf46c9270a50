// One-hour patrol over mapped landmarks (1 m accuracy), simulated measurements: maximum pose error,
// compared with dead reckoning, and NEES.

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
  double max_error_m = 1;
};

constexpr std::size_t kStamps = 12;  // evenly spaced over the flight

struct FlightResult {
  double max_error_m = 0;
  double max_error_at_s = 0;
  double rms_m = 0;
  double dead_reckoned_max_m = 0;
  double dead_reckoned_rms_early_m = 0;  // first 150 s, duration of the flow paper's flight
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
    const double dead_reckoned_error_m = flight.error_of(flight.dead_reckoned()).head<3>().norm();
    if (!(error_m <= result.max_error_m)) {
      result.max_error_m = error_m;
      result.max_error_at_s = flight.time_s();
    }
    result.dead_reckoned_max_m = std::max(result.dead_reckoned_max_m, dead_reckoned_error_m);
    squares += error_m * error_m;
    ++frames;
    if (flight.time_s() <= kEarly_s) {
      early_squares += dead_reckoned_error_m * dead_reckoned_error_m;
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
  threads.clear();  // joins
  return results;
}

double print_flights(const std::vector<FlightResult>& flights, int first_seed) {
  fmt::print("{:>6}{:>12}{:>9}{:>9}{:>20}{:>18}{:>11}{:>9}{:>7}{:>13}\n", "seed", "max, m", "at, s",
             "rms, m", "dead reckoning, m", "rms in 150 s, m", "sightings", "used", "false",
             "false, used");
  double max_error_m = 0;
  for (const FlightResult& flight : flights) {
    fmt::print("{:>6}{:>12.3f}{:>9.0f}{:>9.3f}{:>20.1f}{:>18.2f}{:>11}{:>9}{:>7}{:>13}\n",
               first_seed++, flight.max_error_m, flight.max_error_at_s, flight.rms_m,
               flight.dead_reckoned_max_m, flight.dead_reckoned_rms_early_m, flight.sightings.all,
               flight.sightings.used, flight.sightings.falsehoods,
               flight.sightings.used_falsehoods);
    max_error_m = std::max(max_error_m, flight.max_error_m);
  }
  fmt::print("maximum error of all flights: {:.3f} m\n", max_error_m);
  return max_error_m;
}

void print_nees(const std::vector<FlightResult>& flights, double seconds) {
  constexpr int kDegreesOfFreedom = 6;
  const auto count = static_cast<double>(flights.size());
  const auto band = [&](double probability) {
    return chi_square_quantile(probability, kDegreesOfFreedom * count) / count;
  };
  fmt::print("pose NEES, {} degrees of freedom; 99 % band of the mean {:.2f} to {:.2f}\n",
             kDegreesOfFreedom, band(0.005), band(0.995));
  int within_band = 0;
  for (std::size_t stamp = 0; stamp < kStamps; ++stamp) {
    double mean = 0;
    for (const FlightResult& flight : flights) mean += flight.nees[stamp] / count;
    within_band += mean >= band(0.005) && mean <= band(0.995) ? 1 : 0;
    fmt::print("{:>8.0f} s{:>8.2f}\n", seconds * static_cast<double>(stamp + 1) / kStamps, mean);
  }
  fmt::print("{} of {} within the band\n", within_band, kStamps);
}

int run(int argc, char** argv) {
  Options options;
  PatrolScene& scene = options.scene;
  CLI::App app("One-hour patrol over mapped landmarks, compared with dead reckoning");
  app.option_defaults()->always_capture_default();
  app.add_option("--seeds", options.seeds, "number of flights")->check(CLI::PositiveNumber);
  app.add_option("--first-seed", options.first_seed, "seed of the first flight");
  app.add_option("--threads", options.threads, "parallel flights")->check(CLI::PositiveNumber);
  app.add_option("--most-m", options.max_error_m,
                 "maximum position error, m; exit status 1 above it");
  app.add_option("--seconds", scene.seconds, "duration of a flight, s")->check(CLI::PositiveNumber);
  app.add_option("--landmarks-per-km2", scene.landmarks_per_km2, "landmark density, 1/km^2")
      ->check(CLI::PositiveNumber);
  app.add_option("--landmark-sigma-m", scene.landmark_sigma_m,
                 "standard deviation of a landmark coordinate, m")
      ->check(CLI::PositiveNumber);
  app.add_option("--pixel-sigma-px", scene.pixel_sigma_px,
                 "standard deviation of an image coordinate, px")
      ->check(CLI::PositiveNumber);
  app.add_option("--false-ratio", scene.false_ratio, "ratio of false sightings")
      ->check(CLI::Range(0., 1.));
  app.add_option("--frames-per-sighting", scene.frames_per_sighting,
                 "frames between sightings, at 25 Hz")
      ->check(CLI::PositiveNumber);
  app.add_option("--velocity-noise-m-s", scene.velocity_noise_m_s,
                 "white velocity noise of the dead reckoning, m/s");
  app.add_option("--rate-noise-rad-s", scene.rate_noise_rad_s,
                 "white noise of its angular rate, rad/s");
  app.add_option("--velocity-bias-m-s", scene.velocity_bias_m_s,
                 "slowly varying velocity bias, m/s");
  app.add_option("--rate-bias-rad-s", scene.rate_bias_rad_s,
                 "slowly varying angular rate bias, rad/s");
  CLI11_PARSE(app, argc, argv);

  const std::vector<FlightResult> flights = fly_all(options);
  const double max_error_m = print_flights(flights, options.first_seed);
  print_nees(flights, scene.seconds);
  return max_error_m <= options.max_error_m ? 0 : 1;
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
