#include "navigation/sensor_update.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/fusion/error_state.hpp"

namespace stillkite {
namespace {

// Kalman update by a measurement of one component of the pose error.
PoseEstimate kalman_update(const PoseEstimate& pose, int component, double innovation,
                           double sigma) {
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
  return kalman_update(pose, 2, height_m - pose.world_from_camera.translation.z(), sigma_m);
}

PoseEstimate with_attitude(const PoseEstimate& pose, const Eigen::Quaterniond& world_from_camera,
                           double sigma_rad) {
  // rotation that aligns the estimated vertical, independent of both yaws; about x, then about y
  const Eigen::Vector3d up_in_camera = world_from_camera.conjugate() * Eigen::Vector3d::UnitZ();
  PoseEstimate out = pose;
  for (const int axis : {0, 1}) {
    const Eigen::Quaterniond tilt_error =
        rotation_between(out.world_from_camera.rotation * up_in_camera, Eigen::Vector3d::UnitZ());
    out = kalman_update(out, 3 + axis, so3_log(tilt_error)(axis), sigma_rad);
  }
  return out;
}

// Height outliers: range finder without an echo, over a roof, or in rain.
bool is_height_outlier(double innovation_m, double variance_m2, double predicted_m) {
  constexpr double kSigmas = 5;
  constexpr double kMinRatio = 0.1;
  return std::abs(innovation_m) >
         std::max(kSigmas * std::sqrt(variance_m2), kMinRatio * predicted_m);
}

ScaledPose with_measured_height(const ScaledPose& before, const CameraReadings& readings,
                                const SensorConfig& config, Timestamp now) {
  constexpr int kAcceptedOutlierRun = 5;
  ScaledPose out = before;
  const double predicted_m = before.pose.world_from_camera.translation.z();
  double& variance_m2 = out.pose.covariance(2, 2);
  if (before.scale == ScaleSource::initial_height) {
    // the sensor has priority over the given initial height
    variance_m2 += square(config.start_height_sigma_ratio * predicted_m);
  }
  const double innovation_m = *readings.height_m - predicted_m;
  if (is_height_outlier(innovation_m, variance_m2 + square(config.height_sigma_m), predicted_m)) {
    ScaledPose rejected = before;
    rejected.rejected_reading_m = readings.reading_m;
    const bool is_distinct =
        before.rejected_heights == 0 || readings.reading_m != before.rejected_reading_m;
    if (is_distinct) ++rejected.rejected_heights;
    if (rejected.rejected_heights < kAcceptedOutlierRun) return rejected;
    variance_m2 += square(innovation_m);
  }
  out.pose = with_height(out.pose, *readings.height_m, config.height_sigma_m);
  out.rejected_heights = 0;
  out.scale = readings.height_source;
  out.scale_stamp = now;
  return out;
}

PoseEstimate rescaled(const PoseEstimate& pose, double factor) {
  PoseEstimate out = pose;
  out.world_from_camera.translation *= factor;
  out.covariance.topRows<3>() *= factor;
  out.covariance.leftCols<3>() *= factor;
  return out;
}

}  // namespace

CameraReadings camera_readings(const SensorReadings& readings,
                               const RigidTransform& body_from_camera,
                               const Eigen::Quaterniond& world_from_camera) {
  CameraReadings out{.height_source = readings.height_source};
  if (readings.height_m) {
    out.reading_m = *readings.height_m;
    const Eigen::Vector3d body_in_camera = body_from_camera.inverse().translation;
    const Eigen::Quaterniond world_from_body =
        world_from_camera * body_from_camera.rotation.conjugate();
    out.height_m = height_of_body_m(*readings.height_m, readings.height_source, world_from_body) -
                   (world_from_camera * body_in_camera).z();
  }
  if (readings.attitude) out.attitude = *readings.attitude * body_from_camera.rotation;
  return out;
}

ScaledPose apply_readings(const ScaledPose& before, const CameraReadings& readings,
                          const SensorConfig& config, Timestamp now) {
  ScaledPose out = before;
  if (readings.height_m && *readings.height_m > 0) {
    if (before.scale == ScaleSource::none) {
      out.pose =
          rescaled(out.pose, *readings.height_m / out.pose.world_from_camera.translation.z());
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

Matrix6d propagated_covariance(const PoseEstimate& before, const RigidTransform& after) {
  const Eigen::Vector3d displacement = after.translation - before.world_from_camera.translation;
  Matrix6d J = Matrix6d::Identity();
  J.block<3, 3>(0, 3) = -skew(displacement);
  J.block<3, 1>(0, 2) += displacement / before.world_from_camera.translation.z();
  return J * before.covariance * J.transpose();
}

}  // namespace stillkite
