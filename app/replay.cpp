#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <thread>
#include <utility>

#include "app/commands.hpp"
#include "app/flight_page.hpp"
#include "app/interrupt.hpp"
#include "app/options.hpp"
#include "app/recorded_flight.hpp"
#include "live/clock/local_clock.hpp"

namespace stillkite {
namespace {

struct PlaybackArguments {
  std::filesystem::path record;
  std::vector<std::string> overrides;
  std::string listen = "127.0.0.1:8080";
  double speed = 1;
};

/// Plays a recorded flight on the operator's page, in the time of the flight divided by the speed.
class FlightPlayback {
 public:
  explicit FlightPlayback(const PlaybackArguments& arguments)
      : speed_(arguments.speed),
        flight_(arguments.record, arguments.overrides, reporter()),
        page_({.listen = arguments.listen}, nullptr, log_, reporter()) {}

  // Until the end of the record or Ctrl-C.
  void play() {
    page_.publish(status_);
    while (!interrupted()) {
      std::optional<RecordedStep> step = flight_.next();
      if (!step) break;
      wait_until(step->decision);
      if (interrupted()) break;
      show(std::move(*step));
    }
    status_.replay->has_ended = true;
    page_.publish(status_);
    report(fmt::format("replay: {} images shown; Ctrl-C ends the page", status_.used_images));
    while (!interrupted()) std::this_thread::sleep_for(kPause);
  }

 private:
  static constexpr std::chrono::milliseconds kPause{50};

  void report(const std::string& message) {
    std::fputs(fmt::format("stillkite: {}\n", message).c_str(), stderr);
    log_.add(local_now(), message);
  }
  PageServer::Report reporter() {
    return [this](const std::string& message) { report(message); };
  }

  // The image that the estimator took at `decision` is shown then.
  void wait_until(Timestamp decision) {
    if (!first_) first_ = {decision, local_now()};
    status_.replay->time_s = seconds_between(first_->recorded, decision);
    const Timestamp due{first_->shown.ns + from_seconds(status_.replay->time_s / speed_).ns};
    while (!interrupted()) {
      const std::int64_t wait_ns = due.ns - local_now().ns;
      if (wait_ns <= 0) return;
      std::this_thread::sleep_for(
          std::min<std::chrono::nanoseconds>(std::chrono::nanoseconds(wait_ns), kPause));
    }
  }

  void show(RecordedStep step) {
    const FlightEstimator& estimator = flight_.estimator();
    const CommandGate& gate = estimator.gate();
    status_.has_station = estimator.has_tether();
    status_.is_engaged = gate.is_engaged();
    status_.is_stopped = gate.is_stopped();
    status_.images = step.images;
    ++status_.used_images;
    page_.publish({.step = std::move(step.result),
                   .grey = std::move(step.frame.grey),
                   .flow_vectors =
                       page_.is_watched() ? estimator.flow_vectors() : std::vector<WeightedFlow>(),
                   .camera = estimator.inputs().camera,
                   .body_from_camera = estimator.inputs().body_from_camera,
                   .estimated = local_now(),
                   .latency_s = std::nan("")},
                  status_);
  }

  struct Start {
    Timestamp recorded, shown;
  };

  double speed_;
  MessageLog log_;
  RecordedFlight flight_;
  FlightStatus status_{.replay = FlightStatus::Replay{.speed = speed_}};
  std::optional<Start> first_;
  FlightPage page_;  // last: its threads use the messages
};

void replay(const PlaybackArguments& arguments) {
  if (!is_flight_record(arguments.record)) {
    throw InputError(arguments.record.string() +
                     ": no record of a flight; expected the folder that stillkite fly wrote");
  }
  FlightPlayback(arguments).play();
  throw Interrupted{};
}

}  // namespace

void add_replay(CLI::App& app) {
  CLI::App* command = app.add_subcommand("replay", "Show a recorded flight on the operator's page");
  const auto arguments = std::make_shared<PlaybackArguments>();
  command->add_option("record", arguments->record, "Folder of the flight")->required();
  add_overrides(*command, arguments->overrides);
  command->add_option("--listen", arguments->listen, "Address of the page, as live.listen")
      ->capture_default_str()
      ->type_name("HOST:PORT");
  command->add_option("--speed", arguments->speed, "Multiple of real time")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 100.0));
  command->footer(
      "The estimates are computed again, as by stillkite run DIR; commands are disabled.\n"
      "Example: stillkite replay out/flight-20260102-030405 --speed 4");
  command->callback([arguments] { replay(*arguments); });
}

}  // namespace stillkite
