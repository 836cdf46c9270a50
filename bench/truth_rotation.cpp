// Rotations of a recording's truth against those of its images: pairs of images far apart in time,
// SIFT features, essential matrix of OpenCV. No estimator takes part.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/association.hpp"
#include "geometry/median.hpp"
#include "io/config/config_node.hpp"
#include "recording.hpp"

namespace stillkite::bench {
namespace {

constexpr double kTolerance_s = 0.02;

struct Options {
  std::filesystem::path config;
  std::vector<std::string> overrides;
  double min_interval_s = 3;
  double max_rotation_rad = 0.25;  // of a pair: the views overlap
  int stride = 4;
  int min_matches = 200;
};

// Image with features on z = 1 and its true attitude.
struct View {
  Timestamp stamp;
  Eigen::Matrix3d world_from_camera;
  std::vector<std::optional<cv::Point2d>> bearings;
  cv::Mat descriptors;
};

std::vector<View> views_of(const Recording& recording, int stride) {
  constexpr int kFeatures = 1500;
  const auto detector = cv::SIFT::create(kFeatures);
  std::vector<View> views;
  for (std::size_t i = 0; i < recording.images.size(); i += static_cast<std::size_t>(stride)) {
    const RecordedImage& image = recording.images[i];
    const auto pose = pose_at(recording.poses, image.stamp, kTolerance_s);
    if (!pose) continue;
    View view{
        image.stamp, (*pose * recording.body_from_camera).rotation.toRotationMatrix(), {}, {}};
    std::vector<cv::KeyPoint> keypoints;
    detector->detectAndCompute(image.grey, cv::noArray(), keypoints, view.descriptors);
    for (const cv::KeyPoint& keypoint : keypoints) {
      const auto bearing = undistort(recording.camera, {keypoint.pt.x, keypoint.pt.y});
      view.bearings.push_back(bearing ? std::optional(cv::Point2d(bearing->x(), bearing->y()))
                                      : std::nullopt);
    }
    views.push_back(std::move(view));
  }
  return views;
}

// Rotation to the second camera from the first, by images alone.
std::optional<Eigen::Matrix3d> rotation_between_views(const View& first, const View& second,
                                                      double focal_px, int min_matches) {
  constexpr float kMaxDistanceRatio = 0.7F;  // Lowe 2004
  constexpr double kConfidence = 0.9999;
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher().knnMatch(first.descriptors, second.descriptors, matches, 2);
  std::vector<cv::Point2d> a, b;
  for (const auto& match : matches) {
    if (match.size() < 2 || match[0].distance > kMaxDistanceRatio * match[1].distance) continue;
    const auto& in_first = first.bearings[static_cast<std::size_t>(match[0].queryIdx)];
    const auto& in_second = second.bearings[static_cast<std::size_t>(match[0].trainIdx)];
    if (!in_first || !in_second) continue;
    a.push_back(*in_first);
    b.push_back(*in_second);
  }
  if (static_cast<int>(a.size()) < min_matches) return std::nullopt;
  cv::Mat inliers;
  const cv::Mat E =
      cv::findEssentialMat(a, b, 1, {0, 0}, cv::RANSAC, kConfidence, 1 / focal_px, inliers);
  if (E.rows != 3) return std::nullopt;
  cv::Mat R, t;
  if (cv::recoverPose(E, a, b, R, t, 1, {0, 0}, inliers) < min_matches) return std::nullopt;
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.ptr<double>());
}

void print_differences(const Options& options) {
  const RunConfig config = load_run_config(options.config, options.overrides);
  const Recording recording = read_recording(config);
  const std::vector<View> views = views_of(recording, options.stride);
  std::array<std::vector<double>, 3> differences_mrad;
  std::vector<double> intervals_s;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t k = i + 1; k < views.size(); ++k) {
      const double interval_s = seconds_between(views[i].stamp, views[k].stamp);
      if (interval_s < options.min_interval_s) continue;
      const Eigen::Matrix3d& first = views[i].world_from_camera;
      const Eigen::Matrix3d& second = views[k].world_from_camera;
      const Eigen::AngleAxisd turn(first.transpose() * second);
      if (turn.angle() > options.max_rotation_rad) continue;
      const auto rotation = rotation_between_views(views[i], views[k], recording.camera.focal_x_px,
                                                   options.min_matches);
      if (!rotation) continue;
      // of the second attitude, in the world
      const Eigen::AngleAxisd difference(second * (first * rotation->transpose()).transpose());
      for (int axis = 0; axis < 3; ++axis) {
        differences_mrad[static_cast<std::size_t>(axis)].push_back(1e3 * difference.angle() *
                                                                   difference.axis()[axis]);
      }
      intervals_s.push_back(interval_s);
    }
  }
  if (intervals_s.empty()) {
    fmt::print("no pair of images with {} matches\n", options.min_matches);
    return;
  }
  fmt::print("{} pairs, median interval {:.1f} s\n", intervals_s.size(), median(intervals_s));
  fmt::print("truth less images, mrad: median (median deviation)\n");
  constexpr std::array kAxes{"x", "y", "z"};
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const double middle = median(differences_mrad[axis]);
    std::vector<double> deviations;
    for (const double value : differences_mrad[axis])
      deviations.push_back(std::abs(value - middle));
    fmt::print("  {}  {:6.2f} ({:.2f})\n", kAxes[axis], middle, median(deviations));
  }
}

}  // namespace
}  // namespace stillkite::bench

int main(int argc, char** argv) {
  using stillkite::bench::Options;
  Options options;
  CLI::App app{"Rotations of a recording's truth against those of its images."};
  app.add_option("config", options.config, "configuration of a run, with truth")->required();
  app.add_option("--set", options.overrides, "KEY=VALUE; truth.path: of an estimate");
  app.add_option("--min-interval", options.min_interval_s, "of a pair, s");
  app.add_option("--stride", options.stride, "of every n images one is used")
      ->check(CLI::PositiveNumber);
  app.add_option("--min-matches", options.min_matches, "inliers of a pair");
  CLI11_PARSE(app, argc, argv);
  try {
    print_differences(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_truth_rotation: {}\n", error.what());
    return 1;
  }
  return 0;
}
