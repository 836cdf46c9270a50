// Tracking error of reference features in the images of a hover, compared with the tracker's
// covariance: rendered images with known depth, noise, haze and JPEG compression.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flow/feature_detection.hpp"
#include "flow/feature_tracker.hpp"
#include "geometry/angle.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/plant_config.hpp"
#include "simulation/random.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"

namespace {

using namespace stillkite;

constexpr double kFramesPerSecond = 30;
constexpr double kMaxError_px = 1;  // larger errors: wrong association

struct Options {
  std::string scene = "room";
  int seed = 1;
  int views = 150;
  int jpeg_quality = 80;
  double sway_m = 0.05;
  double advance_m = 0;
  double contrast_ratio = 1;
  double noise_grey = 2;
};

struct Sample {
  int view;
  Eigen::Vector2d error_px;
  double sigma_px;    // estimated by the tracker
  double chi_square;  // normalized squared error per coordinate
};
using SamplesOfFeature = std::map<std::size_t, std::vector<Sample>>;

class SwayingCamera {
 public:
  explicit SwayingCamera(const Options& options)
      : options_(options),
        scene_(options.scene == "room" ? make_room(static_cast<std::uint64_t>(options.seed))
                                       : make_coast(static_cast<std::uint64_t>(options.seed))),
        lens_(hover_camera().lens()),
        renderer_(lens_, hover_camera().supersampling),
        random_(static_cast<std::uint64_t>(options.seed), 7),
        reference_(RigidTransform{Eigen::Quaterniond::Identity(), {0, 0, 2}} *
                   camera_raised_forward(hover_camera().forward_tilt_deg)) {
    const cv::Mat grey = image(reference_);
    tracker_.set_reference(grey, detect_features(grey, {}));
  }

  void collect(int view, SamplesOfFeature& samples) {
    const RigidTransform camera = pose_at(view);
    const FeatureTracks& tracks = tracker_.track(image(camera));
    for (std::size_t i = 0; i < tracks.found.size(); ++i) {
      const Eigen::Vector2d at_px = tracks.reference_px[i].cast<double>();
      const std::optional<double> depth = depth_of_patch(at_px);
      if (tracks.found[i] == 0 || !depth) continue;
      const Eigen::Vector3d point = reference_ * (*depth * undistort(lens_, at_px)->homogeneous());
      const auto truth_px = project(lens_, camera.inverse() * point);
      if (!truth_px) continue;
      const Eigen::Vector2d error_px = tracks.current_px[i].cast<double>() - *truth_px;
      if (error_px.norm() > kMaxError_px) continue;
      const Eigen::Matrix2d C = tracks.covariance_px2[i].cast<double>();
      samples[i].push_back({view, error_px, std::sqrt(0.5 * C.trace()),
                            0.5 * error_px.dot(C.llt().solve(error_px))});
    }
  }

 private:
  [[nodiscard]] RigidTransform pose_at(int view) const {
    const double t_s = view / kFramesPerSecond;
    const Eigen::Vector3d sway(std::sin(1.3 * t_s), std::sin(1.7 * t_s + 1),
                               std::sin(2.1 * t_s + 2));
    const Eigen::Vector3d rotation_vector(0, 0, 0.3 * kDegree * std::sin(1.5 * t_s + 0.5));
    const double advance_m = options_.advance_m * view / options_.views;
    return {so3_exp(rotation_vector) * reference_.rotation,
            reference_.translation + options_.sway_m * sway + advance_m * Eigen::Vector3d::UnitX()};
  }

  [[nodiscard]] cv::Mat image(const RigidTransform& world_from_camera) {
    constexpr double kHaze_grey = 128;
    cv::Mat light = renderer_.render(scene_, world_from_camera);
    light.convertTo(light, -1, options_.contrast_ratio, (1 - options_.contrast_ratio) * kHaze_grey);
    const cv::Mat grey = develop(light, {.noise_grey = options_.noise_grey}, random_.bits());
    if (options_.jpeg_quality == 0) return grey;
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, options_.jpeg_quality});
    return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  }

  // Depth of the patch; nullopt across a depth discontinuity, where no single true motion exists.
  [[nodiscard]] std::optional<double> depth_of_patch(const Eigen::Vector2d& centre_px) const {
    constexpr double kHalf_px = 9;
    constexpr double kMaxDepthRatioError = 0.06;
    std::optional<double> middle;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1),
          Eigen::Vector2d(-1, 1), Eigen::Vector2d(1, 1)}) {
      const auto bearing = undistort(lens_, centre_px + kHalf_px * corner);
      const auto depth =
          bearing ? depth_at(scene_, ray_of(reference_, *bearing)) : std::optional<double>();
      if (!depth) return std::nullopt;
      if (!middle) middle = depth;
      if (std::abs(*depth / *middle - 1) > kMaxDepthRatioError) return std::nullopt;
    }
    return middle;
  }

  Options options_;
  PatchScene scene_;
  Camera lens_;
  PatchRenderer renderer_;
  Random random_;
  RigidTransform reference_;
  FeatureTracker tracker_{FeatureTrackerConfig{}};
};

void print_by_sigma(const SamplesOfFeature& samples) {
  constexpr std::array kEdges_px{0.0, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.08, 0.12, 1.0};
  fmt::print("{:>16}{:>10}{:>10}{:>12}\n", "sigma, px", "samples", "rms, px", "chi square");
  for (std::size_t bin = 0; bin + 1 < kEdges_px.size(); ++bin) {
    double square = 0, chi_square = 0;
    int count = 0;
    for (const auto& [feature, views] : samples) {
      for (const Sample& sample : views) {
        if (sample.sigma_px < kEdges_px[bin] || sample.sigma_px >= kEdges_px[bin + 1]) continue;
        square += 0.5 * sample.error_px.squaredNorm();
        chi_square += sample.chi_square;
        ++count;
      }
    }
    if (count == 0) continue;
    fmt::print("{:>8.3f}..{:<6.3f}{:>10}{:>10.4f}{:>12.2f}\n", kEdges_px[bin], kEdges_px[bin + 1],
               count, std::sqrt(square / count), chi_square / count);
  }
}

// Constant and varying part of the error per feature, and correlation of the varying part over
// time.
void print_over_time(const SamplesOfFeature& samples, int views) {
  constexpr std::array kLags{1, 3, 10, 30};
  const Eigen::Vector2d untracked = Eigen::Vector2d::Constant(std::nan(""));
  double variance = 0, constant = 0, varying = 0, count = 0;
  std::array<double, kLags.size()> product{}, pairs{};
  for (const auto& [feature, track] : samples) {
    if (static_cast<int>(track.size()) < 0.9 * views) continue;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Sample& sample : track) mean += sample.error_px / static_cast<double>(track.size());
    std::vector<Eigen::Vector2d> residuals(static_cast<std::size_t>(views), untracked);
    for (const Sample& sample : track) {
      Eigen::Vector2d& residual = residuals[static_cast<std::size_t>(sample.view)];
      residual = sample.error_px - mean;
      variance += sample.sigma_px * sample.sigma_px;
      constant += 0.5 * mean.squaredNorm();
      varying += 0.5 * residual.squaredNorm();
      ++count;
    }
    for (std::size_t k = 0; k < kLags.size(); ++k) {
      for (std::size_t i = static_cast<std::size_t>(kLags[k]); i < residuals.size(); ++i) {
        const double lag_product =
            0.5 * residuals[i].dot(residuals[i - static_cast<std::size_t>(kLags[k])]);
        if (!std::isfinite(lag_product)) continue;
        product[k] += lag_product;
        ++pairs[k];
      }
    }
  }
  fmt::print(
      "all: estimated sigma {:.4f} px; rms {:.4f} px, constant {:.4f}, varying {:.4f}, correlated "
      "after",
      std::sqrt(variance / count), std::sqrt((constant + varying) / count),
      std::sqrt(constant / count), std::sqrt(varying / count));
  for (std::size_t k = 0; k < kLags.size(); ++k) {
    fmt::print(" {} views: {:.2f}", kLags[k], product[k] / pairs[k] / (varying / count));
  }
  fmt::print("\n");
}

// Errors by fifth of the views: patch scale grows with the advance.
void print_by_fifth(const SamplesOfFeature& samples, const Options& options) {
  fmt::print("{:>10}{:>10}{:>10}{:>14}{:>12}\n", "advance, m", "samples", "rms, px",
             "sigma rms, px", "chi square");
  for (int fifth = 0; fifth < 5; ++fifth) {
    double square = 0, variance = 0, chi_square = 0;
    int count = 0;
    for (const auto& [feature, views] : samples) {
      for (const Sample& sample : views) {
        if (5 * sample.view / options.views != fifth) continue;
        square += 0.5 * sample.error_px.squaredNorm();
        variance += sample.sigma_px * sample.sigma_px;
        chi_square += sample.chi_square;
        ++count;
      }
    }
    if (count == 0) continue;
    fmt::print("{:>10.2f}{:>10}{:>10.4f}{:>14.4f}{:>12.2f}\n",
               options.advance_m * (fifth + 0.5) / 5, count, std::sqrt(square / count),
               std::sqrt(variance / count), chi_square / count);
  }
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Feature tracking error in a rendered hover, compared with the tracker's covariance");
  app.option_defaults()->always_capture_default();
  app.add_option("--scene", options.scene, "scene: room or coast")
      ->check(CLI::IsMember({"room", "coast"}));
  app.add_option("--seed", options.seed, "seed of scene and noise");
  app.add_option("--views", options.views, "number of images at 30 Hz")
      ->check(CLI::Range(40, 100000));
  app.add_option("--way-m", options.sway_m, "amplitude of the sway along each axis, m");
  app.add_option("--ahead-m", options.advance_m, "advance towards the scene over all views, m");
  app.add_option("--noise-grey", options.noise_grey,
                 "standard deviation of the pixel noise, grey values");
  app.add_option("--contrast-ratio", options.contrast_ratio,
                 "ratio of the scene contrast left by haze");
  app.add_option("--jpeg-quality", options.jpeg_quality, "JPEG quality; 0: no compression");
  CLI11_PARSE(app, argc, argv);

  cv::setNumThreads(1);
  SwayingCamera camera(options);
  SamplesOfFeature samples;
  for (int i = 0; i < options.views; ++i) camera.collect(i, samples);
  print_by_sigma(samples);
  print_by_fifth(samples, options);
  if (options.advance_m == 0) print_over_time(samples, options.views);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
