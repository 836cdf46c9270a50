// Real recordings, next to those of STILLKITE_DATA, against other decoders: @foxglove/ulog 2.3.2,
// gopro-telemetry 1.2.11, and the layouts of the DataFlash and MAVLink definitions read by hand.
#include <gtest/gtest.h>

#include <cstdlib>

#include "io/import/recording.hpp"

namespace stillkite {
namespace {

class RealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("STILLKITE_DATA");
    if (data == nullptr || *data == '\0') GTEST_SKIP() << "STILLKITE_DATA is not set";
    folder_ = std::filesystem::path(data) / "../cases";
    if (!std::filesystem::exists(folder_ / "logs")) GTEST_SKIP() << folder_ << " has no logs";
  }

  [[nodiscard]] Recording read(const char* name) const {
    return read_recording({folder_ / name}, {});
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(RealRecordings, Px4Log) {
  const ImportedFlight flight = read("logs/px4_small.ulg").flight;
  EXPECT_EQ(flight.angular_rate_in_body_rad_s.values.size(), 1298U);
  EXPECT_EQ(flight.attitude.values.size(), 1298U);
  EXPECT_EQ(flight.positions.values.size(), 32U);
  EXPECT_EQ(flight.height_m.values.size(), 120U);
  EXPECT_EQ(flight.rejected, 0U);
  EXPECT_EQ(flight.angular_rate_in_body_rad_s.stamps[1].ns, 20'488'019'000);
  const Eigen::Vector3d rate(0.0015724377008, -0.0012462260202, -0.0028984642122);
  EXPECT_LT((flight.angular_rate_in_body_rad_s.values[1] - rate).norm(), 1e-12);
  const Eigen::Vector3d force(0.0119523927569, 0.1863227039576, 9.6310834884644);
  EXPECT_LT((flight.specific_force_in_body_m_s2.values[1] - force).norm(), 1e-12);
  // q = (0.99336, 0.00951, 0.00010, 0.11464): heading 13.18 deg east of north
  const Eigen::Vector3d forward = flight.attitude.values[1] * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(forward.x(), forward.y()), 0.2297673, 1e-6);
  EXPECT_NEAR(flight.positions.values[0].latitude_deg, 63.4170622, 1e-9);
  EXPECT_NEAR(flight.positions.values[0].longitude_deg, 10.4082151, 1e-9);
  EXPECT_NEAR(flight.positions.values[0].altitude_m, 66.814, 1e-9);
  const Eigen::Vector3d velocity(-0.0590000041, 0.0470000021, -0.2420000136);
  EXPECT_LT((flight.velocity_in_world_m_s.values[0] - velocity).norm(), 1e-9);
}

TEST_F(RealRecordings, GoproVideo) {
  const Recording recording = read("logs/gopro_walk.mp4");
  const ImportedFlight& flight = recording.flight;
  EXPECT_EQ(recording.video->width_px, 848);
  EXPECT_EQ(flight.attitude.values.size(), 316U);
  EXPECT_EQ(flight.angular_rate_in_body_rad_s.values.size(), 315U);  // stabilized: a rate per frame
  EXPECT_EQ(flight.positions.values.size(), 191U);
  EXPECT_NEAR(flight.positions.values[0].latitude_deg, 33.12677, 1e-9);
  EXPECT_NEAR(flight.positions.values[0].longitude_deg, -117.3273436, 1e-9);
  EXPECT_NEAR(flight.positions.values[0].altitude_m, -22.959, 1e-9);
  EXPECT_NEAR(flight.positions.values[190].latitude_deg, 33.1266674, 1e-9);
  // 101.994 ms on the camera's clock, the first frame at 85.608 ms
  EXPECT_NEAR(to_seconds(flight.positions.stamps[0]), 0.016, 0.01);
  EXPECT_NEAR(seconds_between(flight.attitude.stamps[0], flight.attitude.stamps[315]), 10.5097,
              1e-3);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& force : flight.specific_force_in_body_m_s2.values)
    mean += force / 315;
  EXPECT_NEAR(mean.norm(), 9.81, 0.2);
  EXPECT_GT(mean.normalized().z(), 0.97);  // upright, 8 deg nose down
}

TEST_F(RealRecordings, ArdupilotLog) {
  const ImportedFlight flight = read("logs/ardupilot_test.bin").flight;
  EXPECT_NEAR(flight.positions.values.at(0).latitude_deg, -35.3626277, 1e-7);  // CMAC, Canberra
  EXPECT_NEAR(flight.positions.values.at(0).longitude_deg, 149.1653034, 1e-7);
  EXPECT_NEAR(flight.positions.values.at(0).altitude_m, 588.82, 1e-9);
  EXPECT_NEAR(flight.specific_force_in_body_m_s2.values.at(0).z(), 9.78099442, 1e-6);
  EXPECT_EQ(flight.rejected, 0U);
}

TEST_F(RealRecordings, TelemetryLog) {
  const ImportedFlight flight = read("logs/ardupilot_vtol.tlog").flight;
  EXPECT_EQ(flight.attitude.values.size(), 886U);
  EXPECT_NEAR(flight.positions.values.at(0).latitude_deg, -35.3629847, 1e-7);
  EXPECT_NEAR(flight.specific_force_in_body_m_s2.values.at(0).z(), 9.79684335, 1e-6);
  // standard atmosphere against the GNSS receiver
  EXPECT_NEAR(flight.height_m.values.at(0), flight.positions.values.at(0).altitude_m, 0.1);
}

TEST_F(RealRecordings, DjiSubtitles) {
  EXPECT_EQ(read("srt/Mini5PRO.SRT").flight.positions.values.at(0).latitude_deg, 10.365108);
  EXPECT_EQ(read("srt/Mini5PRO.SRT").flight.initial_height_m, 6);
  EXPECT_EQ(read("srt/air3.SRT").flight.positions.values.at(1).longitude_deg, 20.2223);
  EXPECT_EQ(read("srt/air3.SRT").flight.positions.stamps.at(1).ns, 33'000'000);
  EXPECT_EQ(read("srt/avata2.SRT").flight.positions.values.at(0).longitude_deg, 20.200305);
  EXPECT_EQ(read("srt/mini4pro.SRT").flight.height_m.values.at(1), 2);
  EXPECT_EQ(read("srt/neo2.SRT").flight.positions.values.at(1).longitude_deg, 20.753859);
}

}  // namespace
}  // namespace stillkite
