#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "calibration/gyro_rotation.hpp"
#include "estimation/sliding_window/epipolar_rotation.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Two images with the bearings of the points in both.
struct ImagePair {
  Timestamp from;
  Timestamp to;
  std::vector<BearingMatch> matches;  ///< first: bearing in `from`
};

/// Rotation, gyroscope bias and clock offset between a camera and an IMU.
struct ImuAlignment {
  Eigen::Quaterniond imu_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();
  double time_offset_s = 0;  ///< t_imu = t_image + offset
  double focal_ratio = 1;    ///< true focal length / that of the bearings
  /// Of the rotation (error in the IMU's axes: R_true = exp(error) R, rad), the bias, the offset
  /// and the logarithm of the focal ratio.
  Eigen::Matrix<double, 8, 8> covariance = Eigen::Matrix<double, 8, 8>::Zero();
  int pairs = 0;
  double unit_variance = 0;  ///< chi square per degree of freedom
};

struct ImuAlignmentOptions {
  double gyro_density = 0;  ///< white noise, rad/s/sqrt(Hz)
  double max_offset_s = 0.5;
  bool estimate_focal = false;  ///< bearings of a pinhole camera without distortion
};

/// A closed-form rotation over all clock offsets (Kabsch 1976, on rotation vectors less their mean,
/// which includes the bias), then Gauss-Newton on the epipolar residuals of all pairs. Throws
/// InputError if the images rotate too little, if gyroscope and images disagree, and if only a
/// mirrored set of axes would make them agree.
[[nodiscard]] ImuAlignment align_imu(std::span<const ImagePair> pairs, const GyroReadings& gyro,
                                     const ImuAlignmentOptions& options);

}  // namespace stillkite
