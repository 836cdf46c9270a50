#include "live/sensors/sensor_link.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string_view>
#include <thread>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// below the ephemeral ports, one per test: tests run at the same time
constexpr std::uint16_t kLinesPort = 28'553;
constexpr std::uint16_t kOverlongPort = 28'554;

void send_text(Port& port, std::string_view text) {
  port.send({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// Lines and rejected lines of a link once they are as many as expected, within two seconds.
std::vector<ReceivedSensorLine> wait_for_lines(SensorLink& link, std::int64_t lines,
                                               std::int64_t rejected) {
  for (int i = 0; i < 200; ++i) {
    const SensorLinkCounts counts = link.counts();
    if (counts.lines >= lines && counts.rejected >= rejected) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return link.take();
}

TEST(SensorLink, DatagramsHoldWholeLines) {
  SensorLink link("udp://:" + std::to_string(kLinesPort));
  Port sender(
      {.host = "127.0.0.1", .port = kLinesPort}, "test", [](auto, auto) {}, [] {});
  sender.start();
  // two lines in one datagram, the second without its end; a line that is cut off
  const auto line = [](int range_m) {
    return R"({"schema":1,"range":)" + std::to_string(range_m) + "}";
  };
  send_text(sender, line(1) + "\n" + line(2));
  send_text(sender, R"({"schema":1,"ran)");
  send_text(sender, line(3) + "\r\n");
  const std::vector<ReceivedSensorLine> lines = wait_for_lines(link, 3, 1);
  ASSERT_EQ(lines.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lines[i].line.range_m, static_cast<double>(i + 1));
    EXPECT_EQ(parse_sensor_line(lines[i].text).line->range_m, lines[i].line.range_m);
    EXPECT_GT(lines[i].arrival.ns, 0);
  }
  const SensorLinkCounts counts = link.counts();
  EXPECT_EQ(counts.lines, 3);
  EXPECT_EQ(counts.rejected, 1);
  EXPECT_EQ(counts.first_problem, "no JSON object");
  EXPECT_TRUE(link.take().empty());
}

TEST(SensorLink, CountsOverlongLines) {
  SensorLink link("udp://:" + std::to_string(kOverlongPort));
  Port sender(
      {.host = "127.0.0.1", .port = kOverlongPort}, "test", [](auto, auto) {}, [] {});
  sender.start();
  send_text(sender, std::string(3000, ' '));
  send_text(sender, R"({"schema":1,"range":1})");
  EXPECT_EQ(wait_for_lines(link, 1, 1).size(), 1U);
  EXPECT_EQ(link.counts().rejected, 1);
  EXPECT_EQ(link.counts().first_problem, "more than 2048 bytes");
}

TEST(SensorLink, AddressIsAPortOfThisMachine) {
  for (const char* address : {"udp://10.0.0.1:5000", "udp://:0", "tcp://:5000", "-", ""}) {
    try {
      const SensorLink link(address);
      ADD_FAILURE() << address;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string_view(error.what()).find("live.telemetry.json: "), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace stillkite
