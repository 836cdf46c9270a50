#include "navigation/sensor_update.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/fusion/error_state.hpp"

namespace stillkite {
namespace {

// Kalman update by a reading of one component of the pose's error.
PoseEstimate corrected(const PoseEstimate& pose, int component, double innovation, double sigma) {
  const double S = pose.covariance(component, component) + sigma * sigma;
  const Vector6d K = pose.covariance.col(component) / S;
  const Vector6d error = K * innovation;
  Matrix6d I_KH = Matrix6d::Identity();
  I_KH.col(component) -= K;
  PoseEstimate out;
  out.world_from_camera = {
      (so3_exp(error.tail<3>()) * pose.world_from_camera.rotation).normalized(),
      pose.world_from_camera.translation + error.head<3>()};
  out.covariance = I_KH * pose.covariance * I_KH.transpose() + sigma * sigma * K * K.transpose();
  return out;
}

PoseEstimate with_height(const PoseEstimate& pose, double height_m, double sigma_m) {
  return corrected(pose, 2, height_m - pose.world_from_camera.translation.z(), sigma_m);
}

PoseEstimate with_attitude(const PoseEstimate& pose, const Eigen::Quaterniond& world_from_camera,
                           double sigma_rad) {
  // the turn that levels our vertical, whatever the two yaws, about x and then about y
  const Eigen::Vector3d up_in_camera = world_from_camera.conjugate() * Eigen::Vector3d::UnitZ();
  PoseEstimate out = pose;
  for (const int axis : {0, 1}) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(
        out.world_from_camera.rotation * up_in_camera, Eigen::Vector3d::UnitZ());
    out = corrected(out, 3 + axis, so3_log(turn)(axis), sigma_rad);
  }
  return out;
}

// Without an echo, over a roof or in rain a range finder tells anything.
bool is_far_off(double off_m, double variance_m2, double known_m) {
  constexpr double kSigmas = 5;
  constexpr double kLeast_ratio = 0.1;
  return std::abs(off_m) > std::max(kSigmas * std::sqrt(variance_m2), kLeast_ratio * known_m);
}

ScaledPose with_measured_height(const ScaledPose& before, const CameraReadings& readings,
                                const SensorConfig& config, Timestamp now) {
  constexpr int kBelievedInARow = 5;
  ScaledPose out = before;
  const double known_m = before.pose.world_from_camera.translation.z();
  double& variance_m2 = out.pose.covariance(2, 2);
  if (before.scale == ScaleSource::initial_height) {
    // a sensor outranks what was said at the start
    variance_m2 += square(config.start_height_sigma_ratio * known_m);
  }
  const double off_m = *readings.height_m - known_m;
  if (is_far_off(off_m, variance_m2 + square(config.height_sigma_m), known_m)) {
    ScaledPose refused = before;
    refused.refused_m = readings.told_m;
    const bool is_new = before.refused_heights == 0 || readings.told_m != before.refused_m;
    if (is_new) ++refused.refused_heights;
    if (refused.refused_heights < kBelievedInARow) return refused;
    variance_m2 += square(off_m);
  }
  out.pose = with_height(out.pose, *readings.height_m, config.height_sigma_m);
  out.refused_heights = 0;
  out.scale = readings.height_source;
  out.scale_stamp = now;
  return out;
}

PoseEstimate stretched(const PoseEstimate& pose, double factor) {
  PoseEstimate out = pose;
  out.world_from_camera.translation *= factor;
  out.covariance.topRows<3>() *= factor;
  out.covariance.leftCols<3>() *= factor;
  return out;
}

}  // namespace

CameraReadings of_camera(const SensorReadings& readings, const RigidTransform& body_from_camera,
                         const Eigen::Quaterniond& world_from_camera) {
  CameraReadings out{.height_source = readings.height_source};
  if (readings.height_m) {
    out.told_m = *readings.height_m;
    const Eigen::Vector3d body_in_camera = body_from_camera.inverse().translation;
    const Eigen::Quaterniond world_from_body =
        world_from_camera * body_from_camera.rotation.conjugate();
    out.height_m = height_of_body_m(*readings.height_m, readings.height_source, world_from_body) -
                   (world_from_camera * body_in_camera).z();
  }
  if (readings.attitude) out.attitude = *readings.attitude * body_from_camera.rotation;
  return out;
}

ScaledPose with_readings(const ScaledPose& before, const CameraReadings& readings,
                         const SensorConfig& config, Timestamp now) {
  ScaledPose out = before;
  if (readings.height_m && *readings.height_m > 0) {
    if (before.scale == ScaleSource::none) {
      out.pose =
          stretched(out.pose, *readings.height_m / out.pose.world_from_camera.translation.z());
      out.pose.covariance(2, 2) += square(config.height_sigma_m);
      out.scale = readings.height_source;
      out.scale_stamp = now;
    } else {
      out = with_measured_height(before, readings, config, now);
    }
  }
  if (readings.attitude) {
    out.pose = with_attitude(out.pose, *readings.attitude, config.attitude_sigma_rad);
  }
  return out;
}

Matrix6d carried_covariance(const PoseEstimate& before, const RigidTransform& after) {
  const Eigen::Vector3d way = after.translation - before.world_from_camera.translation;
  Matrix6d J = Matrix6d::Identity();
  J.block<3, 3>(0, 3) = -skew(way);
  J.block<3, 1>(0, 2) += way / before.world_from_camera.translation.z();
  return J * before.covariance * J.transpose();
}

}  // namespace stillkite
