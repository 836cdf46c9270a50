#include "app/flight_files.hpp"

#include <fmt/format.h>

#include <iterator>

#include "io/dataset/calibration_file.hpp"
#include "io/dataset/trajectory_file.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

std::string print_vector(const Eigen::Vector3d& v) {
  return fmt::format("{:.9f},{:.9f},{:.9f}", v.x(), v.y(), v.z());
}

std::string camera_yaml(const FlightRecord& flight, double frames_per_s) {
  const bool is_rational = flight.camera.distortion == DistortionModel::radial_tangential;
  return calibration_yaml({.camera = flight.camera,
                           .coefficients = is_rational ? 8 : 4,
                           .comment = "simulated",
                           .body_from_camera = flight.body_from_camera,
                           .rate_hz = frames_per_s});
}

// Pose and velocity in the world, without EuRoC's IMU bias columns.
std::string truth_csv(const FlightRecord& flight) {
  std::string out =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1]\n";
  for (const StampedState& at : flight.truth) {
    const Eigen::Quaterniond& q = at.state.world_from_body.rotation;
    fmt::format_to(std::back_inserter(out), "{},{},{:.12f},{:.12f},{:.12f},{:.12f},{}\n",
                   at.stamp.ns, print_vector(at.state.world_from_body.translation), q.w(), q.x(),
                   q.y(), q.z(), print_vector(at.state.velocity_in_world_m_s));
  }
  return out;
}

std::string truth_tum(const FlightRecord& flight) {
  std::string out = kTumHeader;
  for (const StampedState& at : flight.truth) {
    out += tum_line({at.stamp, at.state.world_from_body});
  }
  return out;
}

// Row: velocity half way between the previous frame and this one, in the camera frame.
std::string velocity_csv(const FlightRecord& flight) {
  std::string out = "#timestamp [ns],vx,vy,vz [m/s camera frame],wx,wy,wz [rad/s camera frame]\n";
  for (const StampedTwist& row : flight.twists_in_camera) {
    fmt::format_to(std::back_inserter(out), "{},{},{}\n", row.stamp.ns,
                   print_vector(row.twist.velocity_m_s),
                   print_vector(row.twist.angular_rate_rad_s));
  }
  return out;
}

std::string imu_csv(const FlightRecord& flight) {
  std::string out =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuReading& reading : flight.imu) {
    fmt::format_to(std::back_inserter(out), "{},{},{}\n", reading.stamp.ns,
                   print_vector(reading.angular_rate_in_body_rad_s),
                   print_vector(reading.specific_force_in_body_m_s2));
  }
  return out;
}

std::string range_csv(const FlightRecord& flight) {
  std::string out = "#timestamp [ns],range [m]\n";
  for (const RangeReading& reading : flight.range) {
    fmt::format_to(std::back_inserter(out), "{},{:.6f}\n", reading.stamp.ns, reading.range_m);
  }
  return out;
}

}  // namespace

void write_flight_files(const FlightRecord& flight, double frames_per_s,
                        const std::filesystem::path& top, const std::filesystem::path& dataset,
                        const std::filesystem::path& camera_folder) {
  const auto truth_folder = dataset / "state_groundtruth_estimate0";
  for (const auto& folder : {camera_folder, truth_folder, dataset / "imu0"}) {
    std::filesystem::create_directories(folder);
  }
  write_file(camera_folder / "sensor.yaml", camera_yaml(flight, frames_per_s));
  write_file(truth_folder / "data.csv", truth_csv(flight));
  write_file(dataset / "imu0" / "data.csv", imu_csv(flight));
  write_file(top / "truth.tum", truth_tum(flight));
  write_file(top / "velocity.csv", velocity_csv(flight));
  if (!flight.range.empty()) write_file(top / "range.csv", range_csv(flight));
}

}  // namespace stillkite
