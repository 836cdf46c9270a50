#include "live/mavlink/layout.hpp"

#include <gtest/gtest.h>

#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"
#include "live/mavlink/vision_messages.hpp"

namespace stillkite::mavlink {
namespace {

// CRC_EXTRA and lengths (without and with extensions) of the MAVLink common definitions.
template <Message M>
void expect_layout(int crc_extra, std::size_t base_length, std::size_t length) {
  EXPECT_EQ(kLayout<M>.crc_extra, crc_extra) << M::kName;
  EXPECT_EQ(kLayout<M>.base_length, base_length) << M::kName;
  EXPECT_EQ(kLayout<M>.length, length) << M::kName;
}

TEST(MavlinkLayout, HasThePublishedChecksumsAndLengths) {
  expect_layout<Heartbeat>(50, 9, 9);
  expect_layout<ScaledImu>(170, 22, 24);
  expect_layout<RawImu>(144, 26, 29);
  expect_layout<AttitudeQuaternion>(246, 32, 48);
  expect_layout<GlobalPositionInt>(104, 28, 28);
  expect_layout<SetGpsGlobalOrigin>(41, 13, 21);
  expect_layout<OpticalFlow>(175, 26, 34);
  expect_layout<VisionPositionEstimate>(158, 32, 117);
  expect_layout<VisionSpeedEstimate>(208, 20, 57);
  expect_layout<HighresImu>(93, 62, 63);
  expect_layout<OpticalFlowRad>(138, 44, 44);
  expect_layout<Timesync>(34, 16, 18);
  expect_layout<ScaledImu2>(76, 22, 24);
  expect_layout<ScaledImu3>(46, 22, 24);
  expect_layout<DistanceSensor>(85, 14, 39);
  expect_layout<Statustext>(83, 51, 54);
  expect_layout<Odometry>(91, 230, 233);
}

std::size_t offset_of(const Layout& layout, std::string_view name) {
  for (const FieldLayout& field : layout.fields) {
    if (field.name == name) return field.offset;
  }
  ADD_FAILURE() << name;
  return 0;
}

TEST(MavlinkLayout, SendsFieldsByDecreasingSizeAndExtensionsLast) {
  EXPECT_EQ(offset_of(kLayout<Heartbeat>, "custom_mode"), 0U);
  EXPECT_EQ(offset_of(kLayout<Heartbeat>, "type"), 4U);
  EXPECT_EQ(offset_of(kLayout<OpticalFlow>, "quality"), 25U);
  EXPECT_EQ(offset_of(kLayout<OpticalFlow>, "flow_rate_x"), 26U);
  EXPECT_EQ(offset_of(kLayout<Odometry>, "frame_id"), 228U);
  EXPECT_EQ(offset_of(kLayout<Odometry>, "quality"), 232U);
  EXPECT_EQ(offset_of(kLayout<DistanceSensor>, "horizontal_fov"), 14U);
}

TEST(MavlinkLayout, ChecksumIsThatOfTheCheckString) {
  Checksum checksum;
  checksum.add("123456789");
  EXPECT_EQ(checksum.value(), 0x6f91);  // CRC-16/MCRF4XX
}

}  // namespace
}  // namespace stillkite::mavlink
