#include "flow/static_overlay_detector.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flow/image_mask.hpp"
#include "geometry/fields.hpp"

namespace stillkite {
namespace {

const cv::Size kImage(320, 240);
const cv::Point kText(40, 60);
constexpr double kStep_px = 5;

// Noise of a few sizes, and a straight road along x.
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

// The camera's noise and all; what it has flown over so far.
cv::Mat seen(double way_px, const std::function<void(cv::Mat&)>& paint, int noise_seed) {
  static const cv::Mat kGround = ground();
  cv::Mat image;
  const cv::Matx23d shift(1, 0, -way_px, 0, 1, 0);
  cv::warpAffine(kGround, image, shift, kImage, cv::INTER_LINEAR);
  if (paint) paint(image);
  cv::Mat noise(image.size(), CV_16S), noisy;
  cv::RNG random(static_cast<std::uint64_t>(noise_seed) + 1);
  random.fill(noise, cv::RNG::NORMAL, 0, 2);
  image.convertTo(noisy, CV_16S);
  noisy += noise;
  noisy.convertTo(image, CV_8U);
  return image;
}

void write_text(cv::Mat& image) {
  cv::putText(image, "BAT 82%", kText, cv::FONT_HERSHEY_SIMPLEX, 0.7, 0, 3, cv::LINE_AA);
  cv::putText(image, "BAT 82%", kText, cv::FONT_HERSHEY_SIMPLEX, 0.7, 255, 1, cv::LINE_AA);
}

// Where the text's strokes are.
cv::Mat text_px() {
  cv::Mat strokes = cv::Mat::zeros(kImage, CV_8U);
  cv::putText(strokes, "BAT 82%", kText, cv::FONT_HERSHEY_SIMPLEX, 0.7, 255, 1, cv::LINE_8);
  return strokes;
}

struct Flown {
  StaticOverlayDetector finder;
  double way_px = 0;
  int frames = 0;

  void on(int count, double step_px, const std::function<void(cv::Mat&)>& paint) {
    for (int i = 0; i < count; ++i) {
      way_px += step_px;
      finder.learn(seen(way_px, paint, frames++), Eigen::Vector2d(-step_px, 0));
    }
  }
  cv::Mat shows_world() {
    const Frame frame = finder.masked({.grey = seen(way_px, {}, 0)});
    return frame.mask ? frame.mask->shows_world() : cv::Mat();
  }
};

double ratio_hidden(const cv::Mat& shows_world, const cv::Mat& where) {
  return cv::countNonZero((shows_world == 0) & where) /
         static_cast<double>(cv::countNonZero(where));
}

TEST(StaticOverlayDetector, HidesTextThatStaysAndNothingElse) {
  Flown flown;
  flown.on(30, kStep_px, write_text);
  const cv::Mat shows_world = flown.shows_world();
  ASSERT_FALSE(shows_world.empty());
  const cv::Mat text = text_px();
  EXPECT_GT(ratio_hidden(shows_world, text), 0.95);
  cv::Mat away_from_it;
  cv::dilate(text, away_from_it, cv::Mat(), {-1, -1}, 12);
  EXPECT_EQ(ratio_hidden(shows_world, away_from_it == 0), 0);
}

// The road's edges move along themselves, and look still.
TEST(StaticOverlayDetector, HidesNothingWhereNothingIsFixed) {
  Flown flown;
  flown.on(60, kStep_px, {});
  EXPECT_TRUE(flown.shows_world().empty());
}

TEST(StaticOverlayDetector, LearnsNothingWhileTheCameraHovers) {
  Flown flown;
  for (int i = 0; i < 50; ++i) {
    flown.on(1, 0.5, write_text);
    flown.on(1, -0.5, write_text);
  }
  EXPECT_TRUE(flown.shows_world().empty());
}

TEST(StaticOverlayDetector, ShowsAgainWhatIsNoLongerThere) {
  Flown flown;
  flown.on(30, kStep_px, write_text);
  ASSERT_FALSE(flown.shows_world().empty());
  flown.on(8, kStep_px, {});
  EXPECT_TRUE(flown.shows_world().empty());
}

TEST(StaticOverlayDetector, CountsNothingOverAMotionThatIsNotKnown) {
  Flown flown;
  for (int i = 0; i < 30; ++i) {
    flown.on(1, kStep_px, write_text);
    flown.finder.learn(seen(flown.way_px, write_text, i), {});
  }
  const cv::Mat shows_world = flown.shows_world();
  ASSERT_FALSE(shows_world.empty()) << "every second interval is known";
  Flown unknown;
  for (int i = 0; i < 60; ++i) unknown.finder.learn(seen(i * kStep_px, write_text, i), {});
  EXPECT_TRUE(unknown.shows_world().empty());
}

TEST(StaticOverlayDetector, AddsToTheMaskThatIsGiven) {
  cv::Mat given(kImage, CV_8U, cv::Scalar(255));
  given.rowRange(200, 240) = 0;
  Frame frame{.grey = cv::Mat(kImage, CV_8U, cv::Scalar(0)),
              .mask = std::make_shared<const ImageMask>(given)};
  Flown flown;
  EXPECT_EQ(flown.finder.masked(frame).mask, frame.mask);
  flown.on(30, kStep_px, write_text);
  const cv::Mat together = flown.finder.masked(frame).mask->shows_world();
  EXPECT_EQ(cv::countNonZero(together.rowRange(200, 240)), 0);
  EXPECT_GT(ratio_hidden(together, text_px()), 0.95);
  EXPECT_EQ(cv::countNonZero(given.rowRange(0, 200) == 0), 0) << "the one given has changed";
}

TEST(ImageMask, TellsWhichShareOfAWindowIsHidden) {
  cv::Mat shows_world(6, 8, CV_8U, cv::Scalar(255));
  shows_world(cv::Rect(0, 0, 4, 2)) = 0;
  const ImageMask mask(shows_world);
  EXPECT_DOUBLE_EQ(mask.hidden_ratio(), 8.0 / 48);
  EXPECT_FLOAT_EQ(mask.hidden_ratio(1.5F, 0.5F, 4, 2), 1);
  EXPECT_FLOAT_EQ(mask.hidden_ratio(3.5F, 1.5F, 4, 2), 0.25F);
  EXPECT_FLOAT_EQ(mask.hidden_ratio(6, 4, 3, 3), 0);
  // of what lies in the image
  EXPECT_FLOAT_EQ(mask.hidden_ratio(-0.5F, 0.5F, 4, 2), 1);
  EXPECT_FLOAT_EQ(mask.hidden_ratio(-20, 0, 4, 4), 1);
  EXPECT_THROW(ImageMask{cv::Mat()}, InputError);
  EXPECT_THROW(ImageMask{cv::Mat(6, 8, CV_8UC3)}, InputError);
}

}  // namespace
}  // namespace stillkite
