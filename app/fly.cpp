#include <fmt/chrono.h>
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "app/autopilot_output.hpp"
#include "app/commands.hpp"
#include "app/flight_estimator.hpp"
#include "app/flight_page.hpp"
#include "app/interrupt.hpp"
#include "app/json_output.hpp"
#include "app/latency_histogram.hpp"
#include "app/message_log.hpp"
#include "app/options.hpp"
#include "app/results_folder.hpp"
#include "app/tether_control.hpp"
#include "io/config/config_printing.hpp"
#include "io/results/estimates_csv.hpp"
#include "io/results/output_file.hpp"
#include "io/text_file.hpp"
#include "io/video/luma.hpp"
#include "live/clock/local_clock.hpp"
#include "live/link/autopilot_link.hpp"
#include "live/record/flight_record.hpp"
#include "live/stream/stream_address.hpp"
#include "live/stream/video_capture.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct FlyArguments {
  std::optional<fs::path> config;
  std::vector<std::string> overrides;
  fs::path out;
  bool print = false;
};

fs::path flight_folder(const FlyArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  const std::string name = arguments.config ? flight_name(*arguments.config) : "flight";
  return fs::path("out") /
         fmt::format("{}-{:%Y%m%d-%H%M%S}", name, fmt::gmtime(std::time(nullptr)));
}

// Copies the calibration into the record, so that it can be read without other files.
CalibrationConfig copied(CalibrationConfig calibration, const fs::path& folder) {
  const auto copy = [&](std::optional<fs::path>& path, const std::string& name) {
    if (!path) return;
    const fs::path file = fs::path(name) += path->extension();
    write_file(folder / file, read_bytes(*path));
    path = file;
  };
  copy(calibration.path, "calibration");
  copy(calibration.mask_path, "mask");
  return calibration;
}

void write_flight_config(FlyConfig config, const fs::path& folder) {
  config.source.path = without_password(config.source.path);
  config.calibration = copied(config.calibration, folder);
  write_file(folder / kFlightConfig, print_config(config));
}

// Throws InputError before anything is opened or written.
StreamConfig expanded(StreamConfig source) {
  source.path = expand_environment(source.path, "source.path");
  static_cast<void>(parse_stream_address(source.path));
  return source;
}

/// One live flight: connections, estimator and record.
class Flight {
 public:
  Flight(const FlyConfig& config, const StreamConfig& source, const fs::path& folder)
      : tether_(make_tether(config.live)),
        estimator_(config),
        page_(make_page(config.live)),
        luma_(std::make_shared<LumaExtractor>("source.path", std::nullopt)) {
    const LiveConfig& live = config.live;
    if (live.json) json_.emplace(*live.json);
    if (live.mavlink) {
      link_.emplace(parse_link_address(*live.mavlink, "live.mavlink"),
                    static_cast<std::uint8_t>(live.system_id), live.send.origin);
      autopilot_.emplace(*link_, live.send, config.navigator.trust.max_gap_s);
    }
    // last: a connection or file that is missing leaves no record
    for (const auto& file : {config.calibration.path, config.calibration.mask_path}) {
      if (file) static_cast<void>(read_bytes(*file));
    }
    record_.emplace(folder);
    write_flight_config(config, folder);
    record_->add_estimate(estimates_csv_header());
    if (tether_) tether_->log_to(folder, *record_);
    capture_.emplace(
        source,
        [luma = luma_](const AVFrame& image, cv::Mat recycled) {
          return luma->extract(image, std::move(recycled));
        },
        reporter(), &*record_);
  }

  // Estimates until the end of the input or Ctrl-C.
  void run() {
    constexpr double kWait_s = 0.1;  // Ctrl-C and telemetry without frames
    while (!interrupted() && !capture_->has_ended()) {
      const std::optional<CapturedFrame> captured = capture_->next(kWait_s);
      receive_messages();
      if (captured) {
        wait_for_telemetry(captured->frame.stamp);
        step(*captured);
        last_image_ = captured->arrival;
      } else if (autopilot_) {
        autopilot_->report_missing_images(seconds_between(last_image_, local_now()));
      }
      report_silence();
      report_record_failure();
      if (page_) page_->publish(status());
    }
    if (capture_->failure()) std::rethrow_exception(capture_->failure());
  }

  [[nodiscard]] bool has_images() const { return capture_->counts().decoded > 0; }
  [[nodiscard]] bool has_estimates() const { return used_ > 0; }

  void report_counts() {
    const CaptureCounts counts = capture_->counts();
    report(fmt::format("{} images decoded, {} used, {} replaced by newer ones, {} rejected",
                       counts.decoded, used_, counts.replaced, counts.rejected));
    if (const auto median_ms = latency_.quantile_ms(0.5)) {
      report(fmt::format("arrival to estimate: {:.1f} ms (median), {:.1f} ms (99 %)", *median_ms,
                         *latency_.quantile_ms(0.99)));
    }
    if (json_ && json_->dropped() > 0) {
      report(fmt::format("live.json: {} lines dropped: the reader of standard output is too slow",
                         json_->dropped()));
    }
    if (tether_) report(tether_->counts());
    if (!link_) return;
    const mavlink::ParserCounts packets = link_->counts();
    report(
        fmt::format("MAVLink: {} packets read, {} of other messages, {} checksum errors, {} lost",
                    packets.packets, packets.unknown, packets.checksum_errors, packets.lost));
  }

 private:
  std::unique_ptr<TetherControl> make_tether(const LiveConfig& live) {
    return live.tether.port ? std::make_unique<TetherControl>(live, reporter()) : nullptr;
  }

  std::unique_ptr<FlightPage> make_page(const LiveConfig& live) {
    OperatorQueue* operators = tether_ ? &tether_->operators() : nullptr;
    return live.listen ? std::make_unique<FlightPage>(live, operators, log_, reporter()) : nullptr;
  }

  // To standard error and to the page; called on any thread.
  void report(const std::string& message) {
    std::fputs(fmt::format("stillkite: {}\n", message).c_str(), stderr);
    log_.add(local_now(), message);
  }
  std::function<void(const std::string&)> reporter() {
    return [this](const std::string& message) { report(message); };
  }

  void receive_messages() {
    if (tether_) messages_ += tether_->receive(estimator_, *record_);
    if (!link_) return;
    for (const ReceivedPacket& received : link_->take()) {
      last_packet_ = received.arrival;
      check_system(received.packet);
      const auto bytes = received.packet.raw.bytes();
      record_->add_message({.arrival = received.arrival, .bytes = {bytes.begin(), bytes.end()}});
      estimator_.receive(received.packet, received.arrival);
      ++messages_;
    }
  }

  void check_system(const mavlink::Packet& packet) {
    const int expected = estimator_.config().live.system_id;
    const bool is_other = packet.component == mavlink::kAutopilot && packet.system != expected;
    if (!is_other || std::exchange(has_reported_system_, true)) return;
    report(fmt::format("MAVLink: autopilot of system {} is ignored; live.system_id is {}",
                       packet.system, expected));
  }

  void report_silence() {
    constexpr double kSilence_s = 2;
    if (!link_) return;
    const bool is_silent = seconds_between(last_packet_, local_now()) > kSilence_s;
    if (is_silent == std::exchange(is_silent_, is_silent)) return;
    report(is_silent ? fmt::format("MAVLink: no packet for {:.0f} s", kSilence_s)
                     : std::string("MAVLink: connected"));
  }

  // Readings up to the frame's stamp, which may arrive after the frame.
  void wait_for_telemetry(Timestamp stamp) {
    constexpr std::chrono::milliseconds kStep{1};
    constexpr int kMaxSteps = 50;
    for (int i = 0; i < kMaxSteps && !estimator_.has_telemetry_until(stamp); ++i) {
      std::this_thread::sleep_for(kStep);
      receive_messages();
    }
  }

  void step(const CapturedFrame& captured) {
    const Frame& frame = captured.frame;
    const bool is_ready = estimator_.is_ready(frame.stamp);
    const Timestamp decision = local_now();
    record_->add_frame({.index = frame.index,
                        .outcome = is_ready ? FrameOutcome::used : FrameOutcome::settling,
                        .stamp = frame.stamp,
                        .stamp_sigma_s = frame.stamp_sigma_s,
                        .telemetry = messages_,
                        .decision = decision});
    if (!is_ready) {
      if (!std::exchange(has_reported_wait_, true)) {
        report("waiting for the telemetry of the initial state (live.telemetry, live.tether)");
      }
      return;
    }
    const PilotStep result = estimator_.step(frame, decision);
    if (tether_) tether_->send(result, estimator_, *record_);
    const NavigationEstimate& estimate = result.estimate;
    const FlightInputs& inputs = estimator_.inputs();
    if (autopilot_) {
      autopilot_->send(estimate, inputs.body_from_camera, inputs.camera.focal_x_px);
    }
    send_json(estimate);
    const Timestamp now = local_now();
    const double latency_s = seconds_between(captured.arrival, now);
    latency_.add(1e3 * latency_s);
    record_->add_estimate(estimates_csv_row(estimate));
    ++used_;
    if (!page_) return;
    page_->publish({.step = result,
                    .grey = frame.grey,
                    .flow_vectors = page_->is_watched() ? estimator_.flow_vectors()
                                                        : std::vector<WeightedFlow>(),
                    .camera = inputs.camera,
                    .body_from_camera = inputs.body_from_camera,
                    .estimated = now,
                    .latency_s = latency_s},
                   status());
  }

  [[nodiscard]] FlightStatus status() const {
    const CommandGate& gate = estimator_.gate();
    return {.has_station = tether_ != nullptr,
            .is_supervised = !tether_ || tether_->is_supervised(),
            .is_engaged = gate.is_engaged(),
            .is_stopped = gate.is_stopped(),
            .is_waiting_for_telemetry = has_reported_wait_ && used_ == 0,
            .images = capture_->counts(),
            .used_images = used_};
  }

  // Without a reader of the lines the flight continues only for the autopilot.
  void send_json(const NavigationEstimate& estimate) {
    if (!json_ || json_->send(estimate)) return;
    if (!link_) throw std::runtime_error("live.json: standard output is closed");
    report("live.json: standard output is closed; no further lines");
    json_.reset();
  }

  void report_record_failure() {
    if (has_reported_failure_) return;
    if (const auto failure = record_->failure()) {
      report(*failure);
      has_reported_failure_ = true;
    }
  }

  MessageLog log_;
  std::unique_ptr<TetherControl> tether_;  // forks before any thread starts
  FlightEstimator estimator_;
  std::unique_ptr<FlightPage> page_;  // before the record: a page that cannot start leaves none
  std::shared_ptr<LumaExtractor> luma_;
  std::optional<JsonOutput> json_;
  std::optional<AutopilotLink> link_;
  std::optional<AutopilotOutput> autopilot_;
  std::optional<FlightRecord> record_;
  LatencyHistogram latency_;
  std::int64_t used_ = 0, messages_ = 0;
  Timestamp last_image_ = local_now(), last_packet_ = local_now();
  bool is_silent_ = false;
  bool has_reported_wait_ = false, has_reported_failure_ = false, has_reported_system_ = false;
  std::optional<VideoCapture> capture_;  // last: its thread uses record_ and luma_
};

void fly(const FlyArguments& arguments) {
  const FlyConfig config = load_fly_config(arguments.config, arguments.overrides);
  if (arguments.print) {
    fmt::print("{}", print_config(config));
    return;
  }
  std::signal(SIGPIPE, SIG_IGN);  // write() then returns an error without a reader
  const StreamConfig source = expanded(config.source);
  const fs::path folder = flight_folder(arguments);
  bool has_estimates = false;
  {
    const auto flight = std::make_unique<Flight>(config, source, folder);
    flight->run();
    flight->report_counts();
    has_estimates = flight->has_estimates();
    if (!interrupted() && !flight->has_images()) {
      throw InputError(
          "source.path: standard input has no video; expected MPEG-TS, MJPEG or H.264");
    }
  }
  if (has_estimates) {
    fmt::print(stderr, "stillkite: record: {0}; its estimates again: stillkite run {0}\n",
               folder.string());
  }
  if (interrupted()) throw Interrupted{};
}

}  // namespace

void add_fly(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "fly",
      "Estimate the motion from a live video; telemetry, MAVLink output, tethered position hold, "
      "operator's page");
  const auto arguments = std::make_shared<FlyArguments>();
  command->add_option("config", arguments->config, "YAML file (default: default values)");
  add_overrides(*command, arguments->overrides);
  command
      ->add_option("--out", arguments->out, "New folder for the record (default: out/CONFIG-TIME)")
      ->type_name("DIR");
  command->add_flag("--print", arguments->print,
                    "Print the configuration with descriptions and exit");
  command->footer(
      "Keys with default and description: stillkite fly --print > flight.yaml\n"
      "Records video, telemetry, estimates and commands; stillkite run DIR computes them again.\n"
      "Example: stillkite fly flight.yaml --set source.path=udp://127.0.0.1:5600 --set "
      "live.json=-\n"
      "Operator's page: --set live.listen=127.0.0.1:8080, then http://127.0.0.1:8080 in a browser");
  command->callback([arguments] { fly(*arguments); });
}

}  // namespace stillkite
