#include "app/inertial_messages.hpp"

#include <fmt/core.h>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

std::string message_of(const InertialFinding& finding, const RunConfig& config) {
  const Eigen::Vector3d& value = finding.value;
  switch (finding.fault) {
    case InertialFault::clock:
      return fmt::format(
          "imu: its clock is {:+.1f} ms from the images' (sigma {:.1f} ms), compensated; set "
          "imu.time_offset_s to {:.4f}",
          1e3 * value.x(), 1e3 * finding.sigma.x(),
          config.imu.time_offset_s.value_or(0) - value.x());
    case InertialFault::camera_rotation:
      return fmt::format(
          "mount: the camera is rotated by {:.1f} degrees from its calibration relative to the "
          "IMU, compensated; calibrate the mount",
          finding.change.norm() / kDegree);
    case InertialFault::lever_arm:
      return fmt::format(
          "mount: the camera is at ({:.3f}, {:.3f}, {:.3f}) m in the body, {:.0f} mm from its "
          "calibration, compensated; set mount.position_m",
          value.x(), value.y(), value.z(), 1e3 * finding.change.norm());
    case InertialFault::accelerometer:
      return fmt::format(
          "imu: the images require an accelerometer bias of ({:.2f}, {:.2f}, {:.2f}) m/s^2, which "
          "no intact sensor has; check its axes (imu.rotation_wxyz), scale and calibration",
          value.x(), value.y(), value.z());
    case InertialFault::axes:
      return fmt::format(
          "imu: the images require a camera that is rotated by {:.0f} degrees from its calibration "
          "relative to the IMU; check the IMU's axes (imu.rotation_wxyz) and the mount",
          finding.change.norm() / kDegree);
    case InertialFault::contradiction:
      return "imu: no motion explains images and IMU; check the IMU's axes (imu.rotation_wxyz), "
             "the "
             "mount, the clock (imu.time_offset_s) and the camera's calibration";
  }
  return {};
}

}  // namespace

std::vector<std::string> inertial_messages(std::span<const InertialFinding> findings,
                                           const RunConfig& config) {
  std::vector<std::string> messages;
  messages.reserve(findings.size());
  for (const InertialFinding& finding : findings) messages.push_back(message_of(finding, config));
  return messages;
}

}  // namespace stillkite
