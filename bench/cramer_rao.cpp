#include "cramer_rao.hpp"

#include <Eigen/Cholesky>

#include "estimation/ego_motion/motion_field.hpp"

namespace stillkite::bench {

Matrix6d cramer_rao_bound(const BenchScene& scene, double noise_grey) {
  const cv::Mat& image = scene.previous;
  Matrix6d information = Matrix6d::Zero();
  for (int y = 1; y + 1 < image.rows; ++y) {
    for (int x = 1; x + 1 < image.cols; ++x) {
      const Eigen::RowVector2d gradient(
          0.5 * (image.at<float>(y, x + 1) - image.at<float>(y, x - 1)),
          0.5 * (image.at<float>(y + 1, x) - image.at<float>(y - 1, x)));
      const Camera& camera = scene.camera;  // without distortion
      const Eigen::Vector2d bearing((x - camera.centre_x_px) / camera.focal_x_px,
                                    (y - camera.centre_y_px) / camera.focal_y_px);
      const Vector6d row = (gradient * motion_field_px(camera, scene.ground, bearing)).transpose() *
                           scene.interval_s;
      information.noalias() += row * row.transpose();
    }
  }
  information /= 2 * noise_grey * noise_grey;
  return information.ldlt().solve(Matrix6d::Identity());
}

}  // namespace stillkite::bench
