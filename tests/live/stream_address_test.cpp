#include "live/stream/stream_address.hpp"

#include <gtest/gtest.h>

#include "geometry/fields.hpp"
#include "live/link/link_address.hpp"

namespace stillkite {
namespace {

TEST(StreamAddress, HasTheKindOfItsScheme) {
  EXPECT_EQ(parse_stream_address("-").kind, StreamKind::standard_input);
  EXPECT_EQ(parse_stream_address("rtsp://camera/1").kind, StreamKind::rtsp);
  EXPECT_EQ(parse_stream_address("rtp://127.0.0.1:5004").kind, StreamKind::rtp);
  EXPECT_EQ(parse_stream_address("udp://127.0.0.1:5600").kind, StreamKind::udp);
  EXPECT_EQ(parse_stream_address("/flights/camera.sdp").kind, StreamKind::sdp);
  const StreamAddress device = parse_stream_address("v4l2:/dev/video0");
  EXPECT_EQ(device.kind, StreamKind::device);
  EXPECT_EQ(device.url, "/dev/video0");
}

TEST(StreamAddress, NameHasNoCredentials) {
  EXPECT_EQ(parse_stream_address("rtsp://user:pa@ss@camera:554/1").name, "rtsp://camera:554/1");
  EXPECT_EQ(parse_stream_address("rtsp://camera/a@b").name, "rtsp://camera/a@b");
  EXPECT_EQ(parse_stream_address("rtsp://camera/1?password=x").name, "rtsp://camera/1");
}

TEST(StreamAddress, RecordKeepsVariablesButNoPassword) {
  EXPECT_EQ(without_password("rtsp://user:secret@camera/1"), "rtsp://camera/1");
  EXPECT_EQ(without_password("rtsp://user:${PASSWORD}@camera/1"),
            "rtsp://user:${PASSWORD}@camera/1");
  EXPECT_EQ(without_password("-"), "-");
  EXPECT_EQ(without_password("v4l2:/dev/video0"), "v4l2:/dev/video0");
}

TEST(StreamAddress, RejectsFilesAndEmptyHosts) {
  for (const char* path :
       {"", "flight.mp4", "http://camera", "rtsp://", "udp://127.0.0.1", "rtp://host:/"}) {
    EXPECT_THROW(static_cast<void>(parse_stream_address(path)), InputError) << path;
  }
}

TEST(LinkAddress, ParsesPeersPortsAndDevices) {
  const LinkAddress peer = parse_link_address("udp://10.0.0.2:14550", "live.mavlink");
  EXPECT_EQ(peer.host, "10.0.0.2");
  EXPECT_EQ(peer.port, 14550);
  EXPECT_EQ(parse_link_address("udp://:14550", "live.mavlink").host, "");
  const LinkAddress serial = parse_link_address("serial:/dev/ttyACM0:921600", "live.mavlink");
  EXPECT_EQ(serial.host, "/dev/ttyACM0");
  EXPECT_EQ(serial.baud, 921600U);
}

TEST(LinkAddress, RejectsOtherTexts) {
  for (const char* text : {"", "udp://", "udp://host", "udp://host:0", "udp://host:70000",
                           "udp://host:1x", "serial:/dev/ttyACM0", "tcp://host:1"}) {
    EXPECT_THROW(static_cast<void>(parse_link_address(text, "live.mavlink")), InputError) << text;
  }
}

}  // namespace
}  // namespace stillkite
