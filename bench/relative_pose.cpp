// Error and run time of two-view relative pose: Stillkite and OpenCV, interleaved on the same
// pairs. Confusion matrix of the model test: general scene, plane, rotation only, still.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <opencv2/core/utility.hpp>

#include "estimation/two_view/opencv_relative_pose.hpp"
#include "estimation/two_view/relative_pose_estimator.hpp"
#include "tests/estimation/two_view/two_view_scene.hpp"

namespace stillkite::bench {
namespace {

constexpr double kFocal_px = TwoViewScene::kFocal_px;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Method {
  std::string name;
  std::function<RelativePoseEstimate(const TwoViews&, std::uint32_t seed)> run;
};

// Prior with 1 deg rotation error and 10 deg direction error; 90 deg in every twentieth run.
RelativePose prior_of(const TwoViews& views, std::uint32_t seed) {
  const auto random_direction = [&](std::uint32_t k) {
    const TwoViews other = make_two_views({.points = 1}, 7919 * seed + k);
    return other.truth.direction;
  };
  const double prior_error_deg = seed % 20 == 0 ? 90 : 10;
  const Eigen::Vector3d& t = views.truth.direction;
  const Eigen::Vector3d axis = t.cross(random_direction(1)).normalized();
  return {so3_exp(kDegree * random_direction(2)) * views.truth.current_from_reference,
          so3_exp(prior_error_deg * kDegree * axis) * t};
}

std::vector<Method> all_methods(const RelativePoseConfig& config) {
  std::vector<Method> methods;
  for (const auto& [method, name] : EnumNames<EssentialMethod>::value) {
    const OpenCvPoseConfig opencv{.essential_method = method,
                                  .threshold_px = config.threshold_px,
                                  .confidence = config.confidence,
                                  .correct_matches = false};
    methods.push_back({fmt::format("OpenCV {}", name), [opencv](const TwoViews& v, std::uint32_t) {
                         return estimate_relative_pose_opencv(v.pairs, kFocal_px, opencv);
                       }});
  }
  methods.push_back({"Stillkite, cold", [config](const TwoViews& v, std::uint32_t) {
                       return estimate_relative_pose(v.pairs, kFocal_px, config);
                     }});
  methods.push_back({"Stillkite, warm", [config](const TwoViews& v, std::uint32_t seed) {
                       return estimate_relative_pose(v.pairs, kFocal_px, config,
                                                     {.prior = prior_of(v, seed)});
                     }});
  RelativePoseConfig plain = config;
  plain.model_test = false;
  methods.push_back({"Stillkite, cold, no model test", [plain](const TwoViews& v, std::uint32_t) {
                       return estimate_relative_pose(v.pairs, kFocal_px, plain);
                     }});
  return methods;
}

void compare_at(double outliers, int seeds, const RelativePoseConfig& config) {
  const std::vector<Method> methods = all_methods(config);
  std::vector<std::vector<double>> rotation(methods.size()), direction(methods.size()),
      ms(methods.size());
  for (int seed = 1; seed <= seeds; ++seed) {
    const TwoViews views = make_two_views({.outliers = outliers}, static_cast<std::uint32_t>(seed));
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const std::clock_t start = std::clock();
      const RelativePoseEstimate estimate = methods[m].run(views, static_cast<std::uint32_t>(seed));
      ms[m].push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
      rotation[m].push_back(rotation_error_deg(estimate.pose, views.truth));
      direction[m].push_back(direction_error_deg(estimate.pose, views.truth));
    }
  }
  fmt::print("\n{:.0f} % outliers, {} seeds: medians, CPU time of one thread\n", 100 * outliers,
             seeds);
  fmt::print("{:<32} {:>12} {:>12} {:>12} {:>8} {:>10}\n", "method", "rotation deg", "(maximum)",
             "direction", "ms", "of MAGSAC");
  const double magsac_ms = median_of(ms[4]);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    fmt::print("{:<32} {:>12.4f} {:>12.4f} {:>12.3f} {:>8.3f} {:>10.3f}\n", methods[m].name,
               median_of(rotation[m]), *std::max_element(rotation[m].begin(), rotation[m].end()),
               median_of(direction[m]), median_of(ms[m]), median_of(ms[m]) / magsac_ms);
  }
}

// Maximum deviation from the next simpler model, in standard deviations of the noise: relief from
// the plane, parallax from the rotation, rotation from zero motion.
double discriminating_sigma(const TwoViewScene& scene, const TwoViews& views) {
  switch (scene.content) {
    case ViewModel::general:
      return views.deviation_px / scene.noise_px;
    case ViewModel::plane:
      return views.parallax_px / scene.noise_px;
    case ViewModel::rotation_only:
      return scene.rotation_rad * kFocal_px / scene.noise_px;
    default:
      return 0;
  }
}

struct Tally {
  std::map<ViewModel, int> verdicts;
  int frames = 0, correct = 0, flips = 0, false_translations = 0;
  double max_rotation_error_deg = 0;
};

void count_verdict(const TwoViewScene& scene, const TwoViews& views,
                   const RelativePoseEstimate& estimate, Tally& tally) {
  ++tally.frames;
  ++tally.verdicts[estimate.model];
  tally.correct += estimate.model == scene.content ? 1 : 0;
  if (estimate.model == ViewModel::undecided) return;
  tally.max_rotation_error_deg =
      std::max(tally.max_rotation_error_deg, rotation_error_deg(estimate.pose, views.truth));
  const bool has_direction = estimate.pose.direction.norm() > 0;
  if (has_direction && views.truth.direction.norm() == 0) ++tally.false_translations;
  if (has_direction && estimate.pose.direction.dot(views.truth.direction) < 0) ++tally.flips;
}

void print_tally(const std::string& name, const Tally& tally) {
  fmt::print("{:<36} {:>6}", name, tally.frames);
  for (const auto& [model, model_name] : EnumNames<ViewModel>::value) {
    const auto at = tally.verdicts.find(model);
    fmt::print(" {:>{}}", at == tally.verdicts.end() ? 0 : at->second,
               std::max<std::size_t>(model_name.size(), 6));
  }
  fmt::print(" {:>8.1f} {:>10.4f} {:>6} {:>6}\n",
             tally.frames > 0 ? 100.0 * tally.correct / tally.frames : 0.0,
             tally.max_rotation_error_deg, tally.flips, tally.false_translations);
}

void confusion(int seeds, const RelativePoseConfig& config, bool with_vertical) {
  fmt::print(
      "\nModel test, {}: frames by selected model; % correct; maximum rotation error, deg; "
      "direction errors over 90 deg; false translations\n",
      with_vertical ? "vertical given" : "no vertical, no prior");
  fmt::print("{:<36} {:>6}", "scene", "frames");
  for (const auto& [model, name] : EnumNames<ViewModel>::value) {
    fmt::print(" {:>{}}", name, std::max<std::size_t>(name.size(), 6));
  }
  fmt::print(" {:>8} {:>10} {:>6} {:>6}\n", "correct", "rotation", "flips", "false");
  for (const ViewModel content :
       {ViewModel::still, ViewModel::rotation_only, ViewModel::plane, ViewModel::general}) {
    Tally observable, unobservable;
    const bool moves = content == ViewModel::plane || content == ViewModel::general;
    const std::vector<double> sizes =
        moves ? std::vector{0.005, 0.02, 0.05, 0.1, 0.2} : std::vector{0.001, 0.01, 0.1};
    for (const double size : sizes) {
      for (int k = 0; k < seeds; ++k) {
        const auto seed = static_cast<std::uint32_t>(1000 + k);
        TwoViewScene scene{.content = content, .outliers = 0.1 + 0.2 * k / seeds};
        (moves ? scene.baseline : scene.rotation_rad) = size;
        const TwoViews views = make_two_views(scene, seed);
        RelativePoseHints hints;
        if (with_vertical) {
          hints.up_in_reference = -views.normal;
          hints.up_in_current = views.truth.current_from_reference * -views.normal;
        }
        const RelativePoseEstimate estimate =
            estimate_relative_pose(views.pairs, kFocal_px, config, hints);
        const bool is_observable =
            content == ViewModel::still || discriminating_sigma(scene, views) > 5;
        count_verdict(scene, views, estimate, is_observable ? observable : unobservable);
      }
    }
    print_tally(fmt::format("{}, above 5 sigma", name_of(content)), observable);
    print_tally(fmt::format("{}, below 5 sigma", name_of(content)), unobservable);
  }
}

int compare(int argc, char** argv) {
  CLI::App app{
      "Two-view relative pose from 1000 pairs: error, run time and model test, compared with "
      "OpenCV"};
  int seeds = 40;
  RelativePoseConfig config;
  app.add_option("--seeds", seeds)->check(CLI::PositiveNumber)->capture_default_str();
  RelativePoseConfig::fields(config,
                             [&](const std::string& name, auto& value, const auto&... rest) {
                               app.add_option("--" + name, value)->capture_default_str();
                               ((void)rest, ...);
                             });
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  for (const double outliers : {0.3, 0.6}) compare_at(outliers, seeds, config);
  for (const bool with_vertical : {true, false}) confusion(seeds + 10, config, with_vertical);
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
