#include "app/board_calibration.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "board_scene.hpp"
#include "io/dataset/calibration.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

const Camera kLens{.width_px = 640,
                   .height_px = 480,
                   .focal_x_px = 460,
                   .focal_y_px = 461,
                   .centre_x_px = 322,
                   .centre_y_px = 236,
                   .distortion = DistortionModel::radial_tangential,
                   .coefficients = {-0.2, 0.05, 4e-4, -3e-4}};

BoardScene charuco_scene(int views) {
  return {.board = {.type = BoardType::charuco, .columns = 8, .rows = 6},
          .camera = kLens,
          .views = views};
}

CalibrateConfig write_images(const BoardScene& scene, const fs::path& folder) {
  fs::create_directories(folder);
  int number = 0;
  for (const cv::Mat& image : render_board_views(scene, 3)) {
    cv::imwrite((folder / fmt::format("view_{:03}.png", number++)).string(), image);
  }
  CalibrateConfig config{.calibration_board = scene.board};
  config.run.source.path = folder;
  return config;
}

TEST(BoardCalibration, WritesACalibrationThatARunReads) {
  const TemporaryFolder folder;
  const CalibrateConfig config = write_images(charuco_scene(40), folder.path() / "images");
  const fs::path out = folder.path() / "lens";
  const nlohmann::json result = calibrate_by_board(config, "board", out);
  const Camera camera = read_calibration(out / "sensor.yaml").camera;
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_NEAR(camera.focal_x_px, kLens.focal_x_px, 0.001 * kLens.focal_x_px);
  EXPECT_NEAR(camera.focal_y_px, kLens.focal_y_px, 0.001 * kLens.focal_y_px);
  EXPECT_NEAR(camera.centre_x_px, kLens.centre_x_px, 1);
  EXPECT_NEAR(camera.centre_y_px, kLens.centre_y_px, 1);
  EXPECT_LT(result["lens_sigma_px"].get<double>(), 0.3);
  EXPECT_EQ(result["views"]["frames"], 40);
  EXPECT_TRUE(fs::exists(out / "report.html"));
}

TEST(BoardCalibration, RefusesAnUnseenCornerOfTheImage) {
  const TemporaryFolder folder;
  BoardScene scene = charuco_scene(30);
  scene.in_upper_left_half = true;
  CalibrateConfig config = write_images(scene, folder.path() / "images");
  const fs::path out = folder.path() / "lens";
  try {
    (void)calibrate_by_board(config, "board", out);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("lower right"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(fs::exists(out));
  config.calibration_board->allow_unseen_corners = true;
  const nlohmann::json result = calibrate_by_board(config, "board", out);
  EXPECT_FALSE(result["unseen_corners"].empty());
}

TEST(BoardCalibration, RefusesImagesWithoutTheBoard) {
  const TemporaryFolder folder;
  CalibrateConfig config = write_images(charuco_scene(3), folder.path() / "images");
  config.calibration_board->dictionary = MarkerDictionary::d4x4_50;
  EXPECT_THROW((void)calibrate_by_board(config, "board", folder.path() / "lens"), InputError);
}

}  // namespace
}  // namespace stillkite
