#include "tests/browser/synthetic_trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

namespace stillkite {
namespace {

constexpr double kSpeed_m_s = 0.2;
constexpr double kFramesPerSecond = 30;
constexpr double kDegreesPerRadian = 57.29577951308232;

double reach_m(int axis) {
  return axis == 1 ? 0.87 : 2.0;
}

/// Triangle wave: 0, +reach, -reach, 0.
double station_offset_m(int axis, double t_s) {
  const double s = kSpeed_m_s * t_s / reach_m(axis);
  if (s < 1) return reach_m(axis) * s;
  return reach_m(axis) * (s < 3 ? 2 - s : s - 4);
}

/// Paper axes x, y, z = world axes x, z, -y.
Eigen::Vector3d in_world(const Eigen::Vector3d& paper) {
  return {paper.x(), -paper.z(), paper.y()};
}

/// JPEG of a wall with a window, shifted by the displacement and yaw.
std::vector<std::uint8_t> image(const Eigen::Vector3d& displacement_m, double yaw_rad) {
  cv::Mat image(96, 160, CV_8UC3);
  const int dx = static_cast<int>(std::lround(30 * displacement_m.x() + 100 * yaw_rad));
  const int dy = static_cast<int>(std::lround(30 * displacement_m.y()));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int brick = ((x + dx + 400) / 12 + (y + dy + 400) / 6) % 2;
      image.at<cv::Vec3b>(y, x) = brick != 0 ? cv::Vec3b(120, 140, 160) : cv::Vec3b(95, 110, 140);
    }
  }
  cv::rectangle(image, cv::Rect(60 - dx, 24 - dy, 44, 36), cv::Scalar(230, 210, 170), cv::FILLED);
  cv::rectangle(image, cv::Rect(0, 78 - dy, 160, 60), cv::Scalar(70, 90, 80), cv::FILLED);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, 60});
  return jpeg;
}

std::array<std::string_view, 2> decision_at(double t_s, double d_m) {
  if (t_s < 0.2) return {"hold", "no_estimate"};
  if (std::fmod(t_s, 11) > 10.7) return {"hold", "estimate_gated"};
  if (std::fmod(t_s, 6) < 0.5) return {"command", "angle_first"};
  if (std::abs(d_m) < 0.03) return {"hold", "within_dead_band"};
  return {"command", "none"};
}

HoverReportTrial trial_of(int axis, bool stabilized, int number) {
  std::mt19937_64 random(static_cast<std::uint64_t>(17 * axis + number));
  const auto uniform = [&] {
    return 2.0 * static_cast<double>(random() >> 11U) / 9007199254740992.0 - 1;
  };
  HoverReportTrial trial{.moved_axis = axis,
                         .stabilized = stabilized,
                         .policy = stabilized ? "reference" : "",
                         .seed = static_cast<std::uint64_t>(number)};
  const double duration_s = 4 * reach_m(axis) / kSpeed_m_s;
  const double phase = 3 * uniform();
  double lagged_offset_m = 0;
  Eigen::Vector3d disturbance_m = Eigen::Vector3d::Zero();
  for (int i = 0; i <= static_cast<int>(duration_s * kFramesPerSecond); ++i) {
    const double t_s = i / kFramesPerSecond;
    const double offset_m = station_offset_m(axis, t_s);
    lagged_offset_m +=
        ((stabilized ? 0.2 * offset_m + 0.08 * std::sin(1.3 * t_s + phase) : offset_m) -
         lagged_offset_m) /
        (0.5 * kFramesPerSecond);
    disturbance_m =
        0.995 * disturbance_m + 0.004 * Eigen::Vector3d(uniform(), 0.6 * uniform(), uniform());
    Eigen::Vector3d displacement_m = disturbance_m;
    displacement_m(axis) += lagged_offset_m;
    Eigen::Vector3d station_m(0, 1, 0);
    station_m(axis) += offset_m;
    const double yaw_rad = 0.05 * std::sin(0.4 * t_s + phase);
    HoverReportSample sample{
        .t_s = t_s,
        .displacement_m = displacement_m,
        .station_in_world_m = in_world(station_m),
        .drone_in_world_m = in_world(displacement_m + Eigen::Vector3d(0, 3, 0)),
        .yaw_deg = yaw_rad * kDegreesPerRadian};
    if (stabilized) {
      const auto [action, reason] = decision_at(t_s, displacement_m(axis));
      sample.action = action;
      sample.reason = reason;
    }
    trial.samples.push_back(sample);
    if (stabilized && number == 3 * axis + 1 && i % 6 == 0) {
      trial.images.push_back({t_s, image(displacement_m, yaw_rad)});
    }
  }
  return trial;
}

/// Sums over the samples of one or more trials.
struct Moments {
  double count = 0;
  double sum_m = 0;
  double sum_of_magnitudes_m = 0;
  double squares_m2 = 0;
  double max_m = 0;

  void add(const HoverReportTrial& trial) {
    for (const HoverReportSample& sample : trial.samples) {
      const double d_m = sample.displacement_m(trial.moved_axis);
      count += 1;
      sum_m += d_m;
      sum_of_magnitudes_m += std::abs(d_m);
      squares_m2 += d_m * d_m;
      max_m = std::max(max_m, std::abs(d_m));
    }
  }
  [[nodiscard]] nlohmann::json figures() const {
    const double mean_m = sum_m / count;
    return {{"mean_m", sum_of_magnitudes_m / count},
            {"std_m", std::sqrt(squares_m2 / count - mean_m * mean_m)},
            {"max_m", max_m}};
  }
};

}  // namespace

SyntheticTrials synthetic_trials() {
  SyntheticTrials result;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 4; ++i) result.trials.push_back(trial_of(axis, i < 3, 3 * axis + i + 1));
  }
  result.config_yaml =
      "seed: 1\ntrials:\n  axes: [x, y, z]\n  on: 3\n  off: 1\nestimator:\n  policy: reference\n"
      "  mode: paper\nhold:\n  mode: paper\n";
  return result;
}

nlohmann::json synthetic_hover_summary(const SyntheticTrials& trials) {
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  std::map<std::string, std::map<std::string, Moments>> table;
  nlohmann::json rows = nlohmann::json::array();
  for (const HoverReportTrial& trial : trials.trials) {
    const std::string axis = kAxes.at(static_cast<std::size_t>(trial.moved_axis));
    const std::string state = trial.stabilized ? "on" : "off";
    table[state][axis].add(trial);
    table[state]["all"].add(trial);
    Moments alone;
    alone.add(trial);
    nlohmann::json row = alone.figures();
    row.update(
        {{"axis", axis}, {"stabilization", state}, {"policy", trial.policy}, {"seed", trial.seed}});
    rows.push_back(row);
  }
  nlohmann::json figures;
  for (const auto& [state, sets] : table) {
    for (const auto& [axis, moments] : sets) figures[state][axis] = moments.figures();
  }
  return {{"table", figures}, {"trials", rows}, {"timing", {{"real_time_factor", 5.234}}}};
}

HoverReportContent SyntheticTrials::content(const std::string& title) const {
  return {.title = title, .trials = trials, .config_yaml = config_yaml};
}

}  // namespace stillkite
