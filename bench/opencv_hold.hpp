#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "estimation/motion_estimate.hpp"
#include "geometry/camera.hpp"

namespace stillkite::bench {

/// Timed steps of the hold paper's estimator (section III), one per OpenCV call.
enum OpenCvStep { kPyramid, kFlow, kUndistort, kEssential, kCorrect, kRecover, kOpenCvSteps };

struct OpenCvHoldEstimate {
  MotionEstimate motion;
  int features = 0;  ///< tracked features
  std::array<double, kOpenCvSteps> ms{};
};

/// Estimator of the hold paper in OpenCV calls: up to 3000 corners in the reference image,
/// pyramidal Lucas-Kanade (35 px window, 4 levels), undistortPoints, findEssentialMat,
/// correctMatches, recoverPose.
class OpenCvHold {
 public:
  /// `method`: of findEssentialMat; paper: cv::RANSAC. Precondition: radial-tangential distortion.
  OpenCvHold(const Camera& camera, int method);

  void set_reference(const cv::Mat& grey);
  /// Pose relative to the reference image. Not `ok` with fewer than 5 pairs or without a unique E.
  [[nodiscard]] OpenCvHoldEstimate step(const cv::Mat& grey) const;

 private:
  cv::Mat camera_matrix_, distortion_;
  double focal_px_;
  int method_;
  std::vector<cv::Mat> reference_pyramid_;
  std::vector<cv::Point2f> reference_px_;
};

}  // namespace stillkite::bench
