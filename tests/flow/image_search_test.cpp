#include "flow/image_search.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

// Noise of all sizes, so that a small copy of it still shows something.
cv::Mat ground(int side_px) {
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(side_px, side_px, CV_32F);
  for (int cell = 4; cell <= side_px / 8; cell *= 2) {
    cv::Mat noise(side_px / cell, side_px / cell, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 12);
    cv::resize(noise, noise, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += noise;
  }
  cv::Mat grey;
  sum.convertTo(grey, CV_8U, 1, 128);
  return grey;
}

struct Move {
  double x_px, y_px, turn_deg;
};

class Search : public testing::TestWithParam<Move> {};

TEST_P(Search, FindsALargeShiftAndTurn) {
  const Move move = GetParam();
  const cv::Size size(320, 240);
  const cv::Mat wide = ground(1024);
  const cv::Point2f middle(511.5F, 511.5F);
  // OpenCV's positive angle turns y to x
  cv::Mat turn = cv::getRotationMatrix2D(middle, -move.turn_deg, 1);
  turn.at<double>(0, 2) += move.x_px;
  turn.at<double>(1, 2) += move.y_px;
  cv::Mat moved;
  cv::warpAffine(wide, moved, turn, wide.size(), cv::INTER_CUBIC);
  const cv::Rect seen(352, 392, size.width, size.height);
  const auto found = find_shifts(wide(seen), moved(seen));
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].shift_px.x(), move.x_px, 4);
  EXPECT_NEAR(found[0].shift_px.y(), move.y_px, 4);
  EXPECT_NEAR(found[0].turn_rad * 180 / CV_PI, move.turn_deg, 2.5);
  EXPECT_GT(found[0].correlation, 0.7);
}

INSTANTIATE_TEST_SUITE_P(ImageSearch, Search,
                         testing::Values(Move{0, 0, 0}, Move{3, -2, 0}, Move{40, 30, 0},
                                         Move{-120, 10, 0}, Move{20, 100, 0}, Move{-60, 40, 8},
                                         Move{10, -50, -10}));

TEST(ImageSearch, LeavesTurnsOutIfAsked) {
  const cv::Mat wide = ground(1024);
  const cv::Rect seen(300, 300, 320, 240);
  const auto found = find_shifts(wide(seen + cv::Point(-70, 30)), wide(seen),
                                 Eigen::Matrix3d::Identity(), kNoTurn_rad);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].shift_px.x(), -70, 4);
  EXPECT_NEAR(found[0].shift_px.y(), 30, 4);
  for (const ImageShift& shift : found) EXPECT_EQ(shift.turn_rad, 0);
}

TEST(ImageSearch, SeesNothingInABareImage) {
  const cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(90));
  EXPECT_TRUE(find_shifts(grey, grey).empty());
}

TEST(ImageSearch, IsNotFooledByAnExposureThatChanges) {
  const cv::Mat wide = ground(1024);
  const cv::Rect seen(100, 100, 320, 240);
  cv::Mat darker;
  wide.convertTo(darker, CV_8U, 0.6, 10);
  const auto found = find_shifts(wide(seen + cv::Point(50, 20)), darker(seen));
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].shift_px.x(), 50, 4);
  EXPECT_NEAR(found[0].shift_px.y(), 20, 4);
}

// The view magnifies by two about the middle: so does it the shift.
TEST(ImageSearch, AnswersInThePixelsOfTheView) {
  const cv::Mat wide = ground(1024);
  const cv::Rect seen(300, 300, 320, 240);
  Eigen::Matrix3d view = Eigen::Matrix3d::Identity();
  view.topLeftCorner<2, 2>() *= 2;
  view.topRightCorner<2, 1>() << -159.5, -119.5;
  const auto found = find_shifts(wide(seen + cv::Point(20, -10)), wide(seen), view);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].shift_px.x(), 40, 4);
  EXPECT_NEAR(found[0].shift_px.y(), -20, 4);
}

}  // namespace
}  // namespace stillkite
