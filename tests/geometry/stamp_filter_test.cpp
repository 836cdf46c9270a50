#include "geometry/stamp_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <utility>

namespace stillkite {
namespace {

constexpr double kPeriod_s = 1.0 / 30;
constexpr int kFrames = 400;
constexpr double kRounding_s = 2e-9;  // of an interval between two stamps
constexpr int kConverged = 128;       // length of the window

struct Stream {
  std::vector<double> true_s;
  std::vector<Timestamp> stamps;
};

// Regular camera whose stamps have the errors `error_s`, from the epoch of 2023.
Stream regular_stream(
    const std::function<double()>& error_s,
    const std::function<bool(int)>& is_missed = [](int) { return false; }) {
  Stream stream;
  for (int k = 0; k < kFrames; ++k) {
    if (is_missed(k)) continue;
    stream.true_s.push_back(k * kPeriod_s);
    stream.stamps.push_back(
        {1'700'000'000'000'000'000 + std::llround(1e9 * (k * kPeriod_s + error_s()))});
  }
  return stream;
}

std::function<double()> uniform(double bound_s) {
  return [random = std::mt19937(7), draw = std::uniform_real_distribution<>(
                                        -bound_s, bound_s)]() mutable { return draw(random); };
}

std::vector<FilteredStamp> filter_all(const Stream& stream, StampFilter filter = StampFilter()) {
  std::vector<FilteredStamp> out;
  for (const Timestamp stamp : stream.stamps) out.push_back(filter.next(stamp));
  return out;
}

double interval_error_s(const Stream& stream, const std::vector<FilteredStamp>& filtered,
                        std::size_t k) {
  return seconds_between(filtered[k - 1].stamp, filtered[k].stamp) -
         (stream.true_s[k] - stream.true_s[k - 1]);
}

// RMS error of the intervals and of their standard deviation sqrt(2) sigma, from `first` on.
struct IntervalErrors {
  double rms_s = 0, sigma_s = 0;
};
IntervalErrors interval_errors(const Stream& stream, const std::vector<FilteredStamp>& filtered,
                               std::size_t first) {
  double error = 0, variance = 0;
  for (std::size_t k = first; k < filtered.size(); ++k) {
    error += std::pow(interval_error_s(stream, filtered, k), 2);
    variance += 2 * std::pow(filtered[k].sigma_s, 2);
  }
  const double count = static_cast<double>(filtered.size() - first);
  return {std::sqrt(error / count), std::sqrt(variance / count)};
}

double share_beyond_3_sigma(const Stream& stream, const std::vector<FilteredStamp>& filtered) {
  int beyond = 0;
  for (std::size_t k = 1; k < filtered.size(); ++k) {
    beyond += std::abs(interval_error_s(stream, filtered, k)) >
              3 * std::sqrt(2.0) * filtered[k].sigma_s + kRounding_s;
  }
  return static_cast<double>(beyond) / static_cast<double>(filtered.size());
}

TEST(StampFilter, ExactStampsAreReturnedAsTheyAre) {
  const Stream stream = regular_stream([] { return 0.0; }, [](int k) { return k % 17 == 5; });
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  for (std::size_t k = 0; k < filtered.size(); ++k) {
    EXPECT_EQ(filtered[k].stamp, stream.stamps[k]);
    EXPECT_EQ(filtered[k].sigma_s, 0);
  }
}

// A line through 128 stamps leaves an interval an error of about 4 sigma / 128 where the ratio of
// the variances is known.
TEST(StampFilter, RemovesTheJitterOfARegularCamera) {
  const double bound_s = 2e-3;
  const Stream stream = regular_stream(uniform(bound_s));
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  const IntervalErrors errors = interval_errors(stream, filtered, kConverged);
  EXPECT_LT(errors.rms_s, 0.1e-3);  // raw: 1.63 ms
  EXPECT_LT(errors.sigma_s, 0.2e-3);
  EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.02);
  for (std::size_t k = 1; k < filtered.size(); ++k) {
    EXPECT_GT(filtered[k].stamp, filtered[k - 1].stamp);
  }
}

TEST(StampFilter, EstimatesTheJitter) {
  const double bound_s = 2e-3;
  const Stream stream = regular_stream(uniform(bound_s));
  StampFilter filter;
  for (const Timestamp stamp : stream.stamps) (void)filter.next(stamp);
  EXPECT_NEAR(filter.jitter_s(), bound_s / std::sqrt(3.0), 0.1 * bound_s);
  EXPECT_NEAR(filter.period_s(), kPeriod_s, 1e-3 * kPeriod_s);
}

TEST(StampFilter, KnownStreamHasASigmaFromTheFirstInterval) {
  const double bound_s = 2e-3;
  const Stream stream = regular_stream(uniform(bound_s));
  StampFilter filter;
  filter.initialize(stream.stamps);
  (void)filter.next(stream.stamps[0]);
  EXPECT_NEAR(filter.next(stream.stamps[1]).sigma_s, bound_s / std::sqrt(3.0), 0.1 * bound_s);
}

// Uniform error of one step: variance step^2 / 12.
TEST(StampFilter, RoundedStampsHaveTheErrorOfTheirStep) {
  const double step_s = 1e-3;
  const Stream exact = regular_stream([] { return 0.0; });
  Stream rounded = exact;
  for (Timestamp& stamp : rounded.stamps) stamp.ns = stamp.ns / 1'000'000 * 1'000'000;
  const std::vector<FilteredStamp> filtered = filter_all(rounded, StampFilter(step_s));
  EXPECT_NEAR(filtered[1].sigma_s, step_s / std::sqrt(12.0), 1e-9);
  EXPECT_LT(interval_errors(rounded, filtered, kConverged).rms_s, 0.03e-3);  // raw: 0.47 ms
  EXPECT_LT(share_beyond_3_sigma(rounded, filtered), 0.01);
}

// The camera's intervals change by 2 ms (1 sigma), the stamps are exact.
TEST(StampFilter, FollowsAnIrregularCamera) {
  std::mt19937 random(3);
  std::normal_distribution<> change_s(0, 2e-3);
  Stream stream;
  double t_s = 0;
  for (int k = 0; k < kFrames; ++k) {
    stream.true_s.push_back(t_s);
    stream.stamps.push_back(from_seconds(t_s));
    t_s += kPeriod_s + change_s(random);
  }
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  EXPECT_LT(interval_errors(stream, filtered, kConverged).rms_s, 0.3e-3);
  EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.02);
}

TEST(StampFilter, MissedFramesAreNoJitter) {
  std::mt19937 random(5);
  std::bernoulli_distribution is_missed(0.05);
  const Stream stream =
      regular_stream(uniform(2e-3), [&](int k) { return k > 0 && is_missed(random); });
  const IntervalErrors errors = interval_errors(stream, filter_all(stream), kConverged);
  EXPECT_LT(errors.rms_s, 0.1e-3);
}

// One frame in 20 arrives 20 ms late: the next one is on time.
TEST(StampFilter, LateFramesAreNoMissedFrames) {
  std::mt19937 random(9);
  std::bernoulli_distribution is_late(0.05);
  const Stream stream = regular_stream([&] { return is_late(random) ? 20e-3 : 0.0; });
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  EXPECT_LT(interval_errors(stream, filtered, kConverged).rms_s, 2e-3);  // raw: 6 ms
  EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.05);
}

TEST(StampFilter, FollowsTheOnsetOfJitter) {
  std::function<double()> error_s = uniform(5e-3);
  int frame = 0;
  const Stream stream = regular_stream([&] { return ++frame > 150 ? error_s() : 0.0; });
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  const IntervalErrors errors = interval_errors(stream, filtered, 150 + kConverged);
  EXPECT_LT(errors.rms_s, 0.5e-3);  // raw: 4.1 ms
  EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.02);
}

// Automatic exposure: 30 frames/s, then another rate, +-2 ms.
TEST(StampFilter, StartsAnewAtAnotherFrameRate) {
  for (const double rate_hz : {20.0, 25.0, 60.0}) {
    std::function<double()> error_s = uniform(2e-3);
    Stream stream;
    double t_s = 0;
    for (int k = 0; k < kFrames; ++k) {
      stream.true_s.push_back(t_s);
      stream.stamps.push_back(from_seconds(t_s + error_s()));
      t_s += k < 200 ? kPeriod_s : 1 / rate_hz;
    }
    const std::vector<FilteredStamp> filtered = filter_all(stream);
    EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.02) << rate_hz;
    EXPECT_LT(interval_errors(stream, filtered, 200 + kConverged).rms_s, 0.1e-3) << rate_hz;
  }
}

// After one late frame a pause of the camera is still a pause.
TEST(StampFilter, PauseIsNoLateFrame) {
  std::function<double()> error_s = uniform(1e-3);
  Stream stream;
  for (int k = 0; k < 300; ++k) {
    stream.true_s.push_back(k * kPeriod_s + (k < 220 ? 0 : 1));
    stream.stamps.push_back(
        from_seconds(stream.true_s.back() + error_s() + (k == 180 ? 0.022 : 0)));
  }
  EXPECT_NEAR(interval_error_s(stream, filter_all(stream), 220), 0, 2e-3);
}

TEST(StampFilter, StepBackStartsAnew) {
  Stream stream = regular_stream(uniform(2e-3));
  for (std::size_t k = 200; k < stream.stamps.size(); ++k) stream.stamps[k].ns -= 1'000'000'000;
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  EXPECT_EQ(filtered[200].stamp, stream.stamps[200]);
  EXPECT_LT(filtered[200].stamp, filtered[199].stamp);
  EXPECT_GT(filtered[201].stamp, filtered[200].stamp);
  EXPECT_LT(interval_errors(stream, filtered, 200 + kConverged).rms_s, 0.1e-3);
}

TEST(StampFilter, RemovesExponentialDelays) {
  std::mt19937 random(13);
  std::exponential_distribution<> delay_s(1 / 4e-3);
  const Stream stream = regular_stream([&] { return delay_s(random); });
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  EXPECT_LT(interval_errors(stream, filtered, kConverged).rms_s, 4e-3);  // raw: 5.7 ms
  EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.03);
}

// `length` frames arrive within a millisecond of each other with the last of them, every `every`.
Stream burst_stream(int length, int every) {
  Stream stream;
  for (int k = 0; k < kFrames; ++k) {
    const int ahead = length - 1 - k % every;
    const double late_s = ahead > 0 ? ahead * (kPeriod_s - 1e-3) : 0;
    stream.true_s.push_back(k * kPeriod_s);
    stream.stamps.push_back(from_seconds(k * kPeriod_s + late_s));
  }
  return stream;
}

std::vector<FilteredStamp> filter_recorded(const Stream& stream, StampFilter filter) {
  constexpr std::size_t kFollowing = 8;
  std::vector<FilteredStamp> out;
  const std::span<const Timestamp> stamps = stream.stamps;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const std::size_t count = std::min(kFollowing, stamps.size() - k - 1);
    out.push_back(filter.next(stamps[k], stamps.subspan(k + 1, count)));
  }
  return out;
}

TEST(StampFilter, BurstsOfARecordedStreamAreRespaced) {
  for (const auto& [length, every] : {std::pair(2, 2), std::pair(4, 4), std::pair(5, 40)}) {
    const Stream stream = burst_stream(length, every);
    StampFilter filter;
    filter.initialize(stream.stamps);
    const std::vector<FilteredStamp> filtered = filter_recorded(stream, filter);
    EXPECT_LT(interval_errors(stream, filtered, kConverged).rms_s, 0.1e-3) << length;
    EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.01) << length;
  }
}

TEST(StampFilter, BurstsOfALiveStreamAreRespacedOnceTheyRecur) {
  for (const int length : {3, 4, 5}) {
    const Stream stream = burst_stream(length, length);
    const std::vector<FilteredStamp> filtered = filter_all(stream);
    EXPECT_LT(interval_errors(stream, filtered, kConverged).rms_s, 0.1e-3) << length;
    EXPECT_LT(share_beyond_3_sigma(stream, filtered), 0.06) << length;
  }
}

// The transmission stops for 0.97 s, then delivers 29 frames at once.
TEST(StampFilter, BurstAfterAnInterruptionHasTheSigmaOfItsPeriod) {
  const Stream stream = burst_stream(30, 250);
  const std::vector<FilteredStamp> filtered = filter_recorded(stream, StampFilter());
  for (std::size_t k = 251; k < 279; ++k) {
    EXPECT_NEAR(std::sqrt(2.0) * filtered[k].sigma_s, kPeriod_s - 1e-3, 1e-6) << k;
  }
  EXPECT_EQ(filtered[285].sigma_s, 0);
}

TEST(StampFilter, CountsTheStampsInBursts) {
  const Stream stream = burst_stream(2, 2);
  StampFilter filter;
  filter.initialize(stream.stamps);
  for (const Timestamp stamp : stream.stamps) (void)filter.next(stamp);
  EXPECT_EQ(filter.burst_stamps(), kFrames / 2);
}

TEST(StampFilter, FirstStampsOfAnUnknownStreamAreNotChanged) {
  const Stream stream = regular_stream(uniform(2e-3));
  const std::vector<FilteredStamp> filtered = filter_all(stream);
  for (std::size_t k = 0; k < 16; ++k) EXPECT_EQ(filtered[k].stamp, stream.stamps[k]);
  for (std::size_t k = 3; k < 16; ++k) EXPECT_GT(filtered[k].sigma_s, 0.2e-3);
}

}  // namespace
}  // namespace stillkite
