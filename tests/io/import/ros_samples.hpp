#pragma once

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/io/import/byte_writer.hpp"

// ROS recordings: ten readings of an IMU at 100 Hz from 1 s, two 16 x 16 px images of grey 0 to
// 127, a GNSS fix at 47 deg north, 8 deg east, a CameraInfo.

namespace stillkite::samples {

/// Serializes fields as ROS 2 (CDR, aligned) or ROS 1.
class RosWriter {
 public:
  explicit RosWriter(bool is_cdr) : is_cdr_(is_cdr) {
    if (is_cdr_) out_.text(std::string_view("\0\1\0\0", 4));
  }
  template <typename T>
  RosWriter& number(T value) {
    while (is_cdr_ && (out_.bytes.size() - 4) % sizeof(T) != 0) out_.text("", 1);
    out_.little(value);
    return *this;
  }
  RosWriter& numbers(const std::vector<double>& values) {
    for (const double value : values) number(value);
    return *this;
  }
  RosWriter& text(std::string_view value) {  // CDR ends it with a zero
    number(static_cast<std::uint32_t>(value.size() + (is_cdr_ ? 1 : 0)));
    out_.text(value, value.size() + (is_cdr_ ? 1 : 0));
    return *this;
  }
  RosWriter& data(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    out_.text(value);
    return *this;
  }
  RosWriter& header(int reading) {
    if (!is_cdr_) number(std::uint32_t{0});
    number(std::int32_t{1}).number(static_cast<std::uint32_t>(reading * 10'000'000));
    return text("imu");
  }
  [[nodiscard]] const std::string& bytes() const { return out_.bytes; }

 private:
  bool is_cdr_;
  ByteWriter out_;
};

struct RosSample {
  std::string topic, type, bytes;
};

[[nodiscard]] inline std::vector<RosSample> ros_messages(bool is_cdr) {
  std::vector<RosSample> out;
  const std::vector<double> covariance(9);
  for (int i = 0; i < 10; ++i) {
    out.push_back({"/imu", "Imu",
                   RosWriter(is_cdr)
                       .header(i)
                       .numbers({0, 0, 0.6, 0.8})
                       .numbers(covariance)
                       .numbers({0.1, 0.2, 0.3})
                       .numbers(covariance)
                       .numbers({0, 0, 9.81})
                       .numbers(covariance)
                       .bytes()});
    out.push_back({"/other_imu", "Imu", "damaged"});
  }
  for (int image = 0; image < 2; ++image) {
    const bool is_colour = image == 1;
    std::string pixels;
    for (int i = 0; i < 256; ++i) pixels.append(is_colour ? 3 : 1, static_cast<char>(i / 2));
    out.push_back({"/image", "Image",
                   RosWriter(is_cdr)
                       .header(image)
                       .number(std::uint32_t{16})
                       .number(std::uint32_t{16})
                       .text(is_colour ? "rgb8" : "mono8")
                       .number(std::uint8_t{0})
                       .number(std::uint32_t{is_colour ? 48U : 16U})
                       .data(pixels)
                       .bytes()});
  }
  out.push_back({"/fix", "NavSatFix",
                 RosWriter(is_cdr)
                     .header(0)
                     .number(std::int8_t{0})
                     .number(std::uint16_t{1})
                     .numbers({47, 8, 400})
                     .numbers(covariance)
                     .number(std::uint8_t{0})
                     .bytes()});
  out.push_back({"/camera_info", "CameraInfo",
                 RosWriter(is_cdr)
                     .header(0)
                     .number(std::uint32_t{16})
                     .number(std::uint32_t{16})
                     .text("plumb_bob")
                     .number(std::uint32_t{5})
                     .numbers({-0.1, 0.01, 0, 0, 0})
                     .numbers({5, 0, 1.5, 0, 6, 0.5, 0, 0, 1})
                     .bytes()});
  return out;
}

[[nodiscard]] inline std::string compressed(std::string_view compression,
                                            const std::string& bytes) {
  std::string out(2 * bytes.size() + 1000, '\0');
  if (compression == "zstd") {
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  } else if (compression == "lz4") {
    out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  } else if (compression == "bz2") {
    auto size = static_cast<unsigned>(out.size());
    std::string input = bytes;
    BZ2_bzBuffToBuffCompress(out.data(), &size, input.data(), static_cast<unsigned>(input.size()),
                             9, 0, 0);
    out.resize(size);
  } else {
    return bytes;
  }
  return out;
}

/// MCAP with one chunk; each message is recorded 5 s after its clock's zero.
[[nodiscard]] inline std::string mcap(const std::vector<RosSample>& messages, bool is_cdr,
                                      std::string_view compression) {
  constexpr std::uint64_t kLogged_ns = 5'000'000'000;
  const auto text = [](std::string_view value) {
    return ByteWriter{}.little(static_cast<std::uint32_t>(value.size())).text(value).bytes;
  };
  const auto record = [](std::uint8_t opcode, const std::string& bytes) {
    return ByteWriter{}.little(opcode).little(std::uint64_t{bytes.size()}).text(bytes).bytes;
  };
  std::string records;
  std::vector<std::string> topics;
  for (const RosSample& message : messages) {
    auto id = static_cast<std::uint16_t>(std::ranges::find(topics, message.topic) - topics.begin());
    if (id == topics.size()) {
      topics.push_back(message.topic);
      records +=
          record(3, ByteWriter{}
                        .little(static_cast<std::uint16_t>(id + 1))
                        .text(text((is_cdr ? "sensor_msgs/msg/" : "sensor_msgs/") + message.type))
                        .text(text(""))
                        .text(text(""))
                        .bytes);
      records += record(4, ByteWriter{}
                               .little(id)
                               .little(static_cast<std::uint16_t>(id + 1))
                               .text(text(message.topic))
                               .text(text(is_cdr ? "cdr" : "ros1"))
                               .text(text(""))
                               .bytes);
    }
    records += record(5, ByteWriter{}
                             .little(id)
                             .little(std::uint32_t{0})
                             .little(kLogged_ns)
                             .little(std::uint64_t{0})
                             .text(message.bytes)
                             .bytes);
  }
  const std::string stored = compressed(compression, records);
  const std::string chunk = ByteWriter{}
                                .little(std::uint64_t{0})
                                .little(std::uint64_t{0})
                                .little(std::uint64_t{records.size()})
                                .little(std::uint32_t{0})
                                .text(text(compression))
                                .little(std::uint64_t{stored.size()})
                                .text(stored)
                                .bytes;
  const std::string magic("\x89MCAP0\r\n", 8);
  return magic + record(1, text("ros2") + text("")) + record(6, chunk) +
         record(0x0F, std::string(4, '\0')) + magic;
}

[[nodiscard]] inline std::string mcap(bool is_cdr, std::string_view compression) {
  return mcap(ros_messages(is_cdr), is_cdr, compression);
}

/// ROS 1 bag with one chunk.
[[nodiscard]] inline std::string rosbag(std::string_view compression) {
  const auto field = [](std::string_view name, const std::string& value) {
    return ByteWriter{}
        .little(static_cast<std::uint32_t>(name.size() + 1 + value.size()))
        .text(name)
        .text("=")
        .text(value)
        .bytes;
  };
  const auto number = [](std::uint32_t value) { return ByteWriter{}.little(value).bytes; };
  const auto record = [](const std::string& header, const std::string& data) {
    return ByteWriter{}
        .little(static_cast<std::uint32_t>(header.size()))
        .text(header)
        .little(static_cast<std::uint32_t>(data.size()))
        .text(data)
        .bytes;
  };
  std::string records;
  std::vector<std::string> topics;
  for (const RosSample& message : ros_messages(false)) {
    const auto id =
        static_cast<std::uint32_t>(std::ranges::find(topics, message.topic) - topics.begin());
    if (id == topics.size()) {
      topics.push_back(message.topic);
      records +=
          record(field("op", "\x07") + field("conn", number(id)) + field("topic", message.topic),
                 field("type", "sensor_msgs/" + message.type));
    }
    records += record(
        field("op", "\x02") + field("conn", number(id)) + field("time", number(1) + number(0)),
        message.bytes);
  }
  const std::string chunk =
      record(field("op", "\x05") + field("compression", std::string(compression)) +
                 field("size", number(static_cast<std::uint32_t>(records.size()))),
             compressed(compression, records));
  return "#ROSBAG V2.0\n" + record(field("op", "\x03"), std::string(100, ' ')) + chunk;
}

}  // namespace stillkite::samples
