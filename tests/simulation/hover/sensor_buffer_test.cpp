#include "simulation/hover/sensor_buffer.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

HoverReadings attitude_at(double t_s, double rate_rad_s) {
  HoverReadings readings;
  readings.attitude.push_back({.stamp = from_seconds(t_s),
                               .world_from_body = Eigen::Quaterniond::Identity(),
                               .angular_rate_in_body_rad_s = {rate_rad_s, 0, 0},
                               .specific_force_in_body_m_s2 = {0, 0, 9.8}});
  return readings;
}

std::vector<InertialReading> inertial_until(SensorBuffer& buffer, double t_s) {
  return buffer.readings(from_seconds(t_s), Eigen::Quaterniond::Identity(), from_seconds(1))
      .sensors.inertial;
}

// No gap in the inertial data between image stamps.
TEST(SensorBuffer, SplitsReadingAtImageStamp) {
  SensorBuffer buffer(Eigen::Quaterniond::Identity());
  for (const double t_s : {0.005, 0.010, 0.015}) buffer.add(attitude_at(t_s, 100 * t_s));
  const std::vector<InertialReading> first = inertial_until(buffer, 0.008);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[1].stamp, from_seconds(0.008));
  EXPECT_DOUBLE_EQ(first[1].angular_rate_in_body_rad_s.x(), 1.0);
  const std::vector<InertialReading> second = inertial_until(buffer, 0.014);
  ASSERT_EQ(second.size(), 2u);
  EXPECT_EQ(second[0].stamp, from_seconds(0.010));
  EXPECT_DOUBLE_EQ(second[0].angular_rate_in_body_rad_s.x(), 1.0);
  EXPECT_EQ(second[1].stamp, from_seconds(0.014));
  ASSERT_EQ(inertial_until(buffer, 0.016).size(), 1u) << "remainder without a later reading";
}

}  // namespace
}  // namespace stillkite
