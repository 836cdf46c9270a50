#include "io/report/report_series.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"

namespace stillkite {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};

/// Columns, extended by one value per frame.
class Table {
 public:
  void add(std::string_view name, double value) {
    series_[std::string(name)].push_back(static_cast<float>(value));
  }
  void add(std::string_view name, std::string_view unit, const Eigen::Vector3d& value) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      add(std::string(name) + "_" + std::string(kAxes[axis]) + "_" + std::string(unit),
          value(static_cast<Eigen::Index>(axis)));
    }
  }
  ReportSeries take() { return std::move(series_); }

 private:
  ReportSeries series_;
};

Eigen::Vector3d nan_vector() {
  return Eigen::Vector3d::Constant(kNaN);
}

Eigen::Vector3d standard_deviation(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

/// (roll, pitch, yaw) in degrees, each within 180 deg of `near_deg`.
Eigen::Vector3d angles_deg(const Eigen::Quaterniond& world_from_body,
                           const Eigen::Vector3d& near_deg) {
  const EulerAngles angles = to_euler(world_from_body);
  const Eigen::Vector3d wrapped =
      Eigen::Vector3d(angles.roll_rad, angles.pitch_rad, angles.yaw_rad) / kDegree;
  if (!near_deg.allFinite()) return wrapped;
  return near_deg + (wrapped - near_deg).unaryExpr([](double difference_deg) {
    return wrap_angle_rad(difference_deg * kDegree) / kDegree;
  });
}

void add_angles(Table& table, std::string_view name, const Eigen::Vector3d& degrees) {
  static constexpr std::array<std::string_view, 3> kAngles{"roll", "pitch", "yaw"};
  for (std::size_t i = 0; i < 3; ++i) {
    table.add(std::string(kAngles[i]) + std::string(name) + "_deg",
              degrees(static_cast<Eigen::Index>(i)));
  }
}

void add_state(Table& table, const NavigationEstimate& estimate,
               const Eigen::Quaterniond& world_from_camera) {
  const Matrix6d& P = estimate.pose_covariance;
  const Eigen::Matrix3d R = world_from_camera.toRotationMatrix();
  table.add("position", "m", estimate.world_from_body.translation);
  table.add("position_sigma", "m", standard_deviation(P.topLeftCorner<3, 3>()));
  table.add("attitude_sigma", "deg", standard_deviation(P.bottomRightCorner<3, 3>()) / kDegree);
  table.add("velocity", "m_s", estimate.velocity_in_world_m_s);
  // the prior covariance of the first frame would dominate the scale of the chart
  const Eigen::Matrix3d velocity_covariance =
      R * estimate.twist_covariance.topLeftCorner<3, 3>() * R.transpose();
  table.add("velocity_sigma", "m_s",
            estimate.verdict == Verdict::first_frame ? nan_vector()
                                                     : standard_deviation(velocity_covariance));
}

void add_errors(Table& table, const NavigationEstimate& estimate,
                const std::optional<RigidTransform>& truth, const Eigen::Vector3d& true_position,
                const Eigen::Vector3d& true_velocity) {
  const RigidTransform& pose = estimate.world_from_body;
  table.add("position_true", "m", true_position);
  table.add("position_error", "m", pose.translation - true_position);
  table.add("attitude_error", "deg",
            truth ? (so3_log(pose.rotation * truth->rotation.conjugate()) / kDegree).eval()
                  : nan_vector());
  table.add("velocity_true", "m_s", true_velocity);
  table.add("velocity_error", "m_s", estimate.velocity_in_world_m_s - true_velocity);
}

void add_quality(Table& table, const NavigationEstimate& estimate) {
  const bool measured = estimate.verdict != Verdict::first_frame;
  const FlowQuality& quality = estimate.quality;
  table.add("inliers_percent", measured ? 100 * quality.inlier_ratio : kNaN);
  table.add("residual_px", measured ? quality.residual_px : kNaN);
  table.add("windows", measured ? quality.flow_vectors : kNaN);
  table.add("flow_px", measured ? quality.mean_flow_px : kNaN);
  table.add("condition", measured && quality.condition > 0 ? quality.condition : kNaN);
  for (const auto& [stage, name] : EnumNames<Stage>::value) {
    table.add(std::string(name) + "_ms", estimate.stage_ms[static_cast<std::size_t>(stage)]);
  }
}

/// Mean velocity between two true positions; NaN without both.
Eigen::Vector3d true_velocity(const ReportContent& content, std::size_t i) {
  if (i == 0 || !is_in_metres(content.estimates) || !content.truth[i] || !content.truth[i - 1]) {
    return nan_vector();
  }
  const double dt_s = seconds_between(content.estimates[i - 1].stamp, content.estimates[i].stamp);
  if (!(dt_s > 0)) return nan_vector();
  return (content.truth[i]->translation - content.truth[i - 1]->translation) / dt_s;
}

}  // namespace

ReportSeries report_series(const ReportContent& content) {
  Table table;
  Eigen::Vector3d angles = nan_vector();
  for (std::size_t i = 0; i < content.estimates.size(); ++i) {
    const NavigationEstimate& estimate = content.estimates[i];
    const Eigen::Quaterniond& attitude = estimate.world_from_body.rotation;
    table.add("time_s", seconds_between(content.estimates.front().stamp, estimate.stamp));
    add_state(table, estimate, attitude * content.body_from_camera.rotation);
    const Eigen::Vector3d unwrapped = angles_deg(attitude, angles);
    add_angles(table, "", unwrapped);
    if (unwrapped.allFinite()) angles = unwrapped;
    if (!content.truth.empty()) {
      const std::optional<RigidTransform>& truth = content.truth[i];
      const bool has_position = truth && is_in_metres(content.estimates);
      add_errors(table, estimate, truth, has_position ? truth->translation : nan_vector(),
                 true_velocity(content, i));
      add_angles(table, "_true", truth ? angles_deg(truth->rotation, unwrapped) : nan_vector());
    }
    add_quality(table, estimate);
  }
  return table.take();
}

std::vector<VerdictInterval> verdict_intervals(std::span<const NavigationEstimate> estimates) {
  std::vector<VerdictInterval> intervals;
  for (const NavigationEstimate& estimate : estimates) {
    const double t_s = seconds_between(estimates.front().stamp, estimate.stamp);
    if (!intervals.empty()) intervals.back().end_s = t_s;
    if (intervals.empty() || intervals.back().verdict != estimate.verdict) {
      intervals.push_back({.verdict = estimate.verdict, .start_s = t_s, .end_s = t_s});
    }
  }
  return intervals;
}

nlohmann::json verdict_intervals_json(std::span<const NavigationEstimate> estimates) {
  nlohmann::json intervals = nlohmann::json::array();
  for (const VerdictInterval& interval : verdict_intervals(estimates)) {
    intervals.push_back({name_of(interval.verdict), interval.start_s, interval.end_s});
  }
  return intervals;
}

bool is_in_metres(std::span<const NavigationEstimate> estimates) {
  return !estimates.empty() && estimates.back().scale != ScaleSource::none;
}

}  // namespace stillkite
