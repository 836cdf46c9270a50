#include "live/tether/tether_link.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "geometry/fields.hpp"
#include "live/clock/local_clock.hpp"
#include "live/link/line_splitter.hpp"
#include "live/link/pseudo_terminal.hpp"
#include "live/tether/command_lines.hpp"
#include "live/tether/station_lines.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

constexpr double kPeriod_s = 0.05;  // of the supervising process
constexpr double kSlack_s = 0.25;   // of a busy machine
const std::string kZero = "Pos2 0.0000,0.0000,0.00";

/// Ground station's end of a pseudo-terminal.
class Terminal {
 public:
  [[nodiscard]] TetherConfig config() const {
    TetherConfig config;
    config.port = "serial:" + link_.string() + ":115200";
    return config;
  }

  void write(const std::string& text) { device_.write(text); }

  // Next line; nullopt after `wait_s` without one.
  std::optional<ReceivedLine> next(double wait_s) {
    const Timestamp start = local_now();
    do {
      if (auto line = splitter_.next()) return ReceivedLine{std::move(*line), local_now()};
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      splitter_.add(device_.read());
    } while (seconds_between(start, local_now()) < wait_s);
    return std::nullopt;
  }

  // Time of the first line with zero rates of position after `since`; lines before are other ones.
  std::optional<double> zero_after_s(Timestamp since) {
    while (const auto line = next(2)) {
      if (line->line == kZero) return seconds_between(since, line->arrival);
    }
    return std::nullopt;
  }

 private:
  fs::path link_ = fs::temp_directory_path() / ("tether_" + std::to_string(getpid()));
  PseudoTerminal device_{link_};
  LineSplitter splitter_;
};

constexpr TetherOrder kEngaged{.is_engaged = true,
                               .is_measured = true,
                               .command = {.length_rate_m_s = 0.285, .yaw_rate_rad_s = 0.1}};

TEST(TetherLink, SendsOnlyOnceEngagedAndReceivesLines) {
  Terminal terminal;
  TetherLink link(terminal.config());
  link.send({.is_measured = true, .command = kEngaged.command});
  EXPECT_FALSE(terminal.next(0.2));
  link.send(kEngaged);
  EXPECT_EQ(terminal.next(1).value().line, "Pos2 0.0000,0.0000,100.00");
  EXPECT_EQ(terminal.next(1).value().line, "Yaw 0.1000");
  const Timestamp before = local_now();
  terminal.write("!Pos 0.1,0.2,0.3\r\n");
  std::vector<ReceivedLine> lines;
  while (lines.empty() && seconds_between(before, local_now()) < 2) {
    lines = link.take();
    link.send(kEngaged);
  }
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].line, "!Pos 0.1,0.2,0.3");
  EXPECT_GE(lines[0].arrival, before);
  link.send({});
  EXPECT_LT(terminal.zero_after_s(local_now()).value(), kPeriod_s + kSlack_s);
}

TEST(TetherLink, GarbageOnTheLineIsNoLineAndStopsNothing) {
  Terminal terminal;
  TetherLink link(terminal.config());
  std::mt19937 random(1);
  int valid = 0;
  for (int i = 0; i < 200; ++i) {
    std::string garbage(97, '\0');
    for (char& byte : garbage) byte = static_cast<char>(random());
    terminal.write(garbage);
    if (i % 10 == 9) terminal.write("\n!Pos 1,2,3\n");
    for (const ReceivedLine& line : link.take()) valid += parse_station_line(line.line) ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (int i = 0; i < 100 && valid < 20; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    for (const ReceivedLine& line : link.take()) valid += parse_station_line(line.line) ? 1 : 0;
  }
  EXPECT_EQ(valid, 20);
  link.send(kEngaged);
  EXPECT_EQ(terminal.next(1).value().line, "Pos2 0.0000,0.0000,100.00");
}

TEST(TetherLink, SilenceOfTheEstimatorSetsZeroRates) {
  const fs::path log =
      fs::temp_directory_path() / ("stillkite_commands_" + std::to_string(getpid()));
  std::ofstream(log) << "#header\n";
  Terminal terminal;
  {
    TetherLink link(terminal.config());
    link.log_to(log.string(), "0,0");
    const Timestamp last = local_now();
    link.send(kEngaged);
    const double zero_s = terminal.zero_after_s(last).value();
    EXPECT_GE(zero_s, TetherWatchdog::kSilence_s);
    EXPECT_LT(zero_s, TetherWatchdog::kSilence_s + kPeriod_s + kSlack_s);
    // the next order is followed again
    link.send(kEngaged);
    std::string line;
    while (line != "Pos2 0.0000,0.0000,100.00") line = terminal.next(1).value().line;
  }
  std::ifstream stream(log);
  std::string row;
  std::getline(stream, row);
  std::getline(stream, row);
  EXPECT_TRUE(row.ends_with(",hold,estimator_silent,0,0")) << row;
  fs::remove(log);
}

// The estimator's process is killed while it commands at 30 Hz.
TEST(TetherLink, KilledEstimatorSetsZeroRatesWithinAPeriod) {
  Terminal terminal;
  const TetherConfig config = terminal.config();
  const pid_t estimator = fork();
  if (estimator == 0) {
    TetherLink link(config);
    while (true) {
      link.send(kEngaged);
      std::this_thread::sleep_for(std::chrono::milliseconds(33));
    }
  }
  for (int i = 0; i < 20; ++i) {
    const std::string line = terminal.next(2).value().line;
    EXPECT_TRUE(line == "Pos2 0.0000,0.0000,100.00" || line == "Yaw 0.1000") << line;
  }
  const Timestamp killed = local_now();
  kill(estimator, SIGKILL);
  EXPECT_LT(terminal.zero_after_s(killed).value(), kPeriod_s + kSlack_s);
  // zero rates for a second, then nothing
  int zeros = 1;
  Timestamp last = local_now();
  while (const auto line = terminal.next(0.5)) {
    EXPECT_TRUE(line->line == kZero || line->line == "Yaw 0.0000") << line->line;
    zeros += line->line == kZero ? 1 : 0;
    last = line->arrival;
  }
  EXPECT_GT(zeros, 5);
  EXPECT_NEAR(seconds_between(killed, last), TetherWatchdog::kRepeat_s, kSlack_s);
  waitpid(estimator, nullptr, 0);
}

TEST(TetherLink, KilledSupervisorIsReplacedByZeroRates) {
  Terminal terminal;
  TetherLink link(terminal.config());
  link.send(kEngaged);
  EXPECT_TRUE(terminal.next(1));
  kill(link.supervisor(), SIGKILL);
  const Timestamp killed = local_now();
  bool is_zero = false;
  while (!is_zero && seconds_between(killed, local_now()) < 1) {
    static_cast<void>(link.take());
    const auto line = terminal.next(0.02);
    is_zero = line && line->line == kZero;
  }
  EXPECT_TRUE(is_zero);
  EXPECT_FALSE(link.is_supervised());
}

// Nobody reads the other end; the supervising process must not wait for it.
TEST(TetherLink, EndsWhileTheStationDoesNotRead) {
  Terminal terminal;
  Timestamp start;
  {
    TetherLink link(terminal.config());
    for (int i = 0; i < 3000; ++i) link.send(kEngaged);
    start = local_now();
  }
  EXPECT_LT(seconds_between(start, local_now()), TetherWatchdog::kRepeat_s + 2 * kSlack_s);
}

TEST(TetherLink, MissingPortIsAnInputError) {
  EXPECT_THROW(TetherLink(TetherConfig{.port = "serial:/dev/none:115200"}), InputError);
  EXPECT_THROW(TetherLink(TetherConfig{.port = "udp://:14550"}), InputError);
  EXPECT_THROW(TetherLink(TetherConfig{.port = "/dev/ttyUSB0"}), InputError);
}

}  // namespace
}  // namespace stillkite
