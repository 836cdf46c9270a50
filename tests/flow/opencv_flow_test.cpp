#include "flow/opencv_flow.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

#include "tests/flow/analytic_image.hpp"

namespace stillkite {
namespace {

const cv::Size kSize(331, 243);
const Eigen::Affine2d kIdentity = Eigen::Affine2d::Identity();
const Eigen::Affine2d kMotion(Eigen::Translation2d(2.4, -1.3));

class OpenCvFlows : public testing::TestWithParam<OpenCvFlowMethod> {};

TEST_P(OpenCvFlows, MeasuresShift) {
  OpenCvFlow flow({.method = GetParam()});
  const FlowField& field = flow(analytic_frame(kSize, kIdentity), analytic_frame(kSize, kMotion));
  EXPECT_LT(end_point_error(field, kSize, kMotion, 16).mean_px, 0.15);
}

TEST_P(OpenCvFlows, IsIndependentOfPreviousPair) {
  const cv::Mat a = analytic_frame(kSize, kIdentity);
  const cv::Mat b = analytic_frame(kSize, kMotion);
  OpenCvFlow used({.method = GetParam()});
  OpenCvFlow fresh({.method = GetParam()});
  used(a, b);
  EXPECT_EQ(cv::norm(used(b, a).flow_px, fresh(b, a).flow_px, cv::NORM_INF), 0);
}

TEST_P(OpenCvFlows, RejectsFramesOfDifferentSize) {
  OpenCvFlow flow({.method = GetParam()});
  const cv::Mat frame(kSize, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(flow(frame, frame.rowRange(0, 99)), InputError);
}

INSTANTIATE_TEST_SUITE_P(Methods, OpenCvFlows,
                         testing::Values(OpenCvFlowMethod::farneback,
                                         OpenCvFlowMethod::dis_ultrafast,
                                         OpenCvFlowMethod::dis_fast, OpenCvFlowMethod::dis_medium,
                                         OpenCvFlowMethod::pyramidal_lucas_kanade),
                         [](const auto& method) { return std::string(name_of(method.param)); });

TEST(OpenCvFlow, GridCoversFrameWithZeroInformationWithoutTexture) {
  OpenCvFlow flow({.method = OpenCvFlowMethod::pyramidal_lucas_kanade, .stride_px = 8});
  const cv::Mat blank(cv::Size(100, 61), CV_8UC1, cv::Scalar(9));
  const FlowField& field = flow(blank, blank);
  EXPECT_EQ(field.flow_px.size(), cv::Size(12, 8));  // 4, 12, ... 92 and 4, ... 60
  EXPECT_EQ(field.stride_px, 8);
  EXPECT_EQ(cv::norm(field.information, cv::NORM_INF), 0);
  EXPECT_TRUE(cv::checkRange(field.flow_px));
}

TEST(OpenCvFlow, GridInformationMatchesDenseLucasKanade) {
  // Waves of amplitude A and wave number k along both axes: mean squared gradient (A k)^2 / 2.
  const double amplitude = 50;
  const double wave_number = 2 * M_PI / 15;
  cv::Mat frame(kSize, CV_8UC1);
  for (int y = 0; y < frame.rows; ++y) {
    for (int x = 0; x < frame.cols; ++x) {
      frame.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(
          128 + amplitude * (std::sin(wave_number * x) + std::sin(wave_number * y)));
    }
  }
  OpenCvFlow flow({.method = OpenCvFlowMethod::pyramidal_lucas_kanade});
  const double expected = std::pow(amplitude * wave_number, 2) / 2;
  EXPECT_NEAR(cv::mean(flow(frame, frame).information(cv::Rect(5, 5, 25, 20)))[0], expected,
              0.15 * expected);
}

}  // namespace
}  // namespace stillkite
