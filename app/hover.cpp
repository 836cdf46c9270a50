#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/hover_report_trials.hpp"
#include "app/hover_results.hpp"
#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "io/config_printing.hpp"
#include "io/output_file.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct HoverArguments {
  fs::path config;
  std::vector<std::string> overrides;
  fs::path out;
  int jobs = 0;
  bool json = false;
};

constexpr std::uintmax_t kBytesPerTrial = 1 << 20;

// The plant of its own file first, then what the configuration says.
HoverConfig load_hover_config(const HoverArguments& arguments) {
  ConfigNode root = read_yaml(arguments.config);
  for (const std::string& assignment : arguments.overrides) apply_override(root, assignment);
  HoverConfig config;
  if (root.find("plant_file") != nullptr) {
    const auto file = bind_config<HoverConfig>(root).plant_file;
    if (file) config.plant = bind_config<PlantConfig>(read_yaml(*file));
  }
  return bind_config<HoverConfig>(root, config);
}

/// A picture as the video link's compression leaves it.
cv::Mat through_jpeg(const cv::Mat& grey, int quality) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
}

HoverWorld make_world(const HoverConfig& config) {
  const int quality = config.link.jpeg_quality;
  if (quality == 0) return make_hover_world(config);
  return make_hover_world(config,
                          [quality](const cv::Mat& grey) { return through_jpeg(grey, quality); });
}

/// Trials flown side by side, one a thread; the records are in the trials' order.
class TrialFleet {
 public:
  TrialFleet(const HoverConfig& config, std::vector<Trial> trials)
      : config_(config),
        world_(make_world(config)),
        trials_(std::move(trials)),
        records_(trials_.size()),
        pictures_(trials_.size()),
        progress_("hover", static_cast<std::int64_t>(trials_.size())) {}

  /// Until all are flown, or Ctrl-C.
  void fly(int jobs) {
    {
      std::vector<std::jthread> crew;
      crew.reserve(static_cast<std::size_t>(jobs));
      for (int i = 0; i < jobs; ++i) crew.emplace_back([this] { fly_next_ones(); });
    }
    if (failure_) std::rethrow_exception(failure_);
    forget_unfinished();
  }

  /// Those that were flown to their end.
  [[nodiscard]] const std::vector<TrialRecord>& records() const { return records_; }
  /// Of what the camera saw, a few a second, of one stabilized trial an axis.
  [[nodiscard]] const std::vector<std::vector<HoverPicture>>& pictures() const { return pictures_; }

 private:
  void fly_next_ones() {
    try {
      for (std::size_t i = next_++; i < trials_.size() && !stopped_; i = next_++) {
        records_[i] = fly_trial(config_, world_, trials_[i], [&](const Frame& frame, auto&&...) {
          if (stopped_ || interrupted()) throw Interrupted{};
          if (is_filmed(i)) film(frame, pictures_[i]);
        });
        const std::scoped_lock lock(mutex_);
        progress_.step();
      }
    } catch (const Interrupted&) {
      stopped_ = true;
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (!stopped_.exchange(true)) failure_ = std::current_exception();
    }
  }

  void forget_unfinished() {
    for (std::size_t i = records_.size(); i-- > 0;) {
      if (!records_[i].samples.empty()) continue;
      records_.erase(records_.begin() + static_cast<std::ptrdiff_t>(i));
      pictures_.erase(pictures_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  // The first with stabilization along its axis.
  [[nodiscard]] bool is_filmed(std::size_t i) const {
    return trials_[i].stabilized &&
           std::none_of(trials_.begin(), trials_.begin() + static_cast<std::ptrdiff_t>(i),
                        [&](const Trial& before) {
                          return before.stabilized && before.axis == trials_[i].axis;
                        });
  }

  static void film(const Frame& frame, std::vector<HoverPicture>& pictures) {
    constexpr double kPeriod_s = 0.2;
    constexpr double kSlack_s = 1e-3;
    const double t_s = to_seconds(frame.stamp);
    if (!pictures.empty() && t_s < pictures.back().t_s + kPeriod_s - kSlack_s) return;
    pictures.push_back(hover_picture(frame));
  }

  const HoverConfig& config_;
  HoverWorld world_;
  std::vector<Trial> trials_;
  std::vector<TrialRecord> records_;
  std::vector<std::vector<HoverPicture>> pictures_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::exception_ptr failure_;
  ProgressBar progress_;
};

int crew_size(int asked_for, std::size_t trials) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min(asked_for > 0 ? asked_for : cores, static_cast<int>(trials));
}

void hover(const HoverArguments& arguments) {
  const HoverConfig config = load_hover_config(arguments);
  const std::vector<Trial> trials = make_trials(config);
  if (trials.empty()) {
    throw InputError("hover: trials.on and trials.off are both 0; nothing would be flown");
  }
  const fs::path out =
      arguments.out.empty() ? fs::path("out") / arguments.config.stem() : arguments.out;
  prepare_output_folder(out, trials.size() * kBytesPerTrial);

  // a trial is one thread: side by side they use the cores better than OpenCV would within one
  cv::setNumThreads(1);
  const auto start = std::chrono::steady_clock::now();
  TrialFleet fleet(config, trials);
  fleet.fly(crew_size(arguments.jobs, trials.size()));
  const std::vector<TrialRecord>& records = fleet.records();
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const std::string policy(name_of(config.estimator.policy));
  const nlohmann::json summary = hover_summary(records, policy, wall_s);
  write_file(out / "trials.csv", trials_csv(records, policy));
  write_file(out / "samples.csv", samples_csv(records));
  write_file(out / "hover.yaml", print_config(config));
  write_file(out / "summary.json", summary.dump(2) + '\n');
  const std::vector<HoverReportTrial> drawn =
      hover_report_trials(records, fleet.pictures(), policy);
  write_hover_report(
      out / "report.html",
      {.title = arguments.config.string(), .trials = drawn, .config_yaml = print_config(config)},
      summary);
  if (arguments.json) {
    fmt::print("{}\n", summary.dump(2));
  } else {
    fmt::print("{}\n{} trials, {:.1f} times as fast as real time\nreport       {}\n",
               hover_table(summary), records.size(),
               summary["timing"]["real_time_factor"].get<double>(), (out / "report.html").string());
  }
}

}  // namespace

void add_hover(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "hover", "Fly the tethered drone in closed loop while its station moves: the hold trials");
  const auto arguments = std::make_shared<HoverArguments>();
  command->add_option("config", arguments->config, "YAML file, such as configs/trials_paper.yaml")
      ->required();
  command
      ->add_option("--set", arguments->overrides,
                   "Override a key of the configuration, as key=value; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command->add_option("--out", arguments->out, "Folder for the results (default: out/CONFIG)")
      ->type_name("DIR");
  command->add_option("--jobs", arguments->jobs, "Trials flown at once (default: one a core)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", arguments->json, "Print summary.json on stdout and nothing else");
  command->footer(
      "Writes trials.csv (a row a trial), samples.csv (a row a picture), summary.json, "
      "report.html\n"
      "and the effective configuration hover.yaml.");
  command->callback([arguments] { hover(*arguments); });
}

}  // namespace stillkite
