#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

enum class RtspTransport { tcp, udp };
template <>
struct EnumNames<RtspTransport> {
  static constexpr auto value = std::to_array<std::pair<RtspTransport, std::string_view>>(
      {{RtspTransport::tcp, "tcp"}, {RtspTransport::udp, "udp"}});
};

/// Live video source.
struct StreamConfig {
  std::string path;
  RtspTransport transport = RtspTransport::tcp;
  double latency_s = 0;
  double timeout_s = 2;

  static void fields(auto& self, auto&& field) {
    field("path", self.path,
          "rtsp://, rtp://, udp:// (MPEG-TS), an SDP file, v4l2:/dev/videoN, or - (standard input: "
          "MPEG-TS, MJPEG, H.264)");
    field("transport", self.transport, "of rtsp://");
    field(
        "latency_s", self.latency_s, Range{0, 10},
        "constant delay from exposure to arrival, subtracted from the arrival on the local clock");
    field("timeout_s", self.timeout_s, Range{0.1, 60},
          "silence after which the source is opened again; not for standard input");
  }
};

}  // namespace stillkite
