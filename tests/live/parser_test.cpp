#include "live/mavlink/parser.hpp"

#include <gtest/gtest.h>

#include <random>

#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"

namespace stillkite::mavlink {
namespace {

std::vector<std::uint8_t> bytes_of(const PacketBytes& packet) {
  return {packet.bytes().begin(), packet.bytes().end()};
}

std::vector<std::uint8_t> heartbeat_bytes(Sender& sender) {
  return bytes_of(encode(Heartbeat{.type = 2, .autopilot = 12, .mavlink_version = 3}, sender));
}

int packets_in(Parser& parser, std::span<const std::uint8_t> bytes) {
  parser.add(bytes);
  int packets = 0;
  while (parser.next()) ++packets;
  return packets;
}

TEST(MavlinkParser, RestoresAMessageWithTruncatedZeros) {
  Sender sender{.system = 7, .component = 1};
  const PacketBytes packet = encode(
      DistanceSensor{.time_boot_ms = 5, .current_distance = 1234, .orientation = 25}, sender);
  // without the extensions and the covariance, which are zero
  EXPECT_EQ(packet.bytes().size(), 10 + 13 + 2);
  Parser parser;
  parser.add(packet.bytes());
  const std::optional<Packet> read = parser.next();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->system, 7);
  const auto message = decode<DistanceSensor>(*read);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->time_boot_ms, 5U);
  EXPECT_EQ(message->current_distance, 1234);
  EXPECT_EQ(message->orientation, 25);
  EXPECT_EQ(message->signal_quality, 0);
  EXPECT_FALSE(decode<Heartbeat>(*read));
}

TEST(MavlinkParser, SendsAtLeastOneByteOfZeros) {
  Sender sender;
  EXPECT_EQ(encode(Timesync{}, sender).bytes().size(), 10 + 1 + 2);
}

TEST(MavlinkParser, ReadsTheBytesOfAHeartbeat) {
  // PX4, MAVLink 2: quadrotor, system 1, component 1
  const std::vector<std::uint8_t> recorded{0xfd, 9, 0, 0, 0, 1,  1,  0, 0, 0,
                                           0,    0, 0, 0, 2, 12, 81, 3, 3};
  Checksum checksum;
  for (std::size_t i = 1; i < recorded.size(); ++i) checksum.add(recorded[i]);
  checksum.add(std::uint8_t{50});
  std::vector<std::uint8_t> bytes = recorded;
  bytes.push_back(static_cast<std::uint8_t>(checksum.value()));
  bytes.push_back(static_cast<std::uint8_t>(checksum.value() >> 8));
  Parser parser;
  parser.add(bytes);
  const std::optional<Packet> packet = parser.next();
  ASSERT_TRUE(packet);
  EXPECT_EQ(decode<Heartbeat>(*packet)->autopilot, 12);
}

TEST(MavlinkParser, ReadsMavlink1) {
  std::vector<std::uint8_t> bytes{0xfe, 9, 4, 1, 1, 0, 0, 0, 0, 0, 2, 3, 81, 3, 3};
  Checksum checksum;
  for (std::size_t i = 1; i < bytes.size(); ++i) checksum.add(bytes[i]);
  checksum.add(kLayout<Heartbeat>.crc_extra);
  bytes.push_back(static_cast<std::uint8_t>(checksum.value()));
  bytes.push_back(static_cast<std::uint8_t>(checksum.value() >> 8));
  Parser parser;
  EXPECT_EQ(packets_in(parser, bytes), 1);
}

TEST(MavlinkParser, ReadsASignedPacket) {
  Sender sender;
  std::vector<std::uint8_t> bytes = heartbeat_bytes(sender);
  bytes[2] = 1;
  Checksum checksum;
  for (std::size_t i = 1; i + 2 < bytes.size(); ++i) checksum.add(bytes[i]);
  checksum.add(kLayout<Heartbeat>.crc_extra);
  bytes[bytes.size() - 2] = static_cast<std::uint8_t>(checksum.value());
  bytes[bytes.size() - 1] = static_cast<std::uint8_t>(checksum.value() >> 8);
  bytes.resize(bytes.size() + 13, 0xaa);
  const std::vector<std::uint8_t> next = heartbeat_bytes(sender);
  bytes.insert(bytes.end(), next.begin(), next.end());
  Parser parser;
  parser.add(bytes);
  EXPECT_TRUE(parser.next()->is_signed);
  EXPECT_FALSE(parser.next()->is_signed);
  EXPECT_EQ(parser.counts().skipped_bytes, 0);
}

TEST(MavlinkParser, ResumesAfterGarbageAtEveryLength) {
  std::mt19937 random(1);
  Sender sender;
  for (int length = 0; length < 600; ++length) {
    Parser parser;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(length));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    // more than the largest packet that the garbage may seem to begin
    for (int i = 0; i < 60; ++i) {
      const std::vector<std::uint8_t> packet = heartbeat_bytes(sender);
      bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    EXPECT_EQ(packets_in(parser, bytes), 60) << length;
  }
}

TEST(MavlinkParser, RejectsEveryDamagedByte) {
  Sender sender;
  const std::vector<std::uint8_t> packet = heartbeat_bytes(sender);
  for (std::size_t i = 0; i < packet.size(); ++i) {
    std::vector<std::uint8_t> damaged = packet;
    damaged[i] ^= 0x10;
    Parser parser;
    EXPECT_EQ(packets_in(parser, damaged), 0) << i;
  }
}

TEST(MavlinkParser, ReadsByteByByte) {
  Sender sender;
  const std::vector<std::uint8_t> packet = heartbeat_bytes(sender);
  Parser parser;
  int packets = 0;
  for (const std::uint8_t byte : packet) packets += packets_in(parser, std::span(&byte, 1));
  EXPECT_EQ(packets, 1);
}

TEST(MavlinkParser, SkipsUnknownMessagesAndCountsLostOnes) {
  Sender sender;
  std::vector<std::uint8_t> bytes = heartbeat_bytes(sender);
  const std::vector<std::uint8_t> payload(40, 0xfd);
  for (const std::uint8_t byte : bytes_of(pack(30, payload, 39, sender))) bytes.push_back(byte);
  sender.sequence = static_cast<std::uint8_t>(sender.sequence + 3);
  for (const std::uint8_t byte : heartbeat_bytes(sender)) bytes.push_back(byte);
  Parser parser;
  EXPECT_EQ(packets_in(parser, bytes), 2);
  EXPECT_EQ(parser.counts().unknown, 1);
  EXPECT_EQ(parser.counts().lost, 3);
  EXPECT_EQ(parser.counts().skipped_bytes, 0);
}

}  // namespace
}  // namespace stillkite::mavlink
