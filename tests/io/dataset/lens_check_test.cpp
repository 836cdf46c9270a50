#include "io/dataset/lens_check.hpp"

#include <cmath>
#include <opencv2/core/mat.hpp>

#include "flow/image_mask.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

// Corners at 200 px from the principal point, at `corner` in units of the focal length.
Camera camera_with(DistortionModel model, std::array<double, 8> coefficients, double corner) {
  return {.width_px = 321,
          .height_px = 241,
          .focal_x_px = 200 / corner,
          .focal_y_px = 200 / corner,
          .centre_x_px = 160,
          .centre_y_px = 120,
          .distortion = model,
          .coefficients = coefficients};
}

std::string lens_error(const Camera& camera, const ImageMask* mask = nullptr) {
  const TemporaryFolder folder;
  return input_error_of(folder, [&] { check_lens(camera, mask, "c.yaml"); });
}

// r (1 - r^2/2) increases up to r = sqrt(2/3), where it is 0.5443.
TEST(LensCheck, RejectsRadialModelThatFoldsInsideTheImage) {
  const auto error = [](double corner) {
    return lens_error(camera_with(DistortionModel::radial_tangential, {-0.5}, corner));
  };
  EXPECT_EQ(error(0.53), "accepted");
  EXPECT_NE(error(0.55).find("folds 39.2 deg off the optical axis before pixel (0, 0)"),
            std::string::npos)
      << error(0.55);
}

// theta (1 - theta^2/3) increases up to 1 rad, where it is 2/3.
TEST(LensCheck, RejectsEquidistantModelThatFoldsInsideTheImage) {
  const auto error = [](double corner) {
    return lens_error(camera_with(DistortionModel::equidistant, {-1.0 / 3}, corner));
  };
  EXPECT_EQ(error(0.66), "accepted");
  EXPECT_NE(error(0.67).find("folds 57.3 deg"), std::string::npos) << error(0.67);
  // beyond 90 degrees the lens sees, the camera model does not
  EXPECT_EQ(lens_error(camera_with(DistortionModel::equidistant, {0.01}, 1.9)), "accepted");
}

// The pole of (1 + k1 r^2) / (1 + k4 r^2) at r = 0.55 is narrower than a pixel. The image radius
// has its maximum, 0.533, at r = 0.541.
TEST(LensCheck, RejectsNarrowPoleInsideTheImage) {
  const auto error = [](double corner) {
    const double k4 = -1 / (0.55 * 0.55);
    return lens_error(camera_with(DistortionModel::radial_tangential,
                                  {1.0005 * k4, 0, 0, 0, 0, k4, 0, 0}, corner));
  };
  EXPECT_NE(error(0.83).find("not monotonic"), std::string::npos);
  EXPECT_EQ(error(0.53), "accepted");
  EXPECT_NE(error(0.54).find("folds 28.4 deg"), std::string::npos) << error(0.54);
}

TEST(LensCheck, RejectsTangentialFold) {
  const auto error = [](double p1) {
    return lens_error(camera_with(DistortionModel::radial_tangential, {0, 0, p1}, 0.8));
  };
  EXPECT_EQ(error(0.01), "accepted");
  EXPECT_NE(error(0.5).find("not monotonic"), std::string::npos);
}

TEST(LensCheck, AcceptsFoldBehindTheMask) {
  const Camera camera = camera_with(DistortionModel::radial_tangential, {-0.5}, 0.6);
  EXPECT_NE(lens_error(camera), "accepted");
  cv::Mat valid(241, 321, CV_8UC1);
  for (int y = 0; y < valid.rows; ++y) {
    for (int x = 0; x < valid.cols; ++x) {
      valid.at<unsigned char>(y, x) = std::hypot(x - 160, y - 120) < 178 ? 255 : 0;
    }
  }
  const ImageMask mask(valid);
  EXPECT_EQ(lens_error(camera, &mask), "accepted");
}

}  // namespace
}  // namespace stillkite
