// Interval errors of StampFilter on simulated streams: RMS of the raw stamps, RMS and standard
// deviation of the filtered ones after 128 frames, errors above 3 sigma over all frames.
//   build/release/bench/bench_stamp_filter

#include "geometry/stamp_filter.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <vector>

namespace {

using namespace stillkite;

constexpr int kSeeds = 100;
constexpr int kFrames = 400;
constexpr std::size_t kConverged = 128;
constexpr double kStampRounding_s = 2e-9;

using Draw = std::function<double(std::mt19937&)>;

struct Case {
  const char* name;
  double rate_hz;
  Draw error_s;
  double resolution_s = 0;
  double interval_sigma_s = 0;
  double missed_ratio = 0;
  double later_rate_hz = 0;  // of the second half; 0: the same
  int burst_length = 1;      // frames that arrive within 1 ms each with the last of them
  int burst_every = 1;       // frames
};

Draw uniform(double bound_s) {
  return [bound_s](std::mt19937& random) {
    return std::uniform_real_distribution(-bound_s, bound_s)(random);
  };
}

Draw exponential(double mean_s) {
  return
      [mean_s](std::mt19937& random) { return std::exponential_distribution(1 / mean_s)(random); };
}

double no_error(std::mt19937& /*random*/) {
  return 0;
}

struct Stream {
  std::vector<double> true_s;
  std::vector<Timestamp> stamps;
};

// Frames that arrive after their successor are lost.
Stream simulate(const Case& c, int seed) {
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  std::normal_distribution<> change_s(0, 1);
  std::bernoulli_distribution is_missed(c.missed_ratio);
  Stream stream;
  double t_s = std::uniform_real_distribution<>(0, 1)(random);
  for (int k = 0; k < kFrames; ++k) {
    const double rate_hz = k > kFrames / 2 && c.later_rate_hz > 0 ? c.later_rate_hz : c.rate_hz;
    t_s += 1 / rate_hz + c.interval_sigma_s * change_s(random);
    if (is_missed(random)) continue;
    const int ahead = c.burst_length - 1 - k % c.burst_every;
    double stamp_s = t_s + c.error_s(random) + std::max(0, ahead) * (1 / c.rate_hz - 1e-3);
    if (c.resolution_s > 0) stamp_s = std::floor(stamp_s / c.resolution_s) * c.resolution_s;
    const Timestamp stamp = from_seconds(stamp_s);
    if (!stream.stamps.empty() && stamp <= stream.stamps.back()) continue;
    stream.true_s.push_back(t_s);
    stream.stamps.push_back(stamp);
  }
  return stream;
}

struct Sums {
  double raw_s2 = 0, error_s2 = 0, variance_s2 = 0;
  int all = 0, converged = 0, beyond = 0;
};

// A recorded stream: eight following stamps are known.
void add(const Stream& stream, StampFilter filter, Sums& sums) {
  constexpr std::size_t kFollowing = 8;
  const auto following = [&](std::size_t k) {
    const std::size_t count = std::min(kFollowing, stream.stamps.size() - k - 1);
    return std::span(stream.stamps).subspan(k + 1, count);
  };
  FilteredStamp before = filter.next(stream.stamps[0], following(0));
  for (std::size_t k = 1; k < stream.stamps.size(); ++k) {
    const FilteredStamp now = filter.next(stream.stamps[k], following(k));
    const double true_s = stream.true_s[k] - stream.true_s[k - 1];
    const double error_s = seconds_between(before.stamp, now.stamp) - true_s;
    const double sigma_s = std::numbers::sqrt2 * now.sigma_s;
    sums.raw_s2 += std::pow(seconds_between(stream.stamps[k - 1], stream.stamps[k]) - true_s, 2);
    ++sums.all;
    sums.beyond += std::abs(error_s) > 3 * sigma_s + kStampRounding_s ? 1 : 0;
    if (k >= kConverged) {
      sums.error_s2 += error_s * error_s;
      sums.variance_s2 += sigma_s * sigma_s;
      ++sums.converged;
    }
    before = now;
  }
}

void print(const Case& c) {
  Sums sums;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    add(simulate(c, seed), StampFilter(c.resolution_s), sums);
  }
  const auto rms_ms = [](double sum_s2, int count) { return 1e3 * std::sqrt(sum_s2 / count); };
  fmt::print("{:36}{:9.3f}{:10.3f}{:10.3f}{:11.2f}\n", c.name, rms_ms(sums.raw_s2, sums.all),
             rms_ms(sums.error_s2, sums.converged), rms_ms(sums.variance_s2, sums.converged),
             100.0 * sums.beyond / sums.all);
}

}  // namespace

int main() {
  fmt::print("{:36}{:>9}{:>10}{:>10}{:>11}\n", "stamps", "raw, ms", "RMS, ms", "sigma, ms",
             "> 3s, %");
  print({"+-2 ms, 30 Hz", 30, uniform(2e-3)});
  print({"+-2 ms, 240 Hz", 240, uniform(2e-3)});
  print({"exponential 4 ms, 30 Hz", 30, exponential(4e-3)});
  print({"exponential 8 ms, 30 Hz", 30, exponential(8e-3)});
  print({"rounded to 1 ms, 30 Hz", 30, no_error, 1e-3});
  print({"rounded to 1 ms, 50.02 Hz", 50.02, no_error, 1e-3});
  print({"irregular by 2 ms, 30 Hz", 30, no_error, 0, 2e-3});
  print({"+-2 ms, irregular by 1 ms, 30 Hz", 30, uniform(2e-3), 0, 1e-3});
  print({"+-2 ms, 5 % missed, 30 Hz", 30, uniform(2e-3), 0, 0, 0.05});
  print({"+-5 ms, 5 % missed, 30 Hz", 30, uniform(5e-3), 0, 0, 0.05});
  print({"+-2 ms, 30 to 20 Hz", 30, uniform(2e-3), 0, 0, 0, 20});
  print({"+-2 ms, 30 to 25 Hz", 30, uniform(2e-3), 0, 0, 0, 25});
  print({"+-2 ms, 30 to 60 Hz", 30, uniform(2e-3), 0, 0, 0, 60});
  print({"bursts of 2, 30 Hz", 30, no_error, 0, 0, 0, 0, 2, 2});
  print({"bursts of 4, 30 Hz", 30, no_error, 0, 0, 0, 0, 4, 4});
  print({"bursts of 8, 30 Hz", 30, no_error, 0, 0, 0, 0, 8, 8});
  print({"burst of 5 in 40 frames, 30 Hz", 30, no_error, 0, 0, 0, 0, 5, 40});
  print({"burst of 30 in 200 frames, 30 Hz", 30, no_error, 0, 0, 0, 0, 30, 200});
}
