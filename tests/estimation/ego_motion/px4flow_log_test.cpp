#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "estimation/ego_motion/kalman_filter.hpp"

// PX4Flow log of an 849 s flight through the Kalman filters with the paper's parameters, without
// tuning of latency, weights or scale.
//
// The sensor measures angular image flow and gyro rotation; their sum is the translational flow.
// Motion field at x = y = 0: velocity across the optical axis = flow x range, at any attitude.

namespace stillkite {
namespace {

constexpr double kMinRange_m = 0.3;

std::vector<std::vector<double>> read_rows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0; words >> value;) row.push_back(value);
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

struct Sample {
  double t_ms;
  double range_m;
  double speed_m_s;
};

// Filtered ground speed after every row of the flow sensor.
std::vector<Sample> filtered_speeds(const std::vector<std::vector<double>>& flow_rows) {
  std::vector<Sample> samples;
  AxisEstimates state;
  state.fill({0, 1});
  double last_t_ms = flow_rows.front()[0];
  for (const std::vector<double>& row : flow_rows) {
    const double range_m = row[3];
    const double quality = row[4];
    std::optional<AxisMeasurement> measured;
    if (range_m > kMinRange_m && quality > 0) {
      measured = AxisMeasurement{Vector6d::Zero(), Vector6d::Ones()};
      measured->value.head<2>() = range_m * Eigen::Vector2d(row[1] + row[6], row[2] + row[7]);
    }
    state = filter_axes({}, state, measured, Vector6d::Zero(), 1e-3 * (row[0] - last_t_ms));
    last_t_ms = row[0];
    samples.push_back({row[0], range_m, std::hypot(state[0].value, state[1].value)});
  }
  return samples;
}

struct Agreement {
  int samples = 0;
  double correlation = 0;
  double slope = 0;  ///< least-squares line of GPS speed over flow speed
  double slope_through_zero = 0;
};

Agreement compare(const std::vector<Sample>& flow, const std::vector<std::vector<double>>& gps) {
  Agreement out;
  double sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (const std::vector<double>& row : gps) {
    const auto next = std::upper_bound(flow.begin(), flow.end(), row[0],
                                       [](double t, const Sample& s) { return t < s.t_ms; });
    if (next == flow.begin()) continue;
    const Sample& last = *(next - 1);
    if (last.range_m <= kMinRange_m) continue;
    const double x = last.speed_m_s;
    const double y = row[10];
    ++out.samples;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
  }
  const double n = out.samples;
  out.slope = (sxy - sx * sy / n) / (sxx - sx * sx / n);
  out.correlation = (sxy - sx * sy / n) / std::sqrt((sxx - sx * sx / n) * (syy - sy * sy / n));
  out.slope_through_zero = sxy / sxx;
  return out;
}

TEST(Px4flowLog, FilteredFlowTimesRangeMatchesGpsSpeed) {
  const char* data = std::getenv("STILLKITE_DATA");
  if (data == nullptr || *data == '\0') GTEST_SKIP() << "STILLKITE_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "px4flow_log";
  const auto flow = read_rows(folder / "FLOW.txt");
  const auto gps = read_rows(folder / "GPS.txt");
  ASSERT_EQ(flow.size(), 8051U);
  const Agreement agreement = compare(filtered_speeds(flow), gps);
  std::cout << "px4flow_log: " << agreement.samples << " samples, correlation "
            << agreement.correlation << ", slope " << agreement.slope << ", through zero "
            << agreement.slope_through_zero << '\n';
  EXPECT_GT(agreement.samples, 4100);
  EXPECT_GE(agreement.correlation, 0.993);
  EXPECT_NEAR(agreement.slope, 0.96, 0.02);
  EXPECT_NEAR(agreement.slope_through_zero, 1, 0.01);
}

}  // namespace
}  // namespace stillkite
