#include "io/results/estimates_csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

constexpr const char* kHeader =
    "#timestamp [ns],frame,verdict,"
    "x [m],y [m],z [m],qw [],qx [],qy [],qz [],"
    "yaw [rad],pitch [rad],roll [rad],"
    "vx_world [m/s],vy_world [m/s],vz_world [m/s],"
    "vx_camera [m/s],vy_camera [m/s],vz_camera [m/s],"
    "wx_camera [rad/s],wy_camera [rad/s],wz_camera [rad/s],"
    "measured_vx_camera [m/s],measured_vy_camera [m/s],measured_vz_camera [m/s],"
    "measured_wx_camera [rad/s],measured_wy_camera [rad/s],measured_wz_camera [rad/s],"
    "sd_x [m],sd_y [m],sd_z [m],sd_rx_world [rad],sd_ry_world [rad],sd_rz_world [rad],"
    "sd_vx_camera [m/s],sd_vy_camera [m/s],sd_vz_camera [m/s],"
    "sd_wx_camera [rad/s],sd_wy_camera [rad/s],sd_wz_camera [rad/s],"
    "scale,scale_age [s],new_keyframe,"
    "windows,inlier_ratio [],mean_flow [px],residual [px],condition [],"
    "reference_stamp [ns],reference_model,displacement,"
    "reference_dx [],reference_dy [],reference_dz [],"
    "reference_qw [],reference_qx [],reference_qy [],reference_qz [],parallax [rad],source,"
    "x_in_heights [],y_in_heights [],z_in_heights [],"
    "vx_world_in_heights [1/s],vy_world_in_heights [1/s],vz_world_in_heights [1/s],"
    "vx_camera_in_heights [1/s],vy_camera_in_heights [1/s],vz_camera_in_heights [1/s],"
    "sd_x_in_heights [],sd_y_in_heights [],sd_z_in_heights [],"
    "sd_vx_camera_in_heights [1/s],sd_vy_camera_in_heights [1/s],sd_vz_camera_in_heights [1/s]";

class Row {
 public:
  Row& number(double value) {
    separate();
    fmt::format_to(std::back_inserter(text_), "{:.9g}", value);
    return *this;
  }
  Row& whole(std::int64_t value) {
    separate();
    fmt::format_to(std::back_inserter(text_), "{}", value);
    return *this;
  }
  Row& word(std::string_view value) {
    separate();
    text_ += value;
    return *this;
  }
  Row& numbers(const auto& values) {
    for (const double value : values) number(value);
    return *this;
  }
  // Empty cells if the values are unknown.
  Row& numbers_if(bool known, const auto& values) {
    for (const double value : values) known ? number(value) : word("");
    return *this;
  }
  [[nodiscard]] std::string line() && { return std::move(text_ += '\n'); }

 private:
  void separate() {
    if (!text_.empty()) text_ += ',';
  }
  std::string text_;
};

Vector6d deviations(const Matrix6d& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

// Pose of the camera relative to the reference image, in the reference's camera frame. Displacement
// in metres if metric, else a unit vector.
void add_reference(Row& row, const std::optional<ReferenceReport>& report) {
  constexpr int kCells = 11;
  if (!report) {
    for (int i = 0; i < kCells; ++i) row.word("");
    return;
  }
  const MotionEstimate& motion = report->motion;
  const Eigen::Quaterniond& q = motion.reference_from_camera;
  row.whole(report->reference_stamp.ns).word(name_of(report->model));
  row.word(name_of(motion.displacement_kind)).numbers(motion.displacement_in_reference);
  row.number(q.w()).numbers(q.vec()).number(motion.parallax_rad);
}

}  // namespace

std::string estimates_csv_header() {
  std::string header = kHeader;
  for (const auto& [stage, name] : EnumNames<Stage>::value) header += fmt::format(",{} [ms]", name);
  return header + '\n';
}

std::string estimates_csv_row(const NavigationEstimate& e) {
  const Eigen::Quaterniond& q = e.world_from_body.rotation;
  const EulerAngles angles = to_euler(q);
  Row row;
  row.whole(e.stamp.ns).whole(e.frame_index).word(name_of(e.verdict));
  const bool is_metric = e.scale != ScaleSource::none;
  const Vector6d pose_sd = deviations(e.pose_covariance);
  const Vector6d twist_sd = deviations(e.twist_covariance);
  const Eigen::Vector3d& position = e.world_from_body.translation;
  const Eigen::Vector3d& velocity_in_camera = e.twist_in_camera.velocity_m_s;
  row.numbers_if(is_metric, position).number(q.w()).numbers(q.vec());
  row.number(angles.yaw_rad).number(angles.pitch_rad).number(angles.roll_rad);
  row.numbers_if(is_metric, e.velocity_in_world_m_s);
  row.numbers_if(is_metric, velocity_in_camera).numbers(e.twist_in_camera.angular_rate_rad_s);
  const Vector6d measured = e.measured_twist.value_or(Twist()).vector();
  row.numbers_if(e.measured_twist && is_metric, measured.head<3>());
  row.numbers_if(e.measured_twist.has_value(), measured.tail<3>());
  row.numbers_if(is_metric, pose_sd.head<3>()).numbers(pose_sd.tail<3>());
  row.numbers_if(is_metric, twist_sd.head<3>()).numbers(twist_sd.tail<3>());
  row.word(name_of(e.scale)).number(e.scale_age_s).whole(e.new_keyframe ? 1 : 0);
  row.whole(e.quality.flow_vectors).number(e.quality.inlier_ratio).number(e.quality.mean_flow_px);
  row.number(e.quality.residual_px).number(e.quality.condition);
  add_reference(row, e.reference);
  row.word(name_of(e.source));
  row.numbers_if(is_in_heights(e), position).numbers_if(is_in_heights(e), e.velocity_in_world_m_s);
  row.numbers_if(is_in_heights(e), velocity_in_camera);
  row.numbers_if(is_in_heights(e), pose_sd.head<3>());
  row.numbers_if(is_in_heights(e), twist_sd.head<3>());
  row.numbers(e.stage_ms);
  return std::move(row).line();
}

}  // namespace stillkite
