#include "evaluation/mean_interval.hpp"

#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace stillkite {
namespace {

constexpr double kConfidence = 0.95;
constexpr std::size_t kBatches = 10;
constexpr std::size_t kTestBatches = 20;  // ten accept one random walk in six

double mean_of(std::span<const double> samples) {
  return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
}

double squared_deviations(std::span<const double> samples) {
  const double mean = mean_of(samples);
  double sum = 0;
  for (const double sample : samples) sum += (sample - mean) * (sample - mean);
  return sum;
}

std::vector<double> batch_means(std::span<const double> samples, std::size_t batches) {
  std::vector<double> means;
  means.reserve(batches);
  for (std::size_t i = 0; i < batches; ++i) {
    const std::size_t from = i * samples.size() / batches;
    const std::size_t to = (i + 1) * samples.size() / batches;
    means.push_back(mean_of(samples.subspan(from, to - from)));
  }
  return means;
}

MeanInterval interval_about(double mean, std::span<const double> independent) {
  const auto n = static_cast<int>(independent.size());
  const double error = std::sqrt(squared_deviations(independent) / (n - 1) / n);
  const double half_width = student_t_two_sided_quantile(kConfidence, n - 1) * error;
  return {.samples = n, .mean = mean, .low = mean - half_width, .high = mean + half_width};
}

/// Young's statistic C = 1 - sum (x_i - x_i+1)^2 / (2 sum (x_i - mean)^2): mean 0 and variance
/// (n - 2) / (n^2 - 1) for n independent normal samples.
bool is_serially_correlated(std::span<const double> samples) {
  constexpr double kNormalQuantile95 = 1.645;
  const auto n = static_cast<double>(samples.size());
  const double spread = squared_deviations(samples);
  const double rounding = 1e-12 * std::abs(mean_of(samples));
  if (!(spread > n * rounding * rounding)) return false;
  double steps = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    steps += (samples[i] - samples[i - 1]) * (samples[i] - samples[i - 1]);
  }
  return 1 - steps / (2 * spread) > kNormalQuantile95 * std::sqrt((n - 2) / (n * n - 1));
}

}  // namespace

std::optional<MeanInterval> independent_mean_interval(std::span<const double> samples) {
  if (samples.size() < 2) return std::nullopt;
  return interval_about(mean_of(samples), samples);
}

std::optional<MeanInterval> correlated_mean_interval(std::span<const double> samples) {
  if (samples.size() < kTestBatches) return std::nullopt;
  MeanInterval result = interval_about(mean_of(samples), batch_means(samples, kBatches));
  result.samples = static_cast<int>(samples.size());
  result.is_reliable = !is_serially_correlated(batch_means(samples, kTestBatches));
  return result;
}

bool differs_from_zero(const MeanInterval& interval) {
  return interval.is_reliable && (interval.low > 0 || interval.high < 0);
}

double student_t_probability(double t, int degrees_of_freedom) {
  assert(t >= 0 && degrees_of_freedom >= 1);
  const double dof = degrees_of_freedom;
  const double angle_rad = std::atan(t / std::sqrt(dof));
  const double cos_squared = dof / (dof + t * t);
  const bool is_odd = degrees_of_freedom % 2 == 1;
  // odd: 1 + 2/3 c^2 + (2 4)/(3 5) c^4 ...; even: 1 + 1/2 c^2 + (1 3)/(2 4) c^4 ...; up to
  // c^(dof-2)
  double term = 1;
  double sum = 0;
  for (int k = is_odd ? 3 : 2; k <= degrees_of_freedom; k += 2) {
    sum += term;
    term *= cos_squared * (k - 1) / k;
  }
  if (!is_odd) return std::sin(angle_rad) * sum;
  return 2 / std::numbers::pi * (angle_rad + std::sin(angle_rad) * std::cos(angle_rad) * sum);
}

double student_t_two_sided_quantile(double confidence, int degrees_of_freedom) {
  assert(confidence > 0 && confidence < 1);
  double low = 0;
  double high = 1;
  while (student_t_probability(high, degrees_of_freedom) < confidence) high *= 2;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (student_t_probability(middle, degrees_of_freedom) < confidence ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace stillkite
