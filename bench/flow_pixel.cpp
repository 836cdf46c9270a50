// End-point error and run time of dense optical flow methods, compared with pyramidal Lucas-Kanade
// on a grid. Methods run interleaved: other load of the machine affects all of them.

#include <fmt/format.h>
#include <hwy/highway.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <opencv2/core/utility.hpp>

#include "flow/dense_lucas_kanade.hpp"
#include "flow/opencv_flow.hpp"
#include "flow_pairs.hpp"

namespace stillkite::bench {
namespace {

namespace fs = std::filesystem;

struct Method {
  std::string name;
  std::function<const FlowField&(const FlowPair&)> run;
};

struct Error {
  double mean_px, median_px, ninety_percent_px, over_one_px_percent;
};

double quantile(std::vector<float>& values, double part) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Over all vectors with a available true flow, including lost grid points.
Error end_point_error(const FlowField& field, const cv::Mat& truth_px) {
  std::vector<float> errors;
  const int half = field.stride_px / 2;
  for (int i = 0; i < field.flow_px.rows; ++i) {
    for (int j = 0; j < field.flow_px.cols; ++j) {
      const auto& truth =
          truth_px.at<cv::Vec2f>(field.stride_px * i + half, field.stride_px * j + half);
      const cv::Vec2f difference = field.flow_px.at<cv::Vec2f>(i, j) - truth;
      const float error = std::hypot(difference[0], difference[1]);
      if (std::isfinite(error)) errors.push_back(error);
    }
  }
  const auto count = static_cast<double>(errors.size());
  double sum = 0;
  for (const float error : errors) sum += error;
  const auto over = std::count_if(errors.begin(), errors.end(), [](float e) { return e > 1; });
  return {sum / count, quantile(errors, 0.5), quantile(errors, 0.9),
          100.0 * static_cast<double>(over) / count};
}

std::vector<Method> all_methods(const DenseLucasKanadeConfig& dense) {
  std::vector<Method> methods;
  methods.reserve(EnumNames<OpenCvFlowMethod>::value.size() + 1);
  for (const auto& [method, name] : EnumNames<OpenCvFlowMethod>::value) {
    methods.push_back({std::string(name),
                       [flow = std::make_shared<OpenCvFlow>(OpenCvFlowConfig{.method = method})](
                           const FlowPair& pair) -> const FlowField& {
                         return (*flow)(pair.previous, pair.current);
                       }});
  }
  methods.push_back({"dense",
                     [flow = std::make_shared<DenseLucasKanade>(dense)](const FlowPair& pair)
                         -> const FlowField& { return (*flow)(pair.previous, pair.current); }});
  return methods;
}

void compare_on(const FlowPair& pair, const std::vector<Method>& methods, int repeats) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<float>> wall_ms(methods.size());
  std::vector<std::vector<float>> processor_ms(methods.size());
  std::vector<Error> errors(methods.size());
  // Errors from an untimed first run, which also allocates the buffers.
  for (std::size_t m = 0; m < methods.size(); ++m) {
    errors[m] = end_point_error(methods[m].run(pair), pair.truth_px);
  }
  for (int round = 0; round < repeats; ++round) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const auto start = Clock::now();
      const std::clock_t processor_start = std::clock();
      methods[m].run(pair);
      const std::clock_t processor_ticks = std::clock() - processor_start;
      wall_ms[m].push_back(std::chrono::duration<float, std::milli>(Clock::now() - start).count());
      processor_ms[m].push_back(1e3F * static_cast<float>(processor_ticks) / CLOCKS_PER_SEC);
    }
  }
  fmt::print("\n{}, {}x{}\n", pair.name, pair.previous.cols, pair.previous.rows);
  fmt::print("{:<24} {:>8} {:>8} {:>10} {:>8} {:>8} {:>8} {:>8}\n", "method", "wall ms", "cpu ms",
             "farneback/", "EPE px", "median", "90 %", "% > 1 px");
  const double farneback_ms = quantile(wall_ms.front(), 0.5);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const double ms = quantile(wall_ms[m], 0.5);
    const Error& e = errors[m];
    fmt::print("{:<24} {:>8.1f} {:>8.1f} {:>10.1f} {:>8.4f} {:>8.4f} {:>8.4f} {:>8.2f}\n",
               methods[m].name, ms, quantile(processor_ms[m], 0.5), farneback_ms / ms, e.mean_px,
               e.median_px, e.ninety_percent_px, e.over_one_px_percent);
  }
}

// Restricts the dispatch of the dense flow (not of OpenCV) to one instruction set.
void restrict_to(const std::string& instruction_set) {
  std::string available;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    available += fmt::format(" {}", hwy::TargetName(target));
    if (instruction_set != hwy::TargetName(target)) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return;
  }
  throw InputError(
      fmt::format("--instruction_set {}: not available; use one of{}", instruction_set, available));
}

int compare(int argc, char** argv) {
  CLI::App app{
      "End-point error and time (median) of dense Lucas-Kanade, Farneback, DIS and pyramidal "
      "Lucas-Kanade on a grid of stride 8"};
  int repeats = 5;
  int threads = 1;
  double noise_grey = 1.5;
  std::uint64_t seed = 1;
  fs::path data;
  if (const char* folder = std::getenv("STILLKITE_DATA")) data = folder;
  app.add_option("--repeats", repeats, "runs of each method, interleaved")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--threads", threads, "threads of OpenCV and the dense flow")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--noise", noise_grey, "noise of the rendered frames, grey values")
      ->capture_default_str();
  app.add_option("--seed", seed, "seed of ground and noise")->capture_default_str();
  app.add_option("--data", data,
                 "folder with ground_photos/*.jpg and middlebury/*/, default $STILLKITE_DATA; "
                 "procedural ground only if unset")
      ->capture_default_str();
  std::string instruction_set;
  app.add_option(
      "--instruction_set", instruction_set,
      "instruction set of the dense flow, e.g. SCALAR, SSE4, AVX2, AVX3; default: best available");
  DenseLucasKanadeConfig dense;
  DenseLucasKanadeConfig::fields(
      dense, [&](const std::string& name, auto& value, const auto&, const std::string& meaning) {
        app.add_option("--" + name, value, "dense: " + meaning)->capture_default_str();
      });
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(threads);
  if (!instruction_set.empty()) restrict_to(instruction_set);
  std::vector<fs::path> photographs;
  if (!data.empty()) {
    for (const auto& entry : fs::directory_iterator(data / "ground_photos")) {
      if (entry.path().extension() == ".jpg") photographs.push_back(entry.path());
    }
    std::sort(photographs.begin(), photographs.end());
  }
  std::vector<FlowPair> pairs = rendered_pairs(photographs, noise_grey, seed);
  if (!data.empty()) {
    for (FlowPair& pair : middlebury_pairs(data / "middlebury")) pairs.push_back(std::move(pair));
  }
  for (const FlowPair& pair : pairs) compare_on(pair, all_methods(dense), repeats);
  return 0;
}

}  // namespace
}  // namespace stillkite::bench

int main(int argc, char** argv) {
  try {
    return stillkite::bench::compare(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
