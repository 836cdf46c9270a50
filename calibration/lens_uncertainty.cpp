#include "calibration/lens_uncertainty.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace stillkite {

double lens_sigma_px(const LensFit& fit) {
  constexpr int kColumns = 16, kRows = 12;
  const Camera& camera = fit.camera;
  const int n = fit.model.parameters();
  Eigen::MatrixXd by_lens(2 * kColumns * kRows, n);
  Eigen::MatrixXd by_rotation(2 * kColumns * kRows, 3);
  Eigen::Index row = 0;
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kRows; ++j) {
      const Eigen::Vector2d pixel((i + 0.5) * camera.width_px / kColumns - 0.5,
                                  (j + 0.5) * camera.height_px / kRows - 0.5);
      const auto point = undistort(camera, pixel);
      if (!point) continue;
      const auto at = project_with_derivatives(camera, fit.model, point->homogeneous());
      by_lens.middleRows<2>(row) = at->by_parameters;
      by_rotation.middleRows<2>(row) = at->by_point * -skew(point->homogeneous());
      row += 2;
    }
  }
  const Eigen::MatrixXd J = by_lens.topRows(row);
  const Eigen::MatrixXd A = by_rotation.topRows(row);
  const Eigen::MatrixXd rest =
      J - A * (A.transpose() * A).ldlt().solve(Eigen::MatrixXd(A.transpose() * J));
  const double sum_px2 = (rest * fit.covariance * rest.transpose()).trace();
  return std::sqrt(2 * sum_px2 / static_cast<double>(row));
}

}  // namespace stillkite
