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

// Turn and growth about the middle of the image, then a shift.
Eigen::Affine2d turn_and_grow(double turn_rad, double growth, double x, double y) {
  const Eigen::Vector2d middle(165, 121);
  return shift(x, y) * Eigen::Translation2d(middle) * Eigen::Rotation2Dd(turn_rad) *
         Eigen::Scaling(growth) * Eigen::Translation2d(-middle);
}

TEST(dense_lucas_kanade, finds_a_small_shift_and_a_large_one) {
  DenseLucasKanade flow({});
  for (const auto& motion : {shift(0, 0), shift(0.4, -0.7), shift(-2.5, 1.5), shift(14.3, -9.6)}) {
    const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
    const auto error = end_point_error(field, kSize, motion, 0);
    EXPECT_LT(error.mean_px, 0.02) << motion.translation().transpose();
    EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.12);
  }
}

TEST(dense_lucas_kanade, finds_an_affine_motion) {
  DenseLucasKanade flow({});
  const auto motion = turn_and_grow(0.02, 1.015, 3.2, -1.7);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
  EXPECT_LT(end_point_error(field, kSize, motion, 0).mean_px, 0.03);
  EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.15);
}

TEST(dense_lucas_kanade, more_steps_do_not_diverge) {
  DenseLucasKanade flow({.steps = 8, .finest_steps = 8});
  const auto motion = turn_and_grow(0.02, 1.015, 3.2, -1.7);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
  EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.15);
}

TEST(dense_lucas_kanade, a_predicted_homography_reaches_what_the_pyramid_cannot) {
  DenseLucasKanade flow({.levels = 2});
  const auto motion = shift(40.5, -21.2);
  const cv::Mat previous = analytic_frame(kSize, shift(0, 0));
  const cv::Mat current = analytic_frame(kSize, motion);
  EXPECT_GT(end_point_error(flow(previous, current), kSize, motion, 8).mean_px, 5);
  const Eigen::Matrix3d off_by_two_px = shift(39, -20).matrix();
  const auto& field = flow(previous, current, off_by_two_px);
  EXPECT_LT(end_point_error(field, kSize, motion, 8).mean_px, 0.02);
}

TEST(dense_lucas_kanade, a_predicted_field_does_so_too_and_may_have_holes) {
  DenseLucasKanade flow({.levels = 2});
  const auto motion = shift(40.5, -21.2);
  cv::Mat predicted(kSize, CV_32FC2, cv::Scalar(39, -20));
  predicted(cv::Rect(200, 200, 2, 2)) = std::numeric_limits<float>::quiet_NaN();
  const auto& field =
      flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion), predicted);
  EXPECT_TRUE(cv::checkRange(field.flow_px));
  EXPECT_LT(end_point_error(field, kSize, motion, 8).mean_px, 0.2);
}

TEST(dense_lucas_kanade, a_step_of_brightness_is_not_motion) {
  DenseLucasKanade flow({});
  const auto motion = shift(1.3, 0.6);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion, 20));
  EXPECT_LT(end_point_error(field, kSize, motion, 8).max_px, 0.12);
}

TEST(dense_lucas_kanade, no_texture_means_no_motion_and_no_information) {
  DenseLucasKanade flow({});
  const cv::Mat blank(kSize, CV_8UC1, cv::Scalar(77));
  const auto& field = flow(blank, blank + 5);
  EXPECT_EQ(cv::norm(field.flow_px, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(field.information, cv::NORM_INF), 0);
}

TEST(dense_lucas_kanade, an_edge_has_information_only_where_it_bends) {
  cv::Mat corner(kSize, CV_8UC1, cv::Scalar(40));
  corner(cv::Rect(0, 0, 160, 120)) = 200;
  DenseLucasKanade flow({});
  const cv::Mat& information = flow(corner, corner).information;
  EXPECT_GT(information.at<float>(120, 160), 100);
  EXPECT_NEAR(information.at<float>(60, 160), 0, 1e-3);
  EXPECT_EQ(information.at<float>(200, 300), 0);
}

TEST(dense_lucas_kanade, what_leaves_the_image_takes_the_motion_of_its_neighbours) {
  DenseLucasKanade flow({});
  const auto motion = shift(6, 4);
  const auto& field = flow(analytic_frame(kSize, shift(0, 0)), analytic_frame(kSize, motion));
  const auto at_corner = field.flow_px.at<cv::Vec2f>(kSize.height - 1, kSize.width - 1);
  EXPECT_NEAR(at_corner[0], 6, 0.5);
  EXPECT_NEAR(at_corner[1], 4, 0.5);
}

TEST(dense_lucas_kanade, frames_of_every_size_get_a_finite_field_of_that_size) {
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

TEST(dense_lucas_kanade, swapped_frames_give_the_opposite_flow) {
  DenseLucasKanade flow({});
  const auto motion = turn_and_grow(0.01, 0.99, 1.2, 0.8);
  const cv::Mat a = analytic_frame(kSize, shift(0, 0));
  const cv::Mat b = analytic_frame(kSize, motion);
  EXPECT_LT(end_point_error(flow(b, a), kSize, motion.inverse(), 8).max_px, 0.15);
}

TEST(dense_lucas_kanade, a_mirrored_pair_has_the_mirrored_flow) {
  const cv::Size odd(257, 129);  // every level keeps its mirror axis: 2^k + 1 columns
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

TEST(dense_lucas_kanade, the_number_of_threads_changes_nothing) {
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

TEST(dense_lucas_kanade, wrong_input_is_named) {
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
