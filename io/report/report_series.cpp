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
constexpr std::size_t kMaxBlocks = 4000;

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

/// Lengths in heights have no metric truth.
void remove_true_lengths(ReportSeries& series) {
  for (auto& [name, values] : series) {
    for (const std::string_view length :
         {"position_true", "position_error", "velocity_true", "velocity_error", "speed_true"}) {
      if (name.starts_with(length)) std::ranges::fill(values, static_cast<float>(kNaN));
    }
  }
}

}  // namespace

ChartRecorder::ChartRecorder(bool has_truth, const RigidTransform& body_from_camera)
    : has_truth_(has_truth),
      body_from_camera_(body_from_camera),
      columns_(kMaxBlocks),
      norms_(kMaxBlocks),
      angles_deg_(nan_vector()) {}

void ChartRecorder::add_vector(const char* name, const char* unit, const Eigen::Vector3d& value) {
  columns_.add({name, "_x_", unit}, value.x());
  columns_.add({name, "_y_", unit}, value.y());
  columns_.add({name, "_z_", unit}, value.z());
}

void ChartRecorder::add_angles(const char* name, const Eigen::Vector3d& degrees) {
  columns_.add({"roll", name, "_deg"}, degrees.x());
  columns_.add({"pitch", name, "_deg"}, degrees.y());
  columns_.add({"yaw", name, "_deg"}, degrees.z());
}

void ChartRecorder::add_state(const NavigationEstimate& estimate) {
  const Matrix6d& P = estimate.pose_covariance;
  const Eigen::Quaterniond& attitude = estimate.world_from_body.rotation;
  const Eigen::Matrix3d R = (attitude * body_from_camera_.rotation).toRotationMatrix();
  add_vector("position", "m", estimate.world_from_body.translation);
  add_vector("position_sigma", "m", standard_deviation(P.topLeftCorner<3, 3>()));
  add_vector("attitude_sigma", "deg", standard_deviation(P.bottomRightCorner<3, 3>()) / kDegree);
  add_vector("velocity", "m_s", estimate.velocity_in_world_m_s);
  norms_.add({"speed_m_s"}, estimate.velocity_in_world_m_s.norm());
  // the prior covariance of the first frame would dominate the scale of the chart
  const Eigen::Matrix3d velocity_covariance =
      R * estimate.twist_covariance.topLeftCorner<3, 3>() * R.transpose();
  add_vector("velocity_sigma", "m_s",
             estimate.verdict == Verdict::first_frame ? nan_vector()
                                                      : standard_deviation(velocity_covariance));
}

/// Mean velocity between two true positions; NaN without both.
Eigen::Vector3d ChartRecorder::true_velocity(Timestamp stamp, const TrueState& truth) const {
  if (truth.velocity_in_world_m_s) return *truth.velocity_in_world_m_s;
  const double dt_s = seconds_between(previous_stamp_, stamp);
  if (!truth.position_m || !previous_true_position_m_ || !(dt_s > 0)) return nan_vector();
  return (*truth.position_m - *previous_true_position_m_) / dt_s;
}

void ChartRecorder::add_truth(const NavigationEstimate& estimate, const TrueState& truth) {
  const RigidTransform& pose = estimate.world_from_body;
  const Eigen::Vector3d position = truth.position_m.value_or(nan_vector());
  const Eigen::Vector3d velocity = true_velocity(estimate.stamp, truth);
  const Eigen::Vector3d position_error = pose.translation - position;
  const Eigen::Vector3d velocity_error = estimate.velocity_in_world_m_s - velocity;
  Eigen::Vector3d attitude_error_deg = nan_vector();
  Eigen::Vector3d angles_true_deg = nan_vector();
  if (truth.world_from_body) {
    attitude_error_deg = so3_log(pose.rotation * truth.world_from_body->conjugate()) / kDegree;
    angles_true_deg = angles_deg(*truth.world_from_body, angles_deg_);
  }
  add_vector("position_true", "m", position);
  add_vector("position_error", "m", position_error);
  add_vector("attitude_error", "deg", attitude_error_deg);
  add_vector("velocity_true", "m_s", velocity);
  add_vector("velocity_error", "m_s", velocity_error);
  add_angles("_true", angles_true_deg);
  norms_.add({"speed_true_m_s"}, velocity.norm());
  norms_.add({"position_error_m"}, position_error.norm());
  norms_.add({"velocity_error_m_s"}, velocity_error.norm());
  norms_.add({"attitude_error_deg"}, attitude_error_deg.norm());
}

void ChartRecorder::add_quality(const NavigationEstimate& estimate) {
  const bool measured = estimate.verdict != Verdict::first_frame;
  const FlowQuality& quality = estimate.quality;
  columns_.add({"inliers_percent"}, measured ? 100 * quality.inlier_ratio : kNaN);
  columns_.add({"residual_px"}, measured ? quality.residual_px : kNaN);
  columns_.add({"windows"}, measured ? quality.flow_vectors : kNaN);
  columns_.add({"flow_px"}, measured ? quality.mean_flow_px : kNaN);
  columns_.add({"condition"}, measured && quality.condition > 0 ? quality.condition : kNaN);
  for (const auto& [stage, name] : EnumNames<Stage>::value) {
    columns_.add({name, "_ms"}, estimate.stage_ms[static_cast<std::size_t>(stage)]);
  }
}

void ChartRecorder::add(const NavigationEstimate& estimate, const TrueState& truth) {
  if (!first_stamp_) first_stamp_ = estimate.stamp;
  const double t_s = seconds_between(*first_stamp_, estimate.stamp);
  columns_.add({"time_s"}, t_s);
  add_state(estimate);
  const Eigen::Vector3d unwrapped = angles_deg(estimate.world_from_body.rotation, angles_deg_);
  add_angles("", unwrapped);
  if (unwrapped.allFinite()) angles_deg_ = unwrapped;
  if (has_truth_) add_truth(estimate, truth);
  add_quality(estimate);
  columns_.end_frame();
  norms_.end_frame();

  if (!verdicts_.empty()) verdicts_.back().end_s = t_s;
  if (verdicts_.empty() || verdicts_.back().verdict != estimate.verdict) {
    verdicts_.push_back({.verdict = estimate.verdict, .start_s = t_s, .end_s = t_s});
  }
  previous_stamp_ = estimate.stamp;
  previous_true_position_m_ = truth.position_m;
  scale_ = estimate.scale;
}

FlightCharts ChartRecorder::charts() const {
  FlightCharts charts{.columns = columns_.extremes(),
                      .norms = norms_.extremes(),
                      .verdicts = verdicts_,
                      .frames = columns_.frames(),
                      .has_truth = has_truth_ && columns_.frames() > 0,
                      .is_metric = scale_ != ScaleSource::none};
  ReportSeries samples = columns_.samples();
  for (const char* name :
       {"time_s", "position_x_m", "position_y_m", "position_true_x_m", "position_true_y_m"}) {
    if (auto column = samples.extract(name)) charts.path.insert(std::move(column));
  }
  if (charts.is_metric) return charts;
  for (ReportSeries* series : {&charts.columns, &charts.norms, &charts.path}) {
    remove_true_lengths(*series);
  }
  return charts;
}

nlohmann::json verdict_intervals_json(const FlightCharts& charts) {
  nlohmann::json intervals = nlohmann::json::array();
  for (const VerdictInterval& interval : charts.verdicts) {
    intervals.push_back({name_of(interval.verdict), interval.start_s, interval.end_s});
  }
  return intervals;
}

}  // namespace stillkite
