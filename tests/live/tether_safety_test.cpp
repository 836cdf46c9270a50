#include <gtest/gtest.h>

#include <numbers>

#include "live/operator/operator_command.hpp"
#include "live/tether/command_gate.hpp"
#include "live/tether/watchdog.hpp"

namespace stillkite {
namespace {

constexpr TetherCommand kCommand{.length_rate_m_s = 0.1, .yaw_rate_rad_s = -0.2};
constexpr double kMaxReadingAge_s = 0.2, kMaxDisplacement_m = 0.5;

bool is_zero(const TetherWatchdog::Output& output) {
  return output.command && output.command->length_rate_m_s == 0 &&
         output.command->yaw_rate_rad_s == 0;
}

TetherOrder engaged() {
  return {.is_engaged = true, .is_measured = true, .command = kCommand};
}

TEST(TetherWatchdog, SendsNothingBeforeAnEngagement) {
  TetherWatchdog watchdog(1);
  EXPECT_FALSE(watchdog.output(from_seconds(0)).command);
  watchdog.receive({.is_measured = true, .command = kCommand}, from_seconds(1));
  EXPECT_FALSE(watchdog.output(from_seconds(1)).command);
  watchdog.end(from_seconds(2));
  EXPECT_FALSE(watchdog.output(from_seconds(2)).command);
}

TEST(TetherWatchdog, SilenceSetsAllRatesToZeroUntilTheNextOrder) {
  TetherWatchdog watchdog(10);
  watchdog.receive(engaged(), from_seconds(1));
  EXPECT_EQ(watchdog.output(from_seconds(1.299)).command->length_rate_m_s, 0.1);
  const auto silent = watchdog.output(from_seconds(1.301));
  EXPECT_TRUE(is_zero(silent));
  EXPECT_EQ(silent.reason, HoldReason::estimator_silent);
  EXPECT_TRUE(is_zero(watchdog.output(from_seconds(100))));
  watchdog.receive(engaged(), from_seconds(101));
  EXPECT_EQ(watchdog.output(from_seconds(101)).reason, HoldReason::none);
}

TEST(TetherWatchdog, ImagesThatAreNotMeasuredSetAllRatesToZero) {
  TetherWatchdog watchdog(1);
  watchdog.receive(engaged(), from_seconds(0));
  TetherOrder order = engaged();
  order.is_measured = false;
  for (const double t_s : {0.2, 0.4, 0.6, 0.8, 1.0, 1.2}) {
    watchdog.receive(order, from_seconds(t_s));
    const auto output = watchdog.output(from_seconds(t_s));
    EXPECT_EQ(is_zero(output), t_s > 1);
    EXPECT_EQ(output.reason, t_s > 1 ? HoldReason::not_measured : HoldReason::none);
  }
  TetherWatchdog never(1);
  never.receive(order, from_seconds(0));
  EXPECT_TRUE(is_zero(never.output(from_seconds(0))));
}

TEST(TetherWatchdog, EndOfTheProcessAndReleaseSetZeroRatesForASecond) {
  for (const bool ends : {true, false}) {
    TetherWatchdog watchdog(1);
    watchdog.receive(engaged(), from_seconds(0));
    if (ends) {
      watchdog.end(from_seconds(0.1));
    } else {
      watchdog.receive({}, from_seconds(0.1));
    }
    const auto output = watchdog.output(from_seconds(1.1));
    EXPECT_TRUE(is_zero(output));
    EXPECT_EQ(output.reason, ends ? HoldReason::estimator_ended : HoldReason::not_engaged);
    EXPECT_FALSE(watchdog.output(from_seconds(1.2)).command);
    watchdog.receive(engaged(), from_seconds(2));
    EXPECT_EQ(watchdog.output(from_seconds(2)).command.has_value(), !ends);
  }
}

TEST(TetherWatchdog, StopIsFinal) {
  TetherWatchdog watchdog(1);
  watchdog.receive(engaged(), from_seconds(0));
  watchdog.receive({.is_stopped = true}, from_seconds(0.1));
  EXPECT_TRUE(is_zero(watchdog.output(from_seconds(0.2))));
  watchdog.receive(engaged(), from_seconds(0.3));
  EXPECT_TRUE(is_zero(watchdog.output(from_seconds(0.4))));
  EXPECT_FALSE(watchdog.output(from_seconds(1.2)).command);
}

struct Station {
  int mode = 1, flight_mode = 2;
  std::uint32_t flags = 0;
};

void receive_all(CommandGate& gate, double t_s, const Station& station = {}) {
  const Timestamp now = from_seconds(t_s);
  gate.receive(StationStatus{.mode = station.mode, .relative_length_counts = 1000}, now);
  gate.receive(DroneAttitude{}, now);
  gate.receive(DronePosition{.elevation_from_zenith_rad = 0.5, .azimuth_rad = 0.3}, now);
  gate.receive(DroneStatus{.mode = station.flight_mode, .fault_flags = station.flags}, now);
  gate.set_estimate(now, true, 0.1);
}

bool engage(CommandGate& gate, double t_s) {
  return !gate.apply({.action = OperatorAction::engage, .note = {}, .arrival = from_seconds(t_s)},
                     kMaxDisplacement_m);
}

CommandGate engaged_gate(double t_s) {
  CommandGate gate({}, kMaxReadingAge_s);
  receive_all(gate, t_s);
  EXPECT_TRUE(engage(gate, t_s));
  return gate;
}

TEST(CommandGate, NeedsAnOperator) {
  CommandGate gate({}, kMaxReadingAge_s);
  receive_all(gate, 1);
  EXPECT_EQ(gate.withheld(from_seconds(1)), HoldReason::not_engaged);
  EXPECT_TRUE(engage(gate, 1));
  EXPECT_EQ(gate.withheld(from_seconds(1)), HoldReason::none);
  EXPECT_FALSE(gate.apply({.action = OperatorAction::release, .note = {}, .arrival = {}}, 1));
  EXPECT_EQ(gate.withheld(from_seconds(1)), HoldReason::not_engaged);
}

TEST(CommandGate, StickLandingReturnAndFaultsEndTheEngagement) {
  for (const Station& station : {Station{.mode = 2}, Station{.flight_mode = 3}, Station{.flags = 1},
                                 Station{.flags = 0x1000}}) {
    CommandGate gate = engaged_gate(1);
    receive_all(gate, 1.01, station);
    EXPECT_FALSE(gate.is_engaged());
    const HoldReason reason = gate.withheld(from_seconds(1.02));
    EXPECT_EQ(reason, station.flags != 0 ? HoldReason::station_fault : HoldReason::station_mode);
    EXPECT_FALSE(engage(gate, 1.02));
    receive_all(gate, 1.03);
    EXPECT_EQ(gate.withheld(from_seconds(1.03)), HoldReason::not_engaged);
    EXPECT_TRUE(engage(gate, 1.03));
  }
  // between two images
  CommandGate gate = engaged_gate(1);
  receive_all(gate, 1.01, {.mode = 2});
  receive_all(gate, 1.02);
  EXPECT_EQ(gate.withheld(from_seconds(1.03)), HoldReason::not_engaged);
}

TEST(CommandGate, FlagsThatAreIgnoredDoNotWithhold) {
  CommandGate gate({.ignored_flags = 0x11}, kMaxReadingAge_s);
  receive_all(gate, 1, {.flags = 0x10});
  EXPECT_TRUE(engage(gate, 1));
  receive_all(gate, 1, {.flags = 0x12});
  EXPECT_EQ(gate.withheld(from_seconds(1)), HoldReason::station_fault);
}

TEST(CommandGate, EachSilenceWithholdsWhileItLasts) {
  for (int silent = 0; silent < 4; ++silent) {
    CommandGate gate = engaged_gate(1);
    const double limit_s = silent == 3 ? 2 : kMaxReadingAge_s;
    for (const double age_s : {limit_s, limit_s + 0.01}) {
      const Timestamp now = from_seconds(1 + age_s);
      if (silent != 0) gate.receive(StationStatus{.mode = 1}, now);
      if (silent != 1) gate.receive(DroneAttitude{}, now);
      if (silent != 2) gate.receive(DronePosition{}, now);
      if (silent != 3) gate.receive(DroneStatus{.mode = 2}, now);
      gate.set_estimate(now, true, 0.1);
      EXPECT_EQ(gate.withheld(now), age_s > limit_s ? HoldReason::station_silent : HoldReason::none)
          << silent;
    }
    receive_all(gate, 9);
    EXPECT_EQ(gate.withheld(from_seconds(9)), HoldReason::none);
  }
}

TEST(CommandGate, UnmeasuredImagesWithholdAfterTheConfiguredTime) {
  CommandGate gate = engaged_gate(1);
  for (const double t_s : {1.5, 2.0, 2.1}) {
    receive_all(gate, 1);  // nothing newer than the loss
    gate.receive(StationStatus{.mode = 1}, from_seconds(t_s));
    gate.receive(DroneAttitude{}, from_seconds(t_s));
    gate.receive(DronePosition{}, from_seconds(t_s));
    gate.set_estimate(from_seconds(t_s), false, std::nullopt);
    EXPECT_EQ(gate.withheld(from_seconds(t_s)),
              t_s > 2 ? HoldReason::not_measured : HoldReason::none);
  }
}

TEST(CommandGate, RefusesToEngageFarFromThePoseToHold) {
  CommandGate gate({}, kMaxReadingAge_s);
  receive_all(gate, 1);
  gate.set_estimate(from_seconds(1), true, 0.51);
  EXPECT_FALSE(engage(gate, 1));
  gate.set_estimate(from_seconds(1), true, 0.49);
  EXPECT_TRUE(engage(gate, 1));
}

TEST(CommandGate, StopIsFinal) {
  CommandGate gate = engaged_gate(1);
  EXPECT_FALSE(gate.apply({.action = OperatorAction::stop, .note = {}, .arrival = {}}, 1));
  EXPECT_EQ(gate.withheld(from_seconds(1)), HoldReason::stopped);
  EXPECT_FALSE(engage(gate, 1));
  EXPECT_EQ(gate.withheld(from_seconds(1)), HoldReason::stopped);
}

TEST(CommandGate, TetherReadingIsInTheControllersUnits) {
  CommandGate gate({.length_at_zero_m = 0.5, .reading_latency_s = 0.1}, kMaxReadingAge_s);
  EXPECT_FALSE(gate.tether());
  receive_all(gate, 1);
  gate.receive(DronePosition{.elevation_from_zenith_rad = -0.2, .azimuth_rad = 4}, from_seconds(2));
  const auto reading = gate.tether();
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->stamp, from_seconds(0.9));
  EXPECT_NEAR(reading->tether.length_m, 0.5 + 2.85, 1e-12);
  EXPECT_NEAR(reading->tether.elevation_rad, std::numbers::pi / 2 + 0.2, 1e-12);
  EXPECT_EQ(reading->tether.azimuth_rad, 4);
}

TEST(OperatorCommand, IsRestoredFromItsLine) {
  for (const auto& [action, name] : EnumNames<OperatorAction>::value) {
    const OperatorCommand command{.action = action, .note = "north \"bank\"\n", .arrival = {5}};
    const auto restored = parse_operator_command(operator_line(command), {7});
    ASSERT_TRUE(restored) << name;
    EXPECT_EQ(restored->action, action);
    EXPECT_EQ(restored->note, command.note);
    EXPECT_EQ(restored->arrival.ns, 7);
  }
  for (const char* text : {"", "engage", "[]", "{}", R"({"command": 1})", R"({"command": "fly"})",
                           R"({"command": "mark", "note": 1})", R"({"command": "engage")"}) {
    EXPECT_FALSE(parse_operator_command(text, {0})) << text;
  }
  EXPECT_FALSE(
      parse_operator_command(std::string(2000, ' ').append(R"({"command": "mark"})"), {0}));
}

TEST(OperatorQueue, KeepsStopsWhenItIsFull) {
  OperatorQueue queue;
  for (int i = 0; i < 1000; ++i) queue.push({.action = OperatorAction::engage});
  queue.push({.action = OperatorAction::stop});
  const auto commands = queue.take();
  EXPECT_EQ(commands.size(), 101U);
  EXPECT_EQ(commands.back().action, OperatorAction::stop);
  EXPECT_TRUE(queue.take().empty());
}

}  // namespace
}  // namespace stillkite
