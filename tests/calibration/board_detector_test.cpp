#include "calibration/board_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "board_scene.hpp"
#include "calibration/lens_fit.hpp"

namespace stillkite {
namespace {

constexpr LensModel kPinhole{};

Camera pinhole() {
  return {.width_px = 640,
          .height_px = 480,
          .focal_x_px = 500,
          .focal_y_px = 500,
          .centre_x_px = 319.5,
          .centre_y_px = 239.5};
}

BoardConfig board_of(BoardType type) {
  switch (type) {
    case BoardType::checkerboard:
      return {};
    case BoardType::charuco:
      return {.type = type, .columns = 8, .rows = 6};
    case BoardType::aprilgrid:
      return {.type = type, .columns = 4, .rows = 3, .square_m = 0.06};
  }
  return {};
}

class EachBoard : public testing::TestWithParam<BoardType> {};

// The pose absorbs a shift of the whole board: LensCalibration's centre shows one.
TEST_P(EachBoard, CornersAgreeWithTheRenderedLens) {
  const BoardScene scene{.board = board_of(GetParam()), .camera = pinhole(), .views = 6};
  const BoardDetector detector(scene.board);
  int found = 0;
  double sum_px2 = 0, components = 0;
  for (const cv::Mat& image : render_board_views(scene, 1)) {
    const auto view = detector.detect(image);
    if (!view) continue;
    const auto pose = board_pose(*view, kPinhole, scene.camera);
    ASSERT_TRUE(pose);
    ++found;
    sum_px2 += pose->squared_error_px2;
    components += 2 * static_cast<double>(view->pixels.size());
  }
  EXPECT_GE(found, 4);
  EXPECT_LT(std::sqrt(sum_px2 / components), 0.08);
}

TEST_P(EachBoard, IsNotFoundInAnEmptyImage) {
  EXPECT_FALSE(
      BoardDetector(board_of(GetParam())).detect(cv::Mat(480, 640, CV_8UC1, cv::Scalar(90))));
}

INSTANTIATE_TEST_SUITE_P(Types, EachBoard,
                         testing::Values(BoardType::checkerboard, BoardType::charuco,
                                         BoardType::aprilgrid),
                         [](const auto& type) { return std::string(name_of(type.param)); });

TEST(BoardDetector, RejectsBoardsWithMoreMarkersThanTheDictionary) {
  EXPECT_THROW(BoardDetector({.type = BoardType::charuco,
                              .columns = 20,
                              .rows = 20,
                              .dictionary = MarkerDictionary::d4x4_50}),
               InputError);
}

}  // namespace
}  // namespace stillkite
