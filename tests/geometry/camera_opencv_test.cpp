// Lens models against OpenCV's implementations.
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "geometry/camera.hpp"
#include "tests/geometry/sample_cameras.hpp"

namespace stillkite {
namespace {

class CameraAgainstOpenCv : public testing::TestWithParam<SampleCamera> {};

INSTANTIATE_TEST_SUITE_P(Samples, CameraAgainstOpenCv, testing::ValuesIn(sample_cameras()),
                         [](const auto& sample) { return sample.param.name; });

std::vector<cv::Point2d> project_with_opencv(const Camera& camera,
                                             const std::vector<cv::Point3d>& points) {
  const cv::Matx33d K(camera.focal_x_px, 0, camera.centre_x_px, 0, camera.focal_y_px,
                      camera.centre_y_px, 0, 0, 1);
  const cv::Vec3d none(0, 0, 0);
  std::vector<cv::Point2d> pixels;
  const auto& c = camera.coefficients;
  if (camera.distortion == DistortionModel::equidistant) {
    cv::fisheye::projectPoints(points, pixels, none, none, K, cv::Vec4d(c[0], c[1], c[2], c[3]));
  } else {
    cv::projectPoints(points, none, none, K, std::vector<double>(c.begin(), c.end()), pixels);
  }
  return pixels;
}

TEST_P(CameraAgainstOpenCv, ProjectsToSamePixel) {
  const Camera& camera = GetParam().camera;
  std::vector<cv::Point3d> points;
  for (const Eigen::Vector2d& p : points_in_view(camera)) {
    points.emplace_back(4.0 * p.x(), 4.0 * p.y(), 4.0);
  }
  const std::vector<cv::Point2d> expected = project_with_opencv(camera, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<Eigen::Vector2d> pixel =
        project(camera, {points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[i].x, 1e-7);
    EXPECT_NEAR(pixel->y(), expected[i].y, 1e-7);
  }
}

}  // namespace
}  // namespace stillkite
