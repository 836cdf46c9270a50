#include "bench/opencv_hold.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "bench/processor_watch.hpp"

namespace stillkite::bench {
namespace {

constexpr int kMaxFeatures = 3000;
constexpr double kQuality = 0.01;
constexpr double kMinDistance_px = 2;
constexpr int kMaxLevel = 3;
constexpr int kMinPairs = 5;
const cv::Size kWindow_px{35, 35};

// Displacement in the reference frame: -R^T t.
MotionEstimate motion_of(const cv::Mat& R, const cv::Mat& t) {
  const Eigen::Matrix3d rotation =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.ptr<double>());
  const Eigen::Vector3d direction = Eigen::Map<const Eigen::Vector3d>(t.ptr<double>());
  MotionEstimate motion;
  motion.status = EstimateStatus::ok;
  motion.reference_from_camera = Eigen::Quaterniond(rotation.transpose());
  motion.displacement_kind = DisplacementKind::direction;
  motion.displacement_in_reference = -(rotation.transpose() * direction);
  return motion;
}

}  // namespace

OpenCvHold::OpenCvHold(const Camera& camera, int method)
    : camera_matrix_((cv::Mat_<double>(3, 3) << camera.focal_x_px, 0, camera.centre_x_px, 0,
                      camera.focal_y_px, camera.centre_y_px, 0, 0, 1)),
      focal_px_(camera.focal_x_px),
      method_(method) {
  CV_Assert(camera.distortion == DistortionModel::radial_tangential);
  distortion_ = cv::Mat(camera.coefficients, true);
}

void OpenCvHold::set_reference(const cv::Mat& grey) {
  cv::goodFeaturesToTrack(grey, reference_px_, kMaxFeatures, kQuality, kMinDistance_px);
  cv::buildOpticalFlowPyramid(grey, reference_pyramid_, kWindow_px, kMaxLevel);
}

OpenCvHoldEstimate OpenCvHold::step(const cv::Mat& grey) const {
  OpenCvHoldEstimate out;
  ProcessorWatch watch;
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(grey, pyramid, kWindow_px, kMaxLevel);
  out.ms[kPyramid] = watch.lap_ms();

  std::vector<cv::Point2f> current_px;
  std::vector<unsigned char> status;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(reference_pyramid_, pyramid, reference_px_, current_px, status, errors,
                           kWindow_px, kMaxLevel);
  const cv::Rect2f image(0, 0, static_cast<float>(grey.cols - 1),
                         static_cast<float>(grey.rows - 1));
  std::vector<cv::Point2f> from_px;
  std::vector<cv::Point2f> to_px;
  double shift_px = 0;
  for (std::size_t i = 0; i < reference_px_.size(); ++i) {
    if (status[i] == 0 || !image.contains(current_px[i])) continue;
    from_px.push_back(reference_px_[i]);
    to_px.push_back(current_px[i]);
    shift_px += cv::norm(current_px[i] - reference_px_[i]);
  }
  out.features = static_cast<int>(from_px.size());
  out.ms[kFlow] = watch.lap_ms();
  if (out.features < kMinPairs) return out;

  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  cv::undistortPoints(std::vector<cv::Point2d>(from_px.begin(), from_px.end()), from,
                      camera_matrix_, distortion_);
  cv::undistortPoints(std::vector<cv::Point2d>(to_px.begin(), to_px.end()), to, camera_matrix_,
                      distortion_);
  out.ms[kUndistort] = watch.lap_ms();

  const cv::Mat K = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat mask;
  const cv::Mat E = cv::findEssentialMat(from, to, K, method_, 0.999, 1 / focal_px_, mask);
  out.ms[kEssential] = watch.lap_ms();
  if (E.rows != 3 || E.cols != 3) return out;

  std::vector<cv::Point2d> inliers_from;
  std::vector<cv::Point2d> inliers_to;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (mask.at<unsigned char>(static_cast<int>(i)) == 0) continue;
    inliers_from.push_back(from[i]);
    inliers_to.push_back(to[i]);
  }
  std::vector<cv::Point2d> corrected_from;
  std::vector<cv::Point2d> corrected_to;
  cv::correctMatches(E, inliers_from, inliers_to, corrected_from, corrected_to);
  out.ms[kCorrect] = watch.lap_ms();

  cv::Mat R;
  cv::Mat t;
  cv::recoverPose(E, corrected_from, corrected_to, K, R, t);
  out.motion = motion_of(R, t);
  out.motion.mean_shift_px = shift_px / out.features;
  out.ms[kRecover] = watch.lap_ms();
  return out;
}

}  // namespace stillkite::bench
