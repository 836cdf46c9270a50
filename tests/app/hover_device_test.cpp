#include "app/hover_device.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>

#include "io/config/config_binding.hpp"
#include "io/config/config_node.hpp"
#include "io/config/config_printing.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

class DeviceTest : public testing::Test {
 protected:
  // Program at the other end of the pseudo-terminal.
  void connect() { other_ = open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK); }
  void TearDown() override {
    if (other_ >= 0) close(other_);
  }
  void write(const std::string& text) const {
    EXPECT_EQ(::write(other_, text.data(), text.size()), std::ssize(text));
  }
  [[nodiscard]] std::vector<StationMessage> received() const {
    std::string text(4096, '\0');
    const ssize_t size = ::read(other_, text.data(), text.size());
    LineSplitter splitter;
    splitter.add(std::span(text).first(static_cast<std::size_t>(std::max<ssize_t>(size, 0))));
    std::vector<StationMessage> out;
    while (const auto line = splitter.next()) out.push_back(parse_station_line(*line).value());
    return out;
  }

  const fs::path link = fs::temp_directory_path() / ("station_" + std::to_string(getpid()));
  int other_ = -1;
};

TEST_F(DeviceTest, ClockHasOffsetAndSkew) {
  const ServeConfig config{.clock_offset_s = 100, .clock_skew_ppm = 50};
  EXPECT_EQ(device_stamp(config, from_seconds(0)), from_seconds(100));
  EXPECT_EQ(device_stamp(config, from_seconds(1000)), from_seconds(1100.05));
}

TEST_F(DeviceTest, StationExecutesCommandsBeyondTheDeadZoneUntilTheCableIsCut) {
  DeviceStation station({.serve = {.mavlink_port = 38'651}}, link, Eigen::Quaterniond::Identity());
  connect();
  EXPECT_FALSE(station.has_received());
  write("noise\nPos2 -0.1,0.05,100\nYaw 0.2\n");
  const TetherCommand command = station.command(from_seconds(1));
  EXPECT_TRUE(station.has_received());
  EXPECT_NEAR(command.length_rate_m_s, 0.285, 1e-12);
  EXPECT_EQ(command.elevation_rate_rad_s, 0.1);
  EXPECT_EQ(command.azimuth_rate_rad_s, 0.05);
  EXPECT_EQ(command.yaw_rate_rad_s, 0.2);
  write("Pos2 -0.1,0.05,4.9\n");
  EXPECT_EQ(station.command(from_seconds(1.1)).length_rate_m_s, 0);
  write("Pos2 -0.1,0.05,-5\n");
  EXPECT_LT(station.command(from_seconds(1.2)).length_rate_m_s, 0);
  EXPECT_EQ(station.command(from_seconds(1.7)).elevation_rate_rad_s, 0.1);
  EXPECT_EQ(station.command(from_seconds(1.71)).elevation_rate_rad_s, 0);
}

TEST_F(DeviceTest, StationSendsReadingsOnceTheyAreDue) {
  const Eigen::Quaterniond station_from_world(0.8, 0, 0, 0.6);
  DeviceStation station({.serve = {.mavlink_port = 38'653}}, link, station_from_world);
  connect();
  const HoverReadings readings{
      .tether = {{.stamp = from_seconds(1),
                  .available = from_seconds(1.005),
                  .tether = {.length_m = 2.285, .elevation_rad = 1, .azimuth_rad = 0.25}}},
      .attitude = {{.stamp = from_seconds(1),
                    .world_from_body = {0.6, 0, 0.8, 0},
                    .angular_rate_in_body_rad_s = Eigen::Vector3d::Zero(),
                    .specific_force_in_body_m_s2 = Eigen::Vector3d::Zero()}}};
  station.send(readings, from_seconds(1));
  EXPECT_TRUE(received().empty());
  station.send({}, from_seconds(1.005));
  const std::vector<StationMessage> messages = received();
  ASSERT_EQ(messages.size(), 4U);
  const auto position = std::get<DronePosition>(messages[1]);
  EXPECT_NEAR(position.elevation_from_zenith_rad, std::numbers::pi / 2 - 1, 1e-5);
  EXPECT_NEAR(position.azimuth_rad, 0.25, 1e-5);
  EXPECT_LT(
      std::get<DroneAttitude>(messages[0])
          .world_from_body.angularDistance(station_from_world * Eigen::Quaterniond(0.6, 0, 0.8, 0)),
      1e-5);
  EXPECT_NEAR(std::get<StationStatus>(messages[2]).relative_length_counts, 100, 1e-2);
}

// The flight's configuration is read as it is written.
TEST_F(DeviceTest, FlightHasTheTrialsCameraAndWires) {
  const HoverConfig config;
  const std::string text = print_config(device_flight(config, "drone/station", 3.1));
  const FlyConfig flight = bind_config<FlyConfig>(parse_yaml(text, "flight.yaml", {}));
  EXPECT_EQ(flight.initial.height_m, 3.1);
  EXPECT_EQ(flight.mount.down_deg, 15);
  EXPECT_EQ(flight.calibration.camera->width_px, 800);
  EXPECT_EQ(flight.source.latency_s, config.plant.camera_latency_s);
  EXPECT_TRUE(flight.live.tether.port->ends_with("drone/station:115200"));
  EXPECT_EQ(print_config(flight), text);
}

}  // namespace
}  // namespace stillkite
