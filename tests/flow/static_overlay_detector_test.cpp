#include "flow/static_overlay_detector.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flow/image_mask.hpp"
#include "geometry/fields.hpp"

namespace stillkite {
namespace {

const cv::Size kFrameSize(320, 240);
const cv::Point kText(40, 60);
constexpr double kStep_px = 5;

// Multi-scale noise and a straight road along x.
cv::Mat ground() {
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(600, 1200, CV_32F);
  for (int cell = 3; cell <= 48; cell *= 2) {
    cv::Mat noise(600 / cell, 1200 / cell, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 15);
    cv::resize(noise, noise, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += noise;
  }
  cv::Mat grey;
  sum.convertTo(grey, CV_8U, 1, 128);
  cv::rectangle(grey, {0, 190, 1200, 12}, 20, -1);
  return grey;
}

// Noisy camera image after a displacement along x.
cv::Mat camera_image(double displacement_px, const std::function<void(cv::Mat&)>& draw_overlay,
                     int noise_seed) {
  static const cv::Mat kGround = ground();
  cv::Mat image;
  const cv::Matx23d shift(1, 0, -displacement_px, 0, 1, 0);
  cv::warpAffine(kGround, image, shift, kFrameSize, cv::INTER_LINEAR);
  if (draw_overlay) draw_overlay(image);
  cv::Mat noise(image.size(), CV_16S), noisy;
  cv::RNG random(static_cast<std::uint64_t>(noise_seed) + 1);
  random.fill(noise, cv::RNG::NORMAL, 0, 2);
  image.convertTo(noisy, CV_16S);
  noisy += noise;
  noisy.convertTo(image, CV_8U);
  return image;
}

void draw_text(cv::Mat& image) {
  cv::putText(image, "BAT 82%", kText, cv::FONT_HERSHEY_SIMPLEX, 0.7, 0, 3, cv::LINE_AA);
  cv::putText(image, "BAT 82%", kText, cv::FONT_HERSHEY_SIMPLEX, 0.7, 255, 1, cv::LINE_AA);
}

// Mask of the text strokes.
cv::Mat text_px() {
  cv::Mat strokes = cv::Mat::zeros(kFrameSize, CV_8U);
  cv::putText(strokes, "BAT 82%", kText, cv::FONT_HERSHEY_SIMPLEX, 0.7, 255, 1, cv::LINE_8);
  return strokes;
}

struct Flight {
  StaticOverlayDetector detector;
  double displacement_px = 0;
  int frames = 0;

  void fly(int count, double step_px, const std::function<void(cv::Mat&)>& draw_overlay) {
    for (int i = 0; i < count; ++i) {
      displacement_px += step_px;
      detector.update(camera_image(displacement_px, draw_overlay, frames++),
                      Eigen::Vector2d(-step_px, 0));
    }
  }
  cv::Mat valid_pixels() {
    const Frame frame = detector.masked({.grey = camera_image(displacement_px, {}, 0)});
    return frame.mask ? frame.mask->valid_pixels() : cv::Mat();
  }
};

double masked_ratio_of(const cv::Mat& valid_pixels, const cv::Mat& region) {
  return cv::countNonZero((valid_pixels == 0) & region) /
         static_cast<double>(cv::countNonZero(region));
}

TEST(StaticOverlayDetector, MasksStaticTextOnly) {
  Flight flight;
  flight.fly(30, kStep_px, draw_text);
  const cv::Mat valid_pixels = flight.valid_pixels();
  ASSERT_FALSE(valid_pixels.empty());
  const cv::Mat text = text_px();
  EXPECT_GT(masked_ratio_of(valid_pixels, text), 0.95);
  cv::Mat text_neighbourhood;
  cv::dilate(text, text_neighbourhood, cv::Mat(), {-1, -1}, 12);
  EXPECT_EQ(masked_ratio_of(valid_pixels, text_neighbourhood == 0), 0);
}

// Edges of the road move along themselves and appear static.
TEST(StaticOverlayDetector, MasksNothingWithoutOverlay) {
  Flight flight;
  flight.fly(60, kStep_px, {});
  EXPECT_TRUE(flight.valid_pixels().empty());
}

TEST(StaticOverlayDetector, DetectsNothingInHover) {
  Flight flight;
  for (int i = 0; i < 50; ++i) {
    flight.fly(1, 0.5, draw_text);
    flight.fly(1, -0.5, draw_text);
  }
  EXPECT_TRUE(flight.valid_pixels().empty());
}

TEST(StaticOverlayDetector, RemovesMaskOfVanishedOverlay) {
  Flight flight;
  flight.fly(30, kStep_px, draw_text);
  ASSERT_FALSE(flight.valid_pixels().empty());
  flight.fly(8, kStep_px, {});
  EXPECT_TRUE(flight.valid_pixels().empty());
}

TEST(StaticOverlayDetector, IgnoresIntervalsOfUnknownDisplacement) {
  Flight flight;
  for (int i = 0; i < 30; ++i) {
    flight.fly(1, kStep_px, draw_text);
    flight.detector.update(camera_image(flight.displacement_px, draw_text, i), {});
  }
  const cv::Mat valid_pixels = flight.valid_pixels();
  ASSERT_FALSE(valid_pixels.empty()) << "displacement known in every second interval";
  Flight without_displacement;
  for (int i = 0; i < 60; ++i) {
    without_displacement.detector.update(camera_image(i * kStep_px, draw_text, i), {});
  }
  EXPECT_TRUE(without_displacement.valid_pixels().empty());
}

TEST(StaticOverlayDetector, ExtendsInputMask) {
  cv::Mat input_mask(kFrameSize, CV_8U, cv::Scalar(255));
  input_mask.rowRange(200, 240) = 0;
  Frame frame{.grey = cv::Mat(kFrameSize, CV_8U, cv::Scalar(0)),
              .mask = std::make_shared<const ImageMask>(input_mask)};
  Flight flight;
  EXPECT_EQ(flight.detector.masked(frame).mask, frame.mask);
  flight.fly(30, kStep_px, draw_text);
  const cv::Mat combined_mask = flight.detector.masked(frame).mask->valid_pixels();
  EXPECT_EQ(cv::countNonZero(combined_mask.rowRange(200, 240)), 0);
  EXPECT_GT(masked_ratio_of(combined_mask, text_px()), 0.95);
  EXPECT_EQ(cv::countNonZero(input_mask.rowRange(0, 200) == 0), 0) << "input mask modified";
}

TEST(ImageMask, ComputesMaskedRatioOfRectangle) {
  cv::Mat valid_pixels(6, 8, CV_8U, cv::Scalar(255));
  valid_pixels(cv::Rect(0, 0, 4, 2)) = 0;
  const ImageMask mask(valid_pixels);
  EXPECT_DOUBLE_EQ(mask.masked_ratio(), 8.0 / 48);
  EXPECT_FLOAT_EQ(mask.masked_ratio(1.5F, 0.5F, 4, 2), 1);
  EXPECT_FLOAT_EQ(mask.masked_ratio(3.5F, 1.5F, 4, 2), 0.25F);
  EXPECT_FLOAT_EQ(mask.masked_ratio(6, 4, 3, 3), 0);
  // clipped to the image
  EXPECT_FLOAT_EQ(mask.masked_ratio(-0.5F, 0.5F, 4, 2), 1);
  EXPECT_FLOAT_EQ(mask.masked_ratio(-20, 0, 4, 4), 1);
  EXPECT_THROW(ImageMask{cv::Mat()}, InputError);
  EXPECT_THROW(ImageMask{cv::Mat(6, 8, CV_8UC3)}, InputError);
}

}  // namespace
}  // namespace stillkite
