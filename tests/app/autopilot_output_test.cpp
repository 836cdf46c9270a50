#include "app/autopilot_output.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <thread>

#include "live/mavlink/system_messages.hpp"
#include "live/mavlink/vision_messages.hpp"

namespace stillkite {
namespace {

constexpr std::uint16_t kPort = 38'561;

NavigationEstimate estimate_at(double t_s, ScaleSource scale) {
  NavigationEstimate estimate;
  estimate.stamp = from_seconds(t_s);
  estimate.verdict = Verdict::ok;
  estimate.scale = scale;
  estimate.world_from_body.translation.z() = 5;
  return estimate;
}

// Number of messages by id that arrive within half a second.
std::map<std::uint32_t, int> received_by(AutopilotLink& autopilot) {
  std::map<std::uint32_t, int> counts;
  for (int i = 0; i < 50; ++i) {
    for (const ReceivedPacket& received : autopilot.take()) ++counts[received.packet.id];
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return counts;
}

TEST(AutopilotOutput, SendsTheConfiguredMessagesOnceThereIsAScale) {
  AutopilotLink autopilot({.host = "", .port = kPort}, 1, std::nullopt);
  AutopilotLink ours({.host = "127.0.0.1", .port = kPort}, 1, std::nullopt);
  AutopilotOutput output(ours, {.odometry = true, .optical_flow_rad = true}, 0.5);
  output.send(estimate_at(0.00, ScaleSource::none), {}, 300);
  output.send(estimate_at(0.04, ScaleSource::range), {}, 300);
  output.send(estimate_at(0.08, ScaleSource::range), {}, 300);
  NavigationEstimate lost = estimate_at(0.12, ScaleSource::range);
  lost.verdict = Verdict::lost;
  output.send(lost, {}, 300);
  output.report_missing_images(0.9);
  output.report_missing_images(1.1);
  std::map<std::uint32_t, int> counts = received_by(autopilot);
  EXPECT_EQ(counts[mavlink::Statustext::kId], 1);
  EXPECT_EQ(counts[mavlink::Odometry::kId], 2);
  EXPECT_EQ(counts[mavlink::OpticalFlowRad::kId], 2);
  EXPECT_EQ(counts[mavlink::OpticalFlow::kId], 0);
  EXPECT_EQ(counts[mavlink::VisionPositionEstimate::kId], 0);
}

}  // namespace
}  // namespace stillkite
