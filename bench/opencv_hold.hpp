#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "estimation/motion_estimate.hpp"
#include "geometry/camera.hpp"

namespace stillkite::bench {

/// What one frame costs the hold paper's steps (section III), call by call.
enum OpenCvStep { kPyramid, kFlow, kUndistort, kEssential, kCorrect, kRecover, kOpenCvSteps };

struct OpenCvHoldEstimate {
  MotionEstimate motion;
  int features = 0;  ///< found again
  std::array<double, kOpenCvSteps> ms{};
};

/// The hold paper's estimator in plain OpenCV calls: up to 3000 corners of the reference, pyramidal
/// Lucas-Kanade from there (35 px, 3 levels above the image), undistortPoints, findEssentialMat,
/// correctMatches, recoverPose.
class OpenCvHold {
 public:
  /// `method`: of findEssentialMat; the paper's is cv::RANSAC.
  OpenCvHold(const Camera& camera, int method);

  void set_reference(const cv::Mat& grey);
  [[nodiscard]] OpenCvHoldEstimate step(const cv::Mat& grey) const;

 private:
  cv::Mat camera_matrix_, distortion_;
  double focal_px_;
  int method_;
  std::vector<cv::Mat> reference_pyramid_;
  std::vector<cv::Point2f> reference_px_;
};

}  // namespace stillkite::bench
