#include "estimation/two_view/opencv_relative_pose.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "estimation/robust_kernel.hpp"
#include "estimation/two_view/epipolar_error.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr int kMinimalPairs = 5;

int opencv_flag(EssentialMethod method) {
  switch (method) {
    case EssentialMethod::ransac:
      return cv::RANSAC;
    case EssentialMethod::usac_default:
      return cv::USAC_DEFAULT;
    case EssentialMethod::usac_fast:
      return cv::USAC_FAST;
    case EssentialMethod::usac_accurate:
      return cv::USAC_ACCURATE;
    case EssentialMethod::usac_magsac:
      return cv::USAC_MAGSAC;
  }
  return cv::RANSAC;
}

Eigen::Matrix3d to_eigen(const cv::Mat& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.ptr<double>());
}

// Inlier points, optionally moved onto their epipolar lines.
struct Inliers {
  std::vector<cv::Point2d> reference, current;
};
Inliers inliers_of(std::span<const BearingPair> pairs, const cv::Mat& mask, const cv::Mat& E,
                   bool correct) {
  Inliers points;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (mask.at<unsigned char>(static_cast<int>(i)) == 0) continue;
    points.reference.emplace_back(pairs[i].reference.x(), pairs[i].reference.y());
    points.current.emplace_back(pairs[i].current.x(), pairs[i].current.y());
  }
  if (!correct || points.reference.empty()) return points;
  Inliers corrected;
  cv::correctMatches(E, points.reference, points.current, corrected.reference, corrected.current);
  // correctMatches returns NaN for a point at an epipole
  for (std::size_t i = 0; i < corrected.reference.size(); ++i) {
    const cv::Point2d sum = corrected.reference[i] + corrected.current[i];
    if (!std::isfinite(sum.x + sum.y)) {
      corrected.reference[i] = points.reference[i];
      corrected.current[i] = points.current[i];
    }
  }
  return corrected;
}

}  // namespace

RelativePoseEstimate estimate_relative_pose_opencv(std::span<const BearingPair> pairs,
                                                   double focal_px,
                                                   const OpenCvPoseConfig& config) {
  RelativePoseEstimate estimate;
  estimate.inliers.assign(pairs.size(), 0);
  if (pairs.size() < kMinimalPairs) return estimate;
  std::vector<cv::Point2d> reference, current;
  for (const BearingPair& pair : pairs) {
    reference.emplace_back(pair.reference.x(), pair.reference.y());
    current.emplace_back(pair.current.x(), pair.current.y());
  }
  const cv::Mat K = cv::Mat::eye(3, 3, CV_64F);
  try {
    cv::Mat mask;
    cv::Mat E = cv::findEssentialMat(reference, current, K, opencv_flag(config.essential_method),
                                     config.confidence, config.threshold_px / focal_px, mask);
    if (E.rows < 3 || E.cols != 3 || mask.total() != pairs.size()) return estimate;
    E = E.rowRange(0, 3).clone();  // five pairs: OpenCV stacks all solutions
    const Inliers points = inliers_of(pairs, mask, E, config.correct_matches);
    if (points.reference.size() < kMinimalPairs) return estimate;
    cv::Mat R, t;
    cv::recoverPose(E, points.reference, points.current, K, R, t);
    const Eigen::Matrix3d rotation = to_eigen(R);
    if (!rotation.allFinite() || rotation.determinant() < 0.5) return estimate;
    estimate.pose.current_from_reference = Eigen::Quaterniond(rotation).normalized();
    estimate.pose.direction = Eigen::Map<const Eigen::Vector3d>(t.ptr<double>()).normalized();
    std::vector<double> errors;
    const Eigen::Matrix3d essential = essential_matrix(estimate.pose);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (mask.at<unsigned char>(static_cast<int>(i)) == 0) continue;
      estimate.inliers[i] = 1;
      ++estimate.inlier_count;
      errors.push_back(std::abs(sampson_error(essential, pairs[i])));
    }
    estimate.residual = kMadToSigma * upper_median(errors);
    estimate.model = ViewModel::general;
  } catch (const cv::Exception&) {
    // OpenCV asserts on some degenerate samples
    estimate = {};
    estimate.inliers.assign(pairs.size(), 0);
  }
  return estimate;
}

}  // namespace stillkite
