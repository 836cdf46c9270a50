#include "flow/dense_lucas_kanade.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "tests/flow/analytic_image.hpp"

namespace stillkite {
namespace {

const cv::Size kSize(331, 243);

Eigen::Affine2d shift(double x, double y) {
  return Eigen::Affine2d(Eigen::Translation2d(x, y));
}

// Rotation and scaling about the image centre, then a shift.
Eigen::Affine2d rotation_and_scaling(double rotation_rad, double scale, double x, double y) {
  const Eigen::Vector2d centre(165, 121);
  return shift(x, y) * Eigen::Translation2d(centre) * Eigen::Rotation2Dd(rotation_rad) *
         Eigen::Scaling(scale) * Eigen::Translation2d(-centre);
}

TEST(DenseLucasKanade, MeasuresSmallAndLargeShifts) {
  DenseLucasKanade flow({});
  for (const auto& motion : {shift(0, 0), shift(0.4, -0.7), shift(-2.5, 1.5), shift(14.3, -9.6)}) {
    const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
    const auto error = end_point_error(field, kSize, motion, 0);
    EXPECT_LT(error.mean_px, 0.02) << motion.translation().transpose();
    EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.12);
  }
}

TEST(DenseLucasKanade, MeasuresAffineMotion) {
  DenseLucasKanade flow({});
  const auto motion = rotation_and_scaling(0.02, 1.015, 3.2, -1.7);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
  EXPECT_LT(end_point_error(field, kSize, motion, 0).mean_px, 0.03);
  EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.15);
}

TEST(DenseLucasKanade, DoesNotDivergeWithMoreIterations) {
  DenseLucasKanade flow({.steps = 8, .finest_steps = 8});
  const auto motion = rotation_and_scaling(0.02, 1.015, 3.2, -1.7);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
  EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.15);
}

TEST(DenseLucasKanade, PredictedHomographyExtendsRange) {
  DenseLucasKanade flow({.levels = 2});
  const auto motion = shift(40.5, -21.2);
  const cv::Mat previous = analytic_frame(kSize, shift(0, 0));
  const cv::Mat current = analytic_frame(kSize, motion);
  EXPECT_GT(end_point_error(flow(previous, current), kSize, motion, 8).mean_px, 5);
  const Eigen::Matrix3d initial_homography = shift(39, -20).matrix();
  const auto& field = flow(previous, current, initial_homography);
  EXPECT_LT(end_point_error(field, kSize, motion, 8).mean_px, 0.02);
}

TEST(DenseLucasKanade, PredictedFlowExtendsRangeAndMayHaveGaps) {
  DenseLucasKanade flow({.levels = 2});
  const auto motion = shift(40.5, -21.2);
  cv::Mat predicted(kSize, CV_32FC2, cv::Scalar(39, -20));
  predicted(cv::Rect(200, 200, 2, 2)) = std::numeric_limits<float>::quiet_NaN();
  const auto& field =
      flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion), predicted);
  EXPECT_TRUE(cv::checkRange(field.flow_px));
  EXPECT_LT(end_point_error(field, kSize, motion, 8).mean_px, 0.2);
}

TEST(DenseLucasKanade, IsInvariantToBrightnessOffset) {
  DenseLucasKanade flow({});
  const auto motion = shift(1.3, 0.6);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion, 20));
  EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.12);
}

TEST(DenseLucasKanade, ReportsZeroFlowAndInformationWithoutTexture) {
  DenseLucasKanade flow({});
  const cv::Mat blank(kSize, CV_8UC1, cv::Scalar(77));
  const auto& field = flow(blank, blank + 5);
  EXPECT_EQ(cv::norm(field.flow_px, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(field.information, cv::NORM_INF), 0);
}

TEST(DenseLucasKanade, InformationOfEdgeIsZeroExceptAtCorner) {
  cv::Mat corner(kSize, CV_8UC1, cv::Scalar(40));
  corner(cv::Rect(0, 0, 160, 120)) = 200;
  DenseLucasKanade flow({});
  const cv::Mat& information = flow(corner, corner).information;
  EXPECT_GT(information.at<float>(120, 160), 100);
  EXPECT_NEAR(information.at<float>(60, 160), 0, 1e-3);
  EXPECT_EQ(information.at<float>(200, 300), 0);
}

TEST(DenseLucasKanade, ExtrapolatesFlowForPixelsThatLeaveTheImage) {
  DenseLucasKanade flow({});
  const auto motion = shift(6, 4);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
  const auto flow_at_corner = field.flow_px.at<cv::Vec2f>(kSize.height - 1, kSize.width - 1);
  EXPECT_NEAR(flow_at_corner[0], 6, 0.5);
  EXPECT_NEAR(flow_at_corner[1], 4, 0.5);
}

TEST(DenseLucasKanade, FlowIsFiniteForAllFrameSizes) {
  DenseLucasKanade flow({});
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(2, 3), cv::Size(7, 1), cv::Size(16, 16),
                              cv::Size(17, 65), cv::Size(129, 33), cv::Size(64, 129)}) {
    const auto& field =
        flow(analytic_frame(size, shift(0, 0)), analytic_frame(size, shift(0.5, 0.5)));
    EXPECT_EQ(field.flow_px.size(), size);
    EXPECT_EQ(field.information.size(), size);
    EXPECT_TRUE(cv::checkRange(field.flow_px)) << size;
    EXPECT_TRUE(cv::checkRange(field.information)) << size;
  }
}

TEST(DenseLucasKanade, SwappedFramesInvertFlow) {
  DenseLucasKanade flow({});
  const auto motion = rotation_and_scaling(0.01, 0.99, 1.2, 0.8);
  const cv::Mat a = analytic_frame(kSize, shift(0, 0));
  const cv::Mat b = analytic_frame(kSize, motion);
  EXPECT_LT(end_point_error(flow(b, a), kSize, motion.inverse(), 8).max_px, 0.15);
}

TEST(DenseLucasKanade, MirroredFramesMirrorFlow) {
  const cv::Size odd(257, 129);  // 2^k + 1 columns: every level keeps its mirror axis
  DenseLucasKanade flow({});
  cv::Mat a = analytic_frame(odd, shift(0, 0));
  cv::Mat b = analytic_frame(odd, shift(1.7, -0.6));
  cv::Mat expected;
  cv::flip(flow(a, b).flow_px, expected, 1);
  cv::multiply(expected, cv::Scalar(-1, 1), expected);
  cv::flip(a, a, 1);
  cv::flip(b, b, 1);
  EXPECT_LT(cv::norm(flow(a, b).flow_px, expected, cv::NORM_INF), 2e-3);
}

TEST(DenseLucasKanade, IsIndependentOfThreadCount) {
  DenseLucasKanade flow({});
  const cv::Mat a = analytic_frame({200, 600}, shift(0, 0));
  const cv::Mat b = analytic_frame({200, 600}, shift(1.7, -0.6));
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::Mat expected = flow(a, b).flow_px.clone();
  cv::setNumThreads(3);
  EXPECT_EQ(cv::norm(flow(a, b).flow_px, expected, cv::NORM_INF), 0);
  cv::setNumThreads(threads);
}

TEST(DenseLucasKanade, RejectsInvalidInput) {
  EXPECT_THROW(DenseLucasKanade({.window_px = 14}), InputError);
  EXPECT_THROW(DenseLucasKanade({.levels = 0}), InputError);
  EXPECT_THROW(DenseLucasKanade({.regularisation = 0}), InputError);
  DenseLucasKanade flow({});
  const cv::Mat frame(kSize, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(flow(cv::Mat(), frame), InputError);
  EXPECT_THROW(flow(frame, frame.colRange(0, 99)), InputError);
  EXPECT_THROW(flow(frame, cv::Mat(kSize, CV_8UC3)), InputError);
  EXPECT_THROW(flow(frame, frame, cv::Mat(kSize, CV_64FC2)), InputError);
}

}  // namespace
}  // namespace stillkite
