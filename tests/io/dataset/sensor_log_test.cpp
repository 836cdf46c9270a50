#include "io/dataset/sensor_log.hpp"

#include <cmath>
#include <random>

#include <fmt/core.h>
#include "navigation/navigator.hpp"

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

Timestamp at_s(double t_s) {
  return from_seconds(t_s);
}

TEST(SensorLog, InterpolatesHeightWithinTheLogOnly) {
  const SensorLog log{
      .height_m = {.stamps = {at_s(1.0), at_s(1.2), at_s(3.0)}, .values = {10, 12, 30}}};
  const auto height = [&](double t_s) {
    return readings_between(log, at_s(0), at_s(t_s)).height_m;
  };
  EXPECT_DOUBLE_EQ(*height(1.0), 10);
  EXPECT_DOUBLE_EQ(*height(1.05), 10.5);
  EXPECT_DOUBLE_EQ(*height(3.0), 30);
  EXPECT_FALSE(height(0.99).has_value());
  EXPECT_FALSE(height(3.06).has_value());
  EXPECT_FALSE(height(2.0).has_value());  // in a gap of 1.8 s
  // each reading is used once: none is new between 1.0 and 1.1
  EXPECT_FALSE(readings_between(log, at_s(1.0), at_s(1.1)).height_m.has_value());
  EXPECT_DOUBLE_EQ(*readings_between(log, at_s(0.9), at_s(1.1)).height_m, 11);
  EXPECT_FALSE(readings_between({}, at_s(0), at_s(1)).height_m.has_value());
}

// At 1 Hz readings are not interpolated.
TEST(SensorLog, HoldsReadingsOfASlowSensorForMaxAge) {
  const SensorLog log{.height_m = {.stamps = {at_s(1), at_s(2), at_s(3)}, .values = {10, 12, 30}}};
  const auto height = [&](double before_s, double now_s) {
    return readings_between(log, at_s(before_s), at_s(now_s)).height_m;
  };
  EXPECT_EQ(height(1.99, 2.03), 12);
  EXPECT_FALSE(height(2.03, 2.07).has_value());
  EXPECT_FALSE(height(1.9, 2.1).has_value());
  EXPECT_EQ(height(2.97, 3.01), 30);
}

TEST(SensorLog, MeanOfALinearRateIsItsMidpointValue) {
  SensorLog log;
  auto& gyro = log.angular_rate_in_body_rad_s;
  for (int i = 0; i <= 100; ++i) {
    const double t_s = 0.005 * i;
    gyro.stamps.push_back(at_s(t_s));
    gyro.values.emplace_back(2 * t_s, -t_s, 1);
  }
  for (const auto& [from, to] : {std::pair{0.0, 0.5}, {0.1012, 0.1391}, {0.2001, 0.2003}}) {
    const auto mean = readings_between(log, at_s(from), at_s(to)).mean_angular_rate_in_body_rad_s;
    ASSERT_TRUE(mean.has_value());
    const double middle = 0.5 * (from + to);
    EXPECT_LT((*mean - Eigen::Vector3d(2 * middle, -middle, 1)).norm(), 1e-9);
  }
  EXPECT_FALSE(readings_between(log, at_s(0.4), at_s(0.6)).mean_angular_rate_in_body_rad_s);
  EXPECT_FALSE(readings_between(log, at_s(0.4), at_s(0.4)).mean_angular_rate_in_body_rad_s);
}

// For a linear signal each mean is the midpoint value.
TEST(SensorLog, ImuReadingsCoverExactlyTheFrameInterval) {
  SensorLog log;
  for (int i = 0; i <= 20; ++i) {
    const double t_s = 0.01 * i;
    log.imu.stamps.push_back(at_s(t_s));
    log.imu.values.push_back((Vector6d() << t_s, 0, 1, 0, -3 * t_s, 9.8).finished());
  }
  const std::vector<InertialReading> readings =
      readings_between(log, at_s(0.013), at_s(0.052)).inertial;
  ASSERT_EQ(readings.size(), 5u);
  double from_s = 0.013;
  for (const InertialReading& reading : readings) {
    const double to_s = to_seconds(reading.stamp);
    const double middle_s = 0.5 * (from_s + to_s);
    EXPECT_NEAR(reading.angular_rate_in_body_rad_s.x(), middle_s, 1e-9);
    EXPECT_NEAR(reading.specific_force_in_body_m_s2.y(), -3 * middle_s, 1e-9);
    from_s = to_s;
  }
  EXPECT_EQ(readings.back().stamp, at_s(0.052));
  EXPECT_EQ(readings_between(log, at_s(0.195), at_s(0.3)).inertial.size(), 1u) << "end of the log";
  EXPECT_TRUE(readings_between(log, at_s(0.1), at_s(0.1)).inertial.empty());
  log.imu.stamps.back() = at_s(2);
  EXPECT_TRUE(readings_between(log, at_s(1), at_s(1.1)).inertial.empty()) << "gap";
}

// 200 readings per second without those from 0.1 to 0.55 s.
TEST(SensorLog, DoesNotInterpolateInAGap) {
  SensorLog log;
  for (int i = 0; i <= 200; ++i) {
    if (i > 20 && i < 110) continue;
    log.imu.stamps.push_back(at_s(0.005 * i));
    log.imu.values.push_back(Vector6d::Constant(0.005 * i));
    log.angular_rate_in_body_rad_s.values.push_back(Eigen::Vector3d::Zero());
  }
  log.angular_rate_in_body_rad_s.stamps = log.imu.stamps;
  log.imu.max_gap_s = log.angular_rate_in_body_rad_s.max_gap_s = max_gap_s(log.imu.stamps);
  EXPECT_DOUBLE_EQ(log.imu.max_gap_s, 0.02);
  const auto between = [&](double from_s, double to_s) {
    return readings_between(log, at_s(from_s), at_s(to_s));
  };
  EXPECT_TRUE(between(0.2, 0.3).inertial.empty());
  EXPECT_FALSE(between(0.2, 0.3).mean_angular_rate_in_body_rad_s.has_value());
  EXPECT_FALSE(between(0.09, 0.6).mean_angular_rate_in_body_rad_s.has_value());
  // up to the gap, and from its end
  EXPECT_EQ(between(0.09, 0.12).inertial.size(), 2u);
  EXPECT_EQ(between(0.09, 0.12).inertial.back().stamp, at_s(0.1));
  const std::vector<InertialReading> after = between(0.53, 0.57).inertial;
  ASSERT_EQ(after.size(), 4u);
  EXPECT_EQ(after[0].stamp, at_s(0.555));
  EXPECT_EQ(after[0].valid_from, at_s(0.55));
  EXPECT_FALSE(after[1].valid_from.has_value());
  EXPECT_DOUBLE_EQ(after[0].angular_rate_in_body_rad_s.x(), 0.5525);
}

TEST(SensorLog, MaxGapFollowsTheRate) {
  const auto every = [](double interval_s) {
    std::vector<Timestamp> stamps;
    for (int i = 0; i < 10; ++i) stamps.push_back(at_s(interval_s * i));
    return max_gap_s(stamps);
  };
  EXPECT_DOUBLE_EQ(every(0.001), 0.02);
  EXPECT_DOUBLE_EQ(every(0.1), 0.25);
  EXPECT_DOUBLE_EQ(every(1), kMaxGap_s);
  EXPECT_DOUBLE_EQ(max_gap_s({}), kMaxGap_s);
}

TEST(SensorLog, InterpolatesAttitudeAtConstantRate) {
  const SensorLog log{
      .attitude = {.stamps = {at_s(0), at_s(0.4)},
                   .values = {Eigen::Quaterniond::Identity(), so3_exp({0, 0, 1.2})}}};
  const auto attitude = readings_between(log, at_s(-0.1), at_s(0.1)).attitude;
  ASSERT_TRUE(attitude.has_value());
  EXPECT_LT(angle_between_rad(*attitude, so3_exp({0, 0, 0.3})), 1e-9);
}

TEST(SensorLog, ReadsEveryKindOfFile) {
  const TemporaryFolder folder;
  const auto gyro = read_gyro(folder.file("imu.csv",
                                          "#timestamp [ns],wx,wy,wz,ax,ay,az\n"
                                          "1403715273262142976,1,2,3,4,5,6\n"));
  EXPECT_EQ(gyro.stamps[0].ns, 1403715273262142976);
  EXPECT_EQ(gyro.values[0], Eigen::Vector3d(1, 2, 3));
  const auto imu = read_imu(folder.file("imu.csv", "1,1,2,3,4,5,6\n"));
  EXPECT_EQ(imu.values[0], (Vector6d() << 1, 2, 3, 4, 5, 6).finished());
  const auto heights = read_heights(folder.file("range.csv", "t [s],height [m]\n0.5,12.25\n"));
  EXPECT_EQ(heights.stamps[0], at_s(0.5));
  EXPECT_EQ(heights.values[0], 12.25);
  const auto attitudes = read_attitudes(folder.file("att.csv", "1,0.5,-0.5,0.5,0.5\n"));
  EXPECT_EQ(attitudes.values[0].w(), 0.5);
  EXPECT_EQ(attitudes.values[0].x(), -0.5);
  const auto linear = read_accelerations(folder.file("a.csv", "1,1,2,3\n"));
  EXPECT_EQ(linear.values[0], (Vector6d() << 1, 2, 3, 0, 0, 0).finished());
  const auto both = read_accelerations(folder.file("a.csv", "1,1,2,3,4,5,6\n"));
  EXPECT_EQ(both.values[0], (Vector6d() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(input_error_of(folder, [&] { (void)read_heights(folder.file("h.csv", "t,h\n")); }),
            "h.csv: no data row");
}

// 200 Hz, stamped on arrival: +-1.5 ms.
TEST(SensorLog, ImuStampsAreWithoutTheirJitter) {
  const TemporaryFolder folder;
  constexpr double kInterval_s = 0.005, kBound_s = 1.5e-3;
  std::mt19937 random(2);
  std::uniform_real_distribution<> error_s(-kBound_s, kBound_s);
  std::string rows;
  for (int i = 0; i < 600; ++i) {
    rows +=
        fmt::format("{},0,0,0,0,0,9.8\n", std::llround(1e9 * (i * kInterval_s + error_s(random))));
  }
  const TimeSeries<Vector6d> imu = read_imu(folder.file("imu.csv", rows));
  double squares = 0;
  for (std::size_t i = 1; i < imu.stamps.size(); ++i) {
    const double error = seconds_between(imu.stamps[i - 1], imu.stamps[i]) - kInterval_s;
    squares += error * error;
  }
  const double raw_rms_s = kBound_s * std::sqrt(2.0 / 3);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(imu.stamps.size())), 0.2 * raw_rms_s);
}

TEST(SensorLog, RejectsImuSpikesAndZeroRows) {
  const Vector6d at_rest = (Vector6d() << 0, 0, 0, 0, 0, 9.8).finished();
  TimeSeries<Vector6d> imu;
  for (int i = 0; i < 10; ++i) {
    imu.stamps.push_back(at_s(0.01 * i));
    imu.values.push_back(at_rest);
  }
  imu.values[2][0] = 35;
  imu.values[4].setZero();
  imu.values[6][5] = 160;
  imu.values[9][5] = 160;  // last reading: no second neighbour
  const TimeSeries<Vector6d> valid = reject_imu_outliers(imu);
  EXPECT_EQ(valid.stamps, (std::vector{at_s(0), at_s(0.01), at_s(0.03), at_s(0.05), at_s(0.07),
                                       at_s(0.08), at_s(0.09)}));
  EXPECT_EQ(valid.values[2], at_rest);
}

// A driver that repeats the last reading while the sensor has stopped.
TEST(SensorLog, RejectsReadingsThatRepeat) {
  TimeSeries<Vector6d> imu;
  for (int i = 0; i < 200; ++i) {
    const bool is_stuck = i > 60 && i < 140;
    imu.stamps.push_back(at_s(0.005 * i));
    imu.values.push_back((Vector6d() << 0.01 * (is_stuck ? 60 : i), 0, 0, 0, 0, 9.8).finished());
  }
  const TimeSeries<Vector6d> valid = reject_imu_outliers(imu);
  ASSERT_EQ(valid.stamps.size(), 200u - 79u);
  EXPECT_EQ(valid.stamps[60], at_s(0.3));
  EXPECT_EQ(valid.stamps[61], at_s(0.7));
  // readings repeated a few times, as by a log of a higher rate, are kept
  for (std::size_t i = 0; i < imu.values.size(); ++i) {
    imu.values[i][0] = 0.01 * static_cast<double>(i / 10);
  }
  EXPECT_EQ(reject_imu_outliers(imu).stamps.size(), 200u);
}

TEST(SensorLog, NamesTheUnitOfStampsThatAreNoNanoseconds) {
  const TemporaryFolder folder;
  const auto error_of = [&](const char* name, double scale, double interval_s) {
    std::string rows = std::string(name) + ",h\n";
    for (int i = 0; i < 20; ++i)
      rows += fmt::format("{},1\n", std::llround(scale * i * interval_s));
    const auto file = folder.file("h.csv", rows);
    return input_error_of(folder, [&] { (void)read_heights(file); });
  };
  EXPECT_EQ(error_of("t", 1e6, 0.005),
            "h.csv: the rows are 5e-06 s apart; their time stamps are probably microseconds: "
            "name the first column 'timestamp [us]'");
  EXPECT_NE(error_of("t", 1e3, 0.005).find("probably milliseconds"), std::string::npos);
  EXPECT_EQ(error_of("t", 1e9, 0.005), "accepted");
  EXPECT_EQ(error_of("t", 1e9, 0.0001), "accepted");
  EXPECT_EQ(error_of("t [us]", 1e6, 0.00005), "accepted");
}

TEST(SensorLog, RejectsAngularRateInAccelerationColumn) {
  const TemporaryFolder folder;
  const auto file = folder.file("a.csv", "timestamp [ns],wx,wy,wz,ax,ay,az\n1,0,0,0,0,0,9.8\n");
  EXPECT_EQ(input_error_of(folder, [&] { (void)read_accelerations(file); }),
            "a.csv:1: column 'wx': angular rate x by its name, expected acceleration x; the column "
            "order is time stamp, acceleration x, y, z, angular acceleration x, y, z");
}

TEST(SensorLog, RejectsImplausibleImuReadings) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const std::filesystem::path file = folder.file("imu.csv", text);
    return input_error_of(folder, [&] { (void)read_imu(file); });
  };
  EXPECT_EQ(
      error("1,0,0,0,0,0,9.8\n2,0,1e160,0,0,0,9.8\n"),
      "imu.csv:2: column 3: 1e+160 is out of range, allowed: [-100, 100] rad/s; if the log is "
      "in deg/s, convert it to rad/s (factor 0.01745329)");
  EXPECT_NE(error("1,0,0,0,0,0,1e5\n").find("out of range"), std::string::npos);
  for (const char* name : {"ax", "acc_x", "a_RS_S_x", "linear_acceleration.x"}) {
    EXPECT_NE(error(std::string("timestamp [ns],") + name + ",b,c,d,e,f\n1,0,0,9.8,0,0,0\n")
                  .find("acceleration x by its name, expected angular rate x"),
              std::string::npos)
        << name;
  }
  EXPECT_EQ(error("timestamp [ns],angular_velocity.x,y,z,ax,ay,az\n1,0,0,0,0,0,9.8\n"), "accepted");
}

TEST(SensorLog, RejectsOtherUnitsInColumnNames) {
  const TemporaryFolder folder;
  const auto of_heights = [&](const std::string& names) {
    const auto file = folder.file("h.csv", "#recorded [ft], by boat\n" + names + "\n1,2\n");
    return input_error_of(folder, [&] { (void)read_heights(file); });
  };
  EXPECT_EQ(of_heights("t,height [cm]"),
            "h.csv:2: column 'height [cm]' must be in m; convert it or reorder the columns");
  EXPECT_EQ(
      of_heights("time_us,h"),
      "h.csv:2: column 'time_us': time stamps must be nanoseconds, or have the unit [s], [ms] "
      "or [us] in the name");
  for (const char* name :
       {"h [mm]", "h (ft)", "range_cm", "p [Pa]", "p_hPa", "h [m/s]", "h [KM]"}) {
    EXPECT_NE(of_heights(std::string("t,") + name), "accepted") << name;
  }
  for (const char* name :
       {"h", "h []", "h [m]", "h (metres)", "h_m", "height [agl]", "h_in", "a_g"}) {
    EXPECT_EQ(of_heights(std::string("t,") + name), "accepted") << name;
  }
  const auto of_imu = [&](const std::string& rate, const std::string& force) {
    const auto file = folder.file(
        "imu.csv",
        fmt::format("t (s),x{0},y{0},z{0},x{1},y{1},z{1}\n1,0,0,0,0,0,9.8\n", rate, force));
    return input_error_of(folder, [&] { (void)read_imu(file); });
  };
  for (const char* name : {"", " [rad/s]", " [rad s^-1]", "_rad_s", " [rad s⁻¹]", " [rad/sec]"}) {
    for (const char* other : {"", " [m/s^2]", " [m s^-2]", "_m_s2", " [m/s²]", " (m/s/s)"}) {
      EXPECT_EQ(of_imu(name, other), "accepted") << name << other;
    }
  }
  for (const char* name : {" [deg/s]", "_dps", " [°/s]", " [deg s^-1]", "_deg_s", " [m s^-2]"}) {
    EXPECT_NE(of_imu(name, ""), "accepted") << name;
  }
  for (const char* name : {" [g]", " (mg)", " [cm/s²]"}) {
    EXPECT_NE(of_imu("", name), "accepted") << name;
  }
}

}  // namespace
}  // namespace stillkite
