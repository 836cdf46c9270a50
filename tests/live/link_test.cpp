#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "geometry/fields.hpp"
#include "live/link/autopilot_link.hpp"
#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"

namespace stillkite {
namespace {

constexpr std::uint16_t kPort = 38'551;

// Packets of a message that arrive at a link within two seconds; all received before it, too.
template <mavlink::Message M>
std::optional<M> wait_for(AutopilotLink& link) {
  for (int i = 0; i < 200; ++i) {
    for (const ReceivedPacket& received : link.take()) {
      if (auto message = mavlink::decode<M>(received.packet)) return message;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return std::nullopt;
}

TEST(AutopilotLink, TwoPeersExchangeMessagesAndAnswerTimesync) {
  AutopilotLink ours({.host = "", .port = kPort}, 1, std::array{47.0, 8.0, 400.0});
  AutopilotLink autopilot({.host = "127.0.0.1", .port = kPort}, 1, std::nullopt);
  autopilot.send(mavlink::Heartbeat{.type = 2, .autopilot = 12});
  autopilot.send(mavlink::Timesync{.tc1 = 0, .ts1 = 4242});
  autopilot.send(mavlink::HighresImu{.time_usec = 99});
  const auto imu = wait_for<mavlink::HighresImu>(ours);
  ASSERT_TRUE(imu);
  EXPECT_EQ(imu->time_usec, 99U);
  const auto reply = wait_for<mavlink::Timesync>(autopilot);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->ts1, 4242);
  EXPECT_GT(reply->tc1, 0);
  const auto origin = wait_for<mavlink::SetGpsGlobalOrigin>(autopilot);
  ASSERT_TRUE(origin);
  EXPECT_EQ(origin->latitude, 470'000'000);
  EXPECT_EQ(origin->altitude, 400'000);
}

TEST(AutopilotLink, SerialPortReceivesWhileNobodyReadsWhatItSends) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(grantpt(terminal), 0);
  ASSERT_EQ(unlockpt(terminal), 0);
  AutopilotLink link({.kind = LinkAddress::Kind::serial, .host = ptsname(terminal), .baud = 57'600},
                     1, std::nullopt);
  for (int i = 0; i < 2000; ++i) link.send(mavlink::HighresImu{.xacc = 1, .zgyro = 1});
  mavlink::Sender sender;
  const mavlink::PacketBytes packet = mavlink::encode(mavlink::RawImu{.time_usec = 7}, sender);
  ASSERT_EQ(write(terminal, packet.bytes().data(), packet.bytes().size()),
            static_cast<ssize_t>(packet.bytes().size()));
  const auto received = wait_for<mavlink::RawImu>(link);
  EXPECT_TRUE(received && received->time_usec == 7);
  close(terminal);
}

TEST(AutopilotLink, OccupiedPortIsAnInputError) {
  const AutopilotLink first({.host = "", .port = kPort + 1}, 1, std::nullopt);
  EXPECT_THROW(AutopilotLink({.host = "", .port = kPort + 1}, 1, std::nullopt), InputError);
  EXPECT_THROW(AutopilotLink({.kind = LinkAddress::Kind::serial, .host = "/dev/none", .baud = 9600},
                             1, std::nullopt),
               InputError);
}

}  // namespace
}  // namespace stillkite
