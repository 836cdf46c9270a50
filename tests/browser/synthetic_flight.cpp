#include "tests/browser/synthetic_flight.hpp"

#include <cmath>
#include <random>

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

constexpr double kDuration = 150;  // s

RigidTransform pose_at(double t_s) {
  const double s = t_s / kDuration;
  const EulerAngles angles{.yaw_rad = 0.2 * std::sin(3 * s) + 0.01 * std::sin(0.9 * t_s),
                           .pitch_rad = 0.02 * std::sin(0.7 * t_s) + 0.01 * std::sin(2.3 * t_s),
                           .roll_rad = 0.015 * std::sin(0.5 * t_s + 1)};
  return {.rotation = to_quaternion(angles),
          .translation = {1000 * s, 100 * (s - std::sin(6.28 * s) / 6.28) + 6 * std::sin(12 * s),
                          400 - 50 * s * s * (3 - 2 * s)}};
}

Verdict verdict_at(int i, int frames) {
  if (i == 0) return Verdict::first_frame;
  const double s = static_cast<double>(i) / frames;
  if (s > 0.41 && s < 0.425) return Verdict::too_little_texture;
  if (s > 0.425 && s < 0.43) return Verdict::lost;
  if (s > 0.7 && s < 0.703) return Verdict::frozen;
  if (i == frames * 9 / 10) return Verdict::too_few_inliers;
  return Verdict::ok;
}

}  // namespace

SyntheticFlight synthetic_flight(int frames) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  SyntheticFlight flight;
  const double dt_s = kDuration / frames;
  for (int i = 0; i < frames; ++i) {
    const double t_s = i * dt_s;
    const double s = t_s / kDuration;
    const RigidTransform truth = pose_at(t_s);
    const Verdict verdict = verdict_at(i, frames);
    const bool ok = verdict == Verdict::ok;
    const double sigma_m_s = ok ? 0.05 : 0.4;
    NavigationEstimate estimate{.stamp = from_seconds(10 + t_s), .frame_index = i};
    estimate.verdict = verdict;
    estimate.world_from_body = {
        .rotation = so3_exp(noise(1e-4) + s * Eigen::Vector3d(1e-4, -2e-4, 5e-4)) * truth.rotation,
        .translation =
            truth.translation + s * Eigen::Vector3d(0.3, -0.15 * std::sin(t_s / 20), 0.1)};
    estimate.velocity_in_world_m_s =
        (truth.translation - pose_at(t_s - dt_s).translation) / dt_s + noise(sigma_m_s);
    estimate.twist_covariance.diagonal().head<3>().setConstant(sigma_m_s * sigma_m_s);
    estimate.pose_covariance.diagonal().head<3>().setConstant(0.02 * s + 1e-6);
    estimate.pose_covariance.diagonal().tail<3>().setConstant(1e-7 * s + 1e-8);
    estimate.scale = ScaleSource::initial_height;
    estimate.quality = {.flow_vectors = static_cast<int>(6800 + 60 * normal(random)),
                        .inlier_ratio = ok ? 0.97 - 0.01 * std::abs(normal(random)) : 0.2,
                        .mean_flow_px = 1.2 + 0.3 * std::sin(t_s),
                        .residual_px = 0.06 + 0.004 * normal(random),
                        .condition = 140 + 20 * std::sin(t_s / 3)};
    estimate.stage_ms = {0.3 + 0.02 * std::abs(normal(random)),
                         1.5 + 0.1 * std::abs(normal(random)),
                         0.2 + 0.03 * std::abs(normal(random)), 0.01};
    flight.estimates.push_back(estimate);
    flight.truth.emplace_back(truth);
  }
  flight.config_yaml =
      "seed: 1\nsource:\n  path: flight.mp4\n  start_s: 10\n  end_s: 160\n"
      "initial:\n  height_m: 400\nestimator:\n  policy: flow\n  mode: recommended\n";
  return flight;
}

nlohmann::json synthetic_summary(const SyntheticFlight& flight) {
  const std::vector<NavigationEstimate>& estimates = flight.estimates;
  nlohmann::json verdicts = nlohmann::json::object();
  for (const NavigationEstimate& estimate : estimates) {
    nlohmann::json& count = verdicts[std::string(name_of(estimate.verdict))];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  const auto nees = [](double mean, double inside) {
    return nlohmann::json{
        {"mean", mean}, {"degrees_of_freedom", 3}, {"samples", 3700}, {"share_inside", inside}};
  };
  return {{"frames", {{"read", estimates.size()}, {"used", estimates.size()}, {"rejected", 0}}},
          {"verdicts", verdicts},
          {"timing",
           {{"frame_ms", {{"median", 2.14}, {"p99", 3.02}}},
            {"stages_ms", {{"pyramid", 0.31}, {"flow", 1.5}, {"solve", 0.2}, {"filter", 0.02}}},
            {"frames_per_s", 141.7}}},
          {"memory", {{"peak_rss_mib", 96.4}}},
          {"scale", {{"source", "initial_height"}, {"age_s", kDuration}}},
          {"evaluation",
           {{"matched", estimates.size()},
            {"path_length_m", 1013.24},
            {"position_rmse_m", 0.1834},
            {"end_error_horizontal_m", 0.312},
            {"end_error_vertical_m", 0.1021},
            {"drift_percent", 0.0324},
            {"velocity_rmse_m_s", {0.061, 0.055, 0.023}},
            {"velocity_median_abs_error_m_s", {0.041, 0.037, 0.015}},
            {"velocity_correlation", {0.9991, 0.9978, 0.9569}},
            {"angular_rate_rmse_rad_s", {0.00021, 0.00019, 0.00008}},
            {"angular_rate_median_abs_error_rad_s", {0.00014, 0.00013, 0.00005}},
            {"angular_rate_correlation", {0.9999, 0.9999, nullptr}},
            {"tilt_rmse_rad", 0.00021},
            {"yaw_rmse_rad", 0.0004},
            {"nees", {{"position", nees(2.8, 0.96)}, {"velocity", nees(3.4, 0.93)}}}}}};
}

ReportContent SyntheticFlight::content(const std::string& title, bool with_truth) const {
  return {.title = title,
          .charts = with_truth ? recorded_charts(estimates, truth) : recorded_charts(estimates, {}),
          .config_yaml = config_yaml};
}

FlightCharts recorded_charts(std::span<const NavigationEstimate> estimates,
                             std::span<const std::optional<RigidTransform>> truth,
                             const RigidTransform& body_from_camera) {
  ChartRecorder recorder(!truth.empty(), body_from_camera);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    TrueState state;
    if (!truth.empty() && truth[i]) {
      state = {.position_m = truth[i]->translation, .world_from_body = truth[i]->rotation};
    }
    recorder.add(estimates[i], state);
  }
  return recorder.charts();
}

}  // namespace stillkite
