#include "io/dataset/sensor_checks.hpp"

#include <cmath>

#include "geometry/angle.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

TimeSeries<Vector6d> constant_imu(const Eigen::Vector3d& force_m_s2) {
  TimeSeries<Vector6d> imu;
  for (int i = 0; i <= 200; ++i) {
    imu.stamps.push_back(from_seconds(0.01 * i));
    imu.values.push_back((Vector6d() << Eigen::Vector3d::Zero(), force_m_s2).finished());
  }
  return imu;
}

TEST(SensorChecks, RejectsSpecificForceInconsistentWithGravity) {
  const TemporaryFolder folder;
  const auto error = [&](const Eigen::Vector3d& force_m_s2) {
    return input_error_of(folder, [&] {
      check_specific_forces(constant_imu(force_m_s2), "imu.path", Eigen::Quaterniond::Identity(),
                            {});
    });
  };
  EXPECT_EQ(error({0.3, 0, 9.7}), "accepted");
  EXPECT_NE(error({0, 0, 1}).find("mean specific force is 1 m/s^2"), std::string::npos);
  EXPECT_NE(error({0, 0, 0}).find("gravity included"), std::string::npos);
  EXPECT_NE(error({0, 0, -9.8}).find("x forward, y left, z up"), std::string::npos);
}

TEST(SensorChecks, NamesTheUnitOfTheSpecificForce) {
  const TemporaryFolder folder;
  const auto error = [&](double up) {
    return input_error_of(folder, [&] {
      check_specific_forces(constant_imu({0, 0, up}), "imu.path", Eigen::Quaterniond::Identity(),
                            {});
    });
  };
  EXPECT_NE(error(1).find("probably in g: convert them to m/s^2 (factor 9.80"), std::string::npos);
  EXPECT_NE(error(1000).find("probably in mg or cm/s^2"), std::string::npos);
  EXPECT_NE(error(32.2).find("probably in ft/s^2"), std::string::npos);
  EXPECT_NE(error(0.2).find("gravity is missing"), std::string::npos);
}

// Vibration of 6 m/s^2 about zero: its mean magnitude is plausible, its mean is not.
TEST(SensorChecks, DetectsMissingGravityUnderVibration) {
  TimeSeries<Vector6d> imu = constant_imu({0, 0, 6});
  for (std::size_t i = 0; i < imu.values.size(); i += 2) imu.values[i] *= -1;
  const TemporaryFolder folder;
  const std::string error = input_error_of(
      folder, [&] { check_specific_forces(imu, "imu.path", Eigen::Quaterniond::Identity(), {}); });
  EXPECT_NE(error.find("gravity is missing"), std::string::npos) << error;
}

// Roll of 0.3 sin(3 t) rad at rest: f = g (0, sin roll, cos roll).
TEST(SensorChecks, RejectsRatesInDegreesPerSecond) {
  const TemporaryFolder folder;
  const auto error = [&](double unit, double sign) {
    TimeSeries<Vector6d> imu;
    for (int i = 0; i <= 2000; ++i) {
      const double t_s = 0.005 * i;
      const double roll_rad = 0.3 * std::sin(3 * t_s);
      imu.stamps.push_back(from_seconds(t_s));
      imu.values.push_back((Vector6d() << sign * 0.9 * std::cos(3 * t_s) / unit, 0, 0.1 / unit, 0,
                            9.8 * std::sin(roll_rad), 9.8 * std::cos(roll_rad))
                               .finished());
    }
    return input_error_of(folder, [&] { check_rate_unit(imu, "imu.path"); });
  };
  EXPECT_EQ(error(1, 1), "accepted");
  EXPECT_EQ(error(1, -1), "accepted") << "wrong axes are not a unit";
  EXPECT_NE(error(kDegree, 1).find("deg/s; convert them to rad/s (factor 0.01745329)"),
            std::string::npos);
}

TEST(SensorChecks, ReportsGapsAndLowRate) {
  SensorLog log;
  log.imu = constant_imu({0, 0, 9.8});
  log.imu.max_gap_s = 0.025;
  for (std::size_t i = 101; i < log.imu.stamps.size(); ++i) log.imu.stamps[i].ns += 440'000'000;
  ASSERT_EQ(coverage_warnings(log, from_seconds(0), from_seconds(2.4)).size(), 1u);
  EXPECT_EQ(coverage_warnings(log, from_seconds(0), from_seconds(2.4))[0],
            "imu.path: 1 gap(s) of more than 0.025 s, 0.45 s in all, the longest 0.45 s from 1.000 "
            "s; they are not interpolated: log every reading");
  EXPECT_TRUE(coverage_warnings(log, from_seconds(0), from_seconds(0.99)).empty());
  log.imu = {};
  for (int i = 0; i <= 20; ++i) {
    log.imu.stamps.push_back(from_seconds(0.1 * i));
    log.imu.values.push_back(Vector6d::Zero());
  }
  ASSERT_EQ(coverage_warnings(log, from_seconds(0), from_seconds(2)).size(), 1u);
  EXPECT_NE(coverage_warnings(log, from_seconds(0), from_seconds(2))[0].find(
                "imu.path: 10 readings per second"),
            std::string::npos);
  log.imu.max_gap_s = 0.25;
  log.imu.stamps.back().ns += 300'000'000;
  ASSERT_EQ(coverage_warnings(log, from_seconds(0), from_seconds(2)).size(), 2u);
  EXPECT_NE(coverage_warnings(log, from_seconds(0), from_seconds(2))[1].find(
                "imu.path: 1 gap(s) of more than 0.25 s, 0.4 s in all"),
            std::string::npos);
}

TEST(SensorChecks, ReportsLogsThatDoNotCoverTheFlight) {
  SensorLog log;
  log.imu = constant_imu({0, 0, 9.8});
  const auto warnings = [&](double from_s, double to_s) {
    return coverage_warnings(log, from_seconds(from_s), from_seconds(to_s));
  };
  EXPECT_TRUE(warnings(0, 2.1).empty());
  ASSERT_EQ(warnings(0, 4).size(), 1u);
  EXPECT_EQ(
      warnings(0, 4)[0],
      "imu.path: covers 2.0 s of 4.0 s: readings from 0.000 s to 2.000 s, images from 0.000 s "
      "to 4.000 s");
  ASSERT_EQ(warnings(100, 104).size(), 1u);
  EXPECT_NE(warnings(100, 104)[0].find("use one clock for both"), std::string::npos);
  EXPECT_TRUE(coverage_warnings({}, from_seconds(0), from_seconds(1)).empty());
}

}  // namespace
}  // namespace stillkite
