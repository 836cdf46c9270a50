#include "io/dataset/sensor_checks.hpp"

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

TimeSeries<Vector6d> constant_imu(const Eigen::Vector3d& force_m_s2) {
  TimeSeries<Vector6d> imu;
  for (int i = 0; i <= 20; ++i) {
    imu.stamps.push_back(from_seconds(0.1 * i));
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
