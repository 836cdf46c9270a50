#pragma once

#include <opencv2/core.hpp>

#include "app/page_snapshot.hpp"

namespace stillkite {

/// Camera looks down; forward of the body is up in the image.
inline RigidTransform body_from_nadir_camera() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return {Eigen::Quaterniond(R), Eigen::Vector3d::Zero()};
}

/// Measured image at 2 m height, speed 0.5 m/s, displaced by 0.3 m forward and 0.4 m to the left.
inline PageSnapshot snapshot_at(Timestamp now) {
  PageSnapshot out;
  out.camera = {.width_px = 640,
                .height_px = 480,
                .focal_x_px = 500,
                .focal_y_px = 500,
                .centre_x_px = 319.5,
                .centre_y_px = 239.5};
  out.grey = cv::Mat(480, 640, CV_8UC1, cv::Scalar(120));
  out.body_from_camera = body_from_nadir_camera();
  out.estimated = now;
  out.latency_s = 0.025;
  NavigationEstimate& estimate = out.step.estimate;
  estimate.verdict = Verdict::ok;
  estimate.scale = ScaleSource::initial_height;
  estimate.scale_age_s = 90;
  estimate.world_from_body.translation = {0.3, 0.4, 2};
  estimate.velocity_in_world_m_s = {0.3, 0.4, 0};
  MotionEstimate& motion = out.step.motion;
  motion.status = EstimateStatus::ok;
  motion.displacement_kind = DisplacementKind::metric;
  motion.displacement_in_reference =
      out.body_from_camera.rotation.conjugate() * Eigen::Vector3d(0.3, 0.4, 0);
  motion.displacement_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  out.step.decision.reason = HoldReason::not_engaged;
  return out;
}

}  // namespace stillkite
