#pragma once

#include <opencv2/core/mat.hpp>

#include "simulation/hover/fault.hpp"
#include "simulation/hover/hover_readings.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Gyroscope and IMU's attitude as the fault leaves them; tilt is the accelerometer's and stays.
[[nodiscard]] HoverReadings with_fault(HoverReadings readings, const FaultEffect& fault);

/// The upper part of an image (CV_32FC1) behind a patterned sheet that swings to and fro.
[[nodiscard]] cv::Mat covered(const cv::Mat& light, double ratio, double t_s);

/// The level patches at height 0 moved; what stands on one that is lifted sinks in.
[[nodiscard]] PatchScene with_floor_moved(PatchScene scene, const Eigen::Vector3d& by_m);

}  // namespace stillkite
