// Autopilot logs against hand-made files of known content (samples.hpp).
#include <gtest/gtest.h>

#include "io/import/aircraft_axes.hpp"
#include "io/import/dataflash.hpp"
#include "io/import/dataflash_format.hpp"
#include "io/import/mavlink_packet.hpp"
#include "io/import/telemetry_log.hpp"
#include "io/import/ulog.hpp"
#include "io/import/ulog_format.hpp"
#include "tests/io/import/samples.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

void expect_near(const Eigen::Vector3d& actual, const Eigen::Vector3d& expected, double tolerance) {
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), tolerance) << actual.transpose();
}

void expect_sample(const ImportedFlight& flight) {
  ASSERT_EQ(flight.angular_rate_in_body_rad_s.stamps.size(), 10U);
  ASSERT_EQ(flight.specific_force_in_body_m_s2.stamps.size(), 10U);
  ASSERT_EQ(flight.attitude.stamps.size(), 10U);
  ASSERT_EQ(flight.positions.stamps.size(), 10U);
  ASSERT_EQ(flight.velocity_in_world_m_s.stamps.size(), 10U);
  ASSERT_EQ(flight.height_m.stamps.size(), 10U);
  ASSERT_EQ(flight.range_m.stamps.size(), 10U);
  EXPECT_EQ(flight.rejected, 0U);
  for (const auto* stamps : {&flight.angular_rate_in_body_rad_s.stamps, &flight.attitude.stamps,
                             &flight.positions.stamps, &flight.range_m.stamps}) {
    EXPECT_EQ(stamps->front().ns, 1'000'000'000);
    EXPECT_EQ(stamps->back().ns, 1'090'000'000);
  }
  expect_near(flight.angular_rate_in_body_rad_s.values[3], {0.1, -0.2, -0.3}, 1e-6);
  expect_near(flight.specific_force_in_body_m_s2.values[3], {0, 0, 9.80665}, 1e-5);
  const Eigen::Quaterniond& attitude = flight.attitude.values[3];
  expect_near(attitude * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 1e-6);  // north
  expect_near(attitude * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ(), 1e-6);
  EXPECT_NEAR(flight.positions.values[3].latitude_deg, 47, 1e-9);
  EXPECT_NEAR(flight.positions.values[3].longitude_deg, 8, 1e-9);
  EXPECT_NEAR(flight.positions.values[3].altitude_m, 400, 1e-9);
  expect_near(flight.velocity_in_world_m_s.values[3], {2, 1, -3}, 1e-5);
  EXPECT_NEAR(flight.height_m.values[3], 400, 0.1);
  EXPECT_NEAR(flight.range_m.values[3], 5, 1e-9);
}

TEST(Ulog, ReadsEachSensorInBodyAndWorldAxes) {
  const TemporaryFolder folder;
  expect_sample(read_ulog(folder.file("log.ulg", samples::ulog())));
}

TEST(Ulog, ReportsACutOffMessage) {
  const TemporaryFolder folder;
  std::string log = samples::ulog();
  log.resize(log.size() - 3);
  const ImportedFlight flight = read_ulog(folder.file("log.ulg", log));
  EXPECT_EQ(flight.range_m.stamps.size(), 9U);
  ASSERT_EQ(flight.notes.size(), 1U);
  EXPECT_EQ(flight.notes[0].kind, ImportNote::Kind::missing);
}

TEST(UlogFormats, PlacesFieldsAfterNestedTypes) {
  UlogFormats formats;
  EXPECT_TRUE(formats.add("point:float x;double[2] y;"));
  EXPECT_TRUE(formats.add("message:uint8_t a;point[3] points;uint32_t b;"));
  const std::optional<UlogLayout> layout = formats.layout("message");
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->fields.at("b").offset, 1U + 3 * 20);
  EXPECT_FALSE(layout->fields.contains("points"));
}

TEST(UlogFormats, RejectsEndlessNestingAndLargeMessages) {
  UlogFormats formats;
  EXPECT_TRUE(formats.add("a:b inner;"));
  EXPECT_TRUE(formats.add("b:a inner;"));
  EXPECT_FALSE(formats.layout("a"));
  EXPECT_TRUE(formats.add("wide:uint8_t[60000] x;uint8_t[60000] y;"));
  EXPECT_FALSE(formats.layout("wide"));
  EXPECT_FALSE(formats.add("empty:"));
  EXPECT_FALSE(formats.add("none:uint8_t[0] x;"));
}

TEST(Dataflash, ReadsEachSensorInBodyAndWorldAxes) {
  const TemporaryFolder folder;
  expect_sample(read_dataflash(folder.file("log.bin", samples::dataflash())));
}

TEST(Dataflash, ContinuesAfterDamagedBytes) {
  const TemporaryFolder folder;
  std::string log = samples::dataflash();
  log.insert(log.size() - 14, "damaged");
  const ImportedFlight flight = read_dataflash(folder.file("log.bin", log));
  EXPECT_EQ(flight.range_m.stamps.size(), 10U);
  ASSERT_EQ(flight.notes.size(), 1U);
  EXPECT_EQ(flight.notes[0].text, "7 bytes of the log are damaged");
}

// Logs before 2015: TimeMS of GPS counts from the beginning of the GPS week.
TEST(Dataflash, StampsOfOldGnssMessagesAreSinceBoot) {
  const TemporaryFolder folder;
  ByteWriter log;
  log.text("\xa3\x95\x80").little(std::uint8_t{3}).little(std::uint8_t{3 + 1 + 4 + 12 + 4});
  log.text("GPS", 4).text("BILLeI", 16).text("Status,TimeMS,Lat,Lng,Alt,T", 64);
  log.text("\xa3\x95\x03").little(std::uint8_t{3}).little(std::uint32_t{400'000'000});
  log.little(std::int32_t{470'000'000}).little(std::int32_t{80'000'000}).little(std::int32_t{0});
  log.little(std::uint32_t{1500});
  const ImportedFlight flight = read_dataflash(folder.file("log.bin", log.bytes));
  EXPECT_EQ(flight.positions.stamps.at(0).ns, 1'500'000'000);
}

TEST(DataflashLayout, ReadsHalfPrecision) {
  DataflashLayout layout{.name = "X", .bytes = 5, .fields = {{"A", 'g', 3}}};
  const auto value = [&](std::uint16_t bits) {
    const std::string bytes = ByteWriter{}.text("...").little(bits).bytes;
    return layout.number({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "A");
  };
  EXPECT_EQ(value(0x3C00), 1.0);
  EXPECT_EQ(value(0xC100), -2.5);
  EXPECT_EQ(value(0x0001), std::ldexp(1, -24));
}

TEST(TelemetryLog, ReadsEachSensorInBodyAndWorldAxes) {
  const TemporaryFolder folder;
  expect_sample(read_telemetry_log(folder.file("log.tlog", samples::tlog())));
}

TEST(TelemetryLog, RejectsPacketsWithAWrongChecksum) {
  const TemporaryFolder folder;
  std::string log = samples::tlog();
  log[8 + 6 + 8] = 1;  // xacc of the first packet
  const ImportedFlight flight = read_telemetry_log(folder.file("log.tlog", log));
  EXPECT_EQ(flight.angular_rate_in_body_rad_s.stamps.size(), 9U);
}

TEST(TelemetryLog, LeavesOtherComponents) {
  const TemporaryFolder folder;
  const std::string gimbal =
      samples::mavlink(1, 30, 39, ByteWriter{}.little(std::uint32_t{2000}).text("", 24).bytes, 154);
  const ImportedFlight flight = read_telemetry_log(folder.file(
      "log.tlog",
      samples::tlog() + ByteWriter{}.big(std::uint64_t{1'700'000'000'000'000}).text(gimbal).bytes));
  EXPECT_EQ(flight.attitude.stamps.size(), 10U);
}

TEST(TelemetryLog, PrefersTheBetterMessage) {
  const TemporaryFolder folder;
  const std::string quaternion = samples::mavlink(2, 31, 246,
                                                  ByteWriter{}
                                                      .little(std::uint32_t{2000})
                                                      .little(static_cast<float>(M_SQRT1_2))
                                                      .little(0.0f)
                                                      .little(0.0f)
                                                      .little(static_cast<float>(M_SQRT1_2))
                                                      .text("", 12)
                                                      .bytes);
  const ImportedFlight flight = read_telemetry_log(folder.file(
      "log.tlog",
      samples::tlog() +
          ByteWriter{}.big(std::uint64_t{1'700'000'000'000'000}).text(quaternion).bytes));
  ASSERT_EQ(flight.attitude.stamps.size(), 1U);
  // yaw 90 deg: nose to the east
  expect_near(flight.attitude.values[0] * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitX(), 1e-6);
}

TEST(AircraftAxes, NoseUpAndRightWingDown) {
  const Eigen::Quaterniond up = enu_from_flu(0, 0.1, 0);
  expect_near(up * Eigen::Vector3d::UnitX(), {0, std::cos(0.1), std::sin(0.1)}, 1e-12);
  const Eigen::Quaterniond right = enu_from_flu(0.1, 0, 0);
  expect_near(right * Eigen::Vector3d::UnitY(), {-std::cos(0.1), 0, std::sin(0.1)}, 1e-12);
}

}  // namespace
}  // namespace stillkite
