// Telemetry of GoPro and DJI videos against hand-made samples and closed forms.
#include <gtest/gtest.h>

#include "io/import/dji_subtitles.hpp"
#include "io/import/gopro_orientation.hpp"
#include "io/import/gopro_telemetry.hpp"
#include "io/import/local_frame.hpp"
#include "tests/io/import/samples.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

Bytes bytes_of_text(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

ImportedFlight gopro_flight(int payloads, std::uint32_t fix = 3) {
  GoproTelemetry telemetry;
  const std::string payload = samples::gopro_payload(fix);
  for (int i = 0; i < payloads; ++i) {
    telemetry.add(bytes_of_text(payload), from_seconds(i), from_seconds(i + 1));
  }
  return telemetry.finish();
}

TEST(GoproTelemetry, ReadsImuInBodyAxes) {
  const ImportedFlight flight = gopro_flight(4);
  ASSERT_EQ(flight.angular_rate_in_body_rad_s.stamps.size(), 400U);
  // columns: up, left, backward
  const Eigen::Vector3d rate = flight.angular_rate_in_body_rad_s.values[7];
  EXPECT_NEAR((rate - Eigen::Vector3d(0.1, -0.2, -0.3)).norm(), 0, 1e-12);
  const Eigen::Vector3d force = flight.specific_force_in_body_m_s2.values[7];
  EXPECT_NEAR((force - Eigen::Vector3d(0, 0, 9.81)).norm(), 0, 1e-12);
  EXPECT_NEAR(to_seconds(flight.angular_rate_in_body_rad_s.stamps[250]), 2.5, 1e-9);
  ASSERT_EQ(flight.positions.stamps.size(), 40U);
  EXPECT_NEAR(flight.positions.values[0].latitude_deg, 47, 1e-9);
  EXPECT_NEAR(flight.positions.values[0].altitude_m, 400, 1e-9);
  EXPECT_NEAR(to_seconds(flight.positions.stamps[15]), 1.5, 1e-9);
}

// Columns are -0.3, -0.2 and -0.1 rad/s.
TEST(GoproTelemetry, ReadsAxesOfTheRecordingElseOfTheModel) {
  const auto rate = [](std::string_view model, std::string_view axes) {
    GoproTelemetry telemetry;
    const std::string payload = samples::gopro_payload(3, model, axes);
    telemetry.add(bytes_of_text(payload), from_seconds(0), from_seconds(1));
    return telemetry.finish().angular_rate_in_body_rad_s.values.at(0);
  };
  const auto expect = [](const Eigen::Vector3d& actual, const Eigen::Vector3d& expected) {
    EXPECT_LT((actual - expected).norm(), 1e-12) << actual.transpose();
  };
  expect(rate("Hero6 Black", ""), {0.1, -0.2, -0.3});
  expect(rate("Fusion", ""), {-0.3, -0.2, -0.1});
  expect(rate("GoPro Max", "XzY"), {0.1, -0.3, 0.2});
}

TEST(GoproTelemetry, OmitsPositionsWithoutFix) {
  const ImportedFlight flight = gopro_flight(4, 0);
  EXPECT_TRUE(flight.positions.stamps.empty());
  EXPECT_EQ(flight.notes.back().text, "position: 40 of 40 samples without GNSS fix");
}

TEST(GpmfElement, ReadsStructuresOfSeveralTypes) {
  const std::string element = samples::gpmf(
      "TEST", '?', 8,
      ByteWriter{}.big(std::int32_t{-5}).big(std::uint16_t{7}).big(std::int16_t{-1}).bytes);
  Bytes bytes = bytes_of_text(element);
  const std::optional<GpmfElement> parsed = take_gpmf(bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->numbers(0, "lSs"), (std::vector<double>{-5, 7, -1}));
  EXPECT_TRUE(parsed->numbers(1, "lSs").empty());
  EXPECT_TRUE(bytes.empty());
}

// Sensor at 100 Hz; the number of samples of a payload varies by one.
TEST(GoproStream, FitsAConstantRate) {
  GoproStream stream;
  for (int k = 0; k < 10; ++k) {
    stream.blocks.push_back({.start = from_seconds(k),
                             .end = from_seconds(k + 1),
                             .first = static_cast<std::size_t>(100 * k + (k % 2))});
  }
  stream.samples.resize(1000);
  const std::vector<Timestamp> stamps = sample_stamps(stream, std::nullopt);
  ASSERT_EQ(stamps.size(), 1000U);
  EXPECT_NEAR(seconds_between(stamps[0], stamps[999]), 9.99, 0.01);
  EXPECT_NEAR(seconds_between(stamps[500], stamps[501]), 0.01, 1e-5);
}

// Camera that yaws left at 0.5 rad/s with its nose 0.1 rad down; the image rolls with it by IORI.
GoproOrientation yawing_camera() {
  GoproOrientation out;
  const Eigen::Quaterniond body_from_camera(0.5, -0.5, 0.5, -0.5);
  const Eigen::Quaterniond pitch(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  for (int i = 0; i < 60; ++i) {
    const double t_s = i / 30.0;
    const double angle_rad = 0.5 * std::sin(2 * t_s);
    const Eigen::Quaterniond yaw(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
    const Eigen::Quaterniond start_from_body = pitch.conjugate() * yaw * pitch;
    out.stamps.push_back(from_seconds(t_s));
    out.camera_from_start.push_back(body_from_camera.conjugate() * start_from_body.conjugate() *
                                    body_from_camera);
    out.gravity_in_camera.emplace_back(body_from_camera.conjugate() *
                                       (pitch.conjugate() * -Eigen::Vector3d::UnitZ()));
    out.image_from_camera.emplace_back(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  }
  return out;
}

TEST(GoproOrientation, AttitudeHasVerticalOfGravityAndYawOfCamera) {
  const TimeSeries<Eigen::Quaterniond> attitude = gopro_attitude(yawing_camera(), false);
  const double angle_rad = 0.5 * std::sin(2 * 20 / 30.0);
  const Eigen::Quaterniond expected = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY());
  EXPECT_LT(attitude.values[20].angularDistance(expected), 1e-9);
}

// The image turned clockwise by 0.2 rad relative to the camera is that of a camera rolled left.
TEST(GoproOrientation, AttitudeOfTheImageIncludesItsRoll) {
  const TimeSeries<Eigen::Quaterniond> attitude = gopro_attitude(yawing_camera(), true);
  const Eigen::Quaterniond expected = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX());
  EXPECT_LT(attitude.values[0].angularDistance(expected), 1e-9);
}

TEST(GoproOrientation, FindsTheClockOffsetOfTheImu) {
  const Eigen::Quaterniond pitch(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  TimeSeries<Eigen::Vector3d> rate;
  for (int i = 0; i < 400; ++i) {
    const double t_s = i / 200.0;
    rate.stamps.push_back(from_seconds(t_s + 0.012));  // late
    rate.values.emplace_back(pitch.conjugate() * Eigen::Vector3d(0, 0, std::cos(2 * t_s)));
  }
  const std::optional<double> offset_s = imu_clock_offset_s(yawing_camera(), rate);
  ASSERT_TRUE(offset_s);
  EXPECT_NEAR(*offset_s, -0.012, 0.001);
}

TEST(GoproOrientation, RotatesTheImuWithTheImage) {
  ImportedFlight flight;
  for (int i = 0; i < 400; ++i) {
    flight.specific_force_in_body_m_s2.stamps.push_back(from_seconds(i / 200.0));
    flight.specific_force_in_body_m_s2.values.emplace_back(0, 0, 9.81);
  }
  rotate_imu_with_image(yawing_camera(), flight);
  ASSERT_EQ(flight.angular_rate_in_body_rad_s.stamps.size(), 59U);
  const Eigen::Quaterniond roll(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond pitch(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  const double mean_rad_s = (0.5 * std::sin(2 / 30.0)) * 30;
  EXPECT_LT((flight.angular_rate_in_body_rad_s.values[0] -
             roll * (pitch.conjugate() * Eigen::Vector3d(0, 0, mean_rad_s)))
                .norm(),
            1e-7);
  EXPECT_LT(
      (flight.specific_force_in_body_m_s2.values[0] - roll * Eigen::Vector3d(0, 0, 9.81)).norm(),
      1e-9);
}

ImportedFlight subtitles(const std::string& cue) {
  DjiSubtitles reader;
  reader.add({}, cue);
  return reader.finish();
}

TEST(DjiSubtitles, ReadsBracketedKeys) {
  const TemporaryFolder folder;
  const ImportedFlight flight = read_dji_subtitles(folder.file("a.srt", samples::kSubtitles));
  ASSERT_EQ(flight.positions.stamps.size(), 2U);
  EXPECT_EQ(flight.positions.stamps[1].ns, 33'000'000);
  EXPECT_EQ(flight.positions.values[1].latitude_deg, 47.00001);
  EXPECT_EQ(flight.positions.values[0].altitude_m, 400);
  EXPECT_EQ(flight.takeoff_altitude_m, 395);
  EXPECT_EQ(flight.initial_height_m, 5);
  EXPECT_EQ(flight.mount_down_deg, 90);
  EXPECT_NEAR(*flight.horizontal_fov_deg, 71.6, 0.1);  // 24 mm
  EXPECT_EQ(flight.height_m.values, (std::vector<double>{5, 5.1}));
}

TEST(DjiSubtitles, ReadsGpsTriples) {
  const ImportedFlight avata =
      subtitles("GPS(10.100217,20.200305,69.800) BAROMETER(91.2) HOME(10.100206,20.200400)");
  EXPECT_EQ(avata.positions.values.at(0).latitude_deg, 10.100217);
  EXPECT_EQ(avata.positions.values.at(0).longitude_deg, 20.200305);
  EXPECT_EQ(avata.positions.values.at(0).altitude_m, 69.8);
  EXPECT_EQ(avata.height_m.values.at(0), 91.2);
  EXPECT_FALSE(avata.initial_height_m);
  const ImportedFlight mini = subtitles(
      "F/2.8, SS 206.14, ISO 150, EV 0, GPS (20.2003, 10.1002, 15), D 2.80m, H 98.00m, H.S "
      "0.00m/s");
  EXPECT_EQ(mini.positions.values.at(0).latitude_deg, 10.1002);
  EXPECT_EQ(mini.positions.values.at(0).longitude_deg, 20.2003);
  EXPECT_EQ(mini.initial_height_m, 98);
  const ImportedFlight mavic =
      subtitles("HOME(149.0251,-20.2532) 2017.08.05\nGPS(149.0251,-20.2533,16) BAROMETER:1.9");
  EXPECT_EQ(mavic.positions.values.at(0).latitude_deg, -20.2533);
  EXPECT_EQ(mavic.height_m.values.at(0), 1.9);
}

TEST(DjiSubtitles, KeepsRepeatedPositionsOnceASecond) {
  DjiSubtitles reader;
  for (int i = 0; i < 90; ++i) {
    reader.add(from_seconds(i / 30.0), "[latitude: 47] [longitude: 8] [rel_alt: 5 abs_alt: 400]");
  }
  EXPECT_EQ(reader.finish().positions.stamps.size(), 3U);
}

TEST(DjiSubtitles, RejectsSubtitlesWithoutTelemetry) {
  const TemporaryFolder folder;
  EXPECT_NE(input_error_of(folder,
                           [&] {
                             (void)read_dji_subtitles(
                                 folder.file("a.srt", "1\n00:00:00,000 --> 00:00:02,000\nHello\n"));
                           })
                .find("no position or height in 1 subtitles"),
            std::string::npos);
}

// Lengths of a degree on the WGS 84 ellipsoid at 45 deg north: 111 132 m and 78 847 m.
TEST(LocalFrame, MeasuresDegreesOfTheEllipsoid) {
  const GeodeticPosition origin{.latitude_deg = 45, .longitude_deg = 8, .altitude_m = 100};
  const LocalFrame frame(origin);
  const auto position = [&](double north_deg, double east_deg, double up_m) {
    return frame.position_m(
        {.latitude_deg = 45 + north_deg, .longitude_deg = 8 + east_deg, .altitude_m = 100 + up_m});
  };
  EXPECT_LT(position(0, 0, 0).norm(), 1e-9);
  EXPECT_NEAR((position(0, 0, 7) - Eigen::Vector3d(0, 0, 7)).norm(), 0, 1e-8);
  EXPECT_NEAR(position(0.01, 0, 0).y(), 1111.32 * (1 + 100 / 6.37e6), 0.02);
  EXPECT_NEAR(position(0, 0.01, 0).x(), 788.47 * (1 + 100 / 6.38e6), 0.02);
}

TEST(DjiSubtitles, ReadsDecimalCommas) {
  DjiSubtitles subtitles;
  subtitles.add({}, "[latitude: 47,5] [longitude: -8,25] [rel_alt: -5,4 abs_alt: 400,0]");
  const ImportedFlight flight = subtitles.finish();
  EXPECT_EQ(flight.positions.values.at(0).latitude_deg, 47.5);
  EXPECT_EQ(flight.positions.values.at(0).longitude_deg, -8.25);
  EXPECT_EQ(flight.height_m.values.at(0), -5.4);
  EXPECT_EQ(flight.takeoff_altitude_m, 405.4);
  EXPECT_FALSE(flight.initial_height_m);
}

TEST(DjiSubtitles, RejectsGpsOfOtherThanThreeNumbers) {
  DjiSubtitles subtitles;
  subtitles.add({}, "GPS(8,41,47,37,16) BAROMETER:1.0");
  EXPECT_TRUE(subtitles.finish().positions.values.empty());
}

TEST(DjiSubtitles, ReadsEachLineEnd) {
  const TemporaryFolder folder;
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text = "\xef\xbb\xbf";
    for (const std::string line : {"1", "00:00:00,000 --> 00:00:00,033", "BAROMETER:1.5", "", "2",
                                   "00:00:02,000 --> 00:00:02,033", "BAROMETER:2.5"}) {
      text += line + end;
    }
    const ImportedFlight flight = read_dji_subtitles(folder.file("a.srt", text));
    EXPECT_EQ(flight.height_m.values, (std::vector<double>{1.5, 2.5}));
    EXPECT_EQ(flight.height_m.stamps.at(1).ns, 2'000'000'000);
  }
}

}  // namespace
}  // namespace stillkite
