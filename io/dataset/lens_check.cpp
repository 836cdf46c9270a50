#include "io/dataset/lens_check.hpp"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flow/image_mask.hpp"
#include "geometry/angle.hpp"
#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// Coefficients, the constant first.
using Polynomial = std::vector<double>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial out(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) out[i + j] += a[i] * b[j];
  }
  return out;
}

// Smallest positive root by the eigenvalues of the companion matrix; infinity without one.
double smallest_positive_root(Polynomial p) {
  constexpr double kMaxImaginaryRatio = 1e-6;
  while (p.size() > 1 && std::abs(p.back()) < 1e-12) p.pop_back();
  const auto n = static_cast<Eigen::Index>(p.size()) - 1;
  double smallest = std::numeric_limits<double>::infinity();
  if (n < 1) return smallest;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Eigen::Index i = 0; i < n; ++i) {
    companion(i, n - 1) = -p[static_cast<std::size_t>(i)] / p.back();
  }
  const Eigen::VectorXcd roots = companion.eigenvalues();
  for (const std::complex<double>& root : roots) {
    const bool is_real = std::abs(root.imag()) <= kMaxImaginaryRatio * std::abs(root.real());
    if (is_real && root.real() > 0) smallest = std::min(smallest, root.real());
  }
  return smallest;
}

// Radius in the plane z = 1 up to which the image radius is increasing and finite.
double fold_radius(const Camera& camera) {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = camera.coefficients;
  if (camera.distortion == DistortionModel::equidistant) {
    // image radius = theta (1 + c1 u + c2 u^2 + ...), u = theta^2
    const auto& c = camera.coefficients;
    const double theta =
        std::sqrt(smallest_positive_root({1, 3 * c[0], 5 * c[1], 7 * c[2], 9 * c[3]}));
    return theta < std::numbers::pi / 2 ? std::tan(theta) : std::numeric_limits<double>::infinity();
  }
  // image radius = r N(u) / D(u), u = r^2; its derivative has the sign of (N + 2 u N') D - 2 u N D'
  const Polynomial D{1, k4, k5, k6};
  Polynomial derivative = product({1, 3 * k1, 5 * k2, 7 * k3}, D);
  const Polynomial other = product({1, k1, k2, k3}, {0, 2 * k4, 4 * k5, 6 * k6});
  for (std::size_t i = 0; i < other.size(); ++i) derivative[i] -= other[i];
  return std::sqrt(std::min(smallest_positive_root(D), smallest_positive_root(derivative)));
}

// The tangential part may fold where the radial one does not.
bool is_one_to_one_up_to(const Camera& camera, const Eigen::Vector2d& point) {
  constexpr int kSteps = 20;
  for (int i = 1; i <= kSteps; ++i) {
    if (!(distort(camera, point * i / kSteps).jacobian.determinant() > 0)) return false;
  }
  return true;
}

bool is_covered(const Camera& camera, const Eigen::Vector2d& pixel, double fold) {
  if (camera.distortion == DistortionModel::equidistant) {
    const Eigen::Vector2d centre(camera.centre_x_px, camera.centre_y_px);
    const Eigen::Array2d focal(camera.focal_x_px, camera.focal_y_px);
    const Eigen::Vector2d image = ((pixel - centre).array() / focal).matrix();
    if (std::isinf(fold) || image.isZero(0)) return true;
    const Eigen::Vector2d at_fold = distort(camera, fold * image.normalized()).pixel - centre;
    return image.norm() < (at_fold.array() / focal).matrix().norm();
  }
  const std::optional<Eigen::Vector2d> point = undistort(camera, pixel);
  return point && point->norm() < fold && is_one_to_one_up_to(camera, *point);
}

}  // namespace

void check_lens(const Camera& camera, const ImageMask* mask, const std::string& origin) {
  if (camera.distortion == DistortionModel::none) return;
  constexpr int kSteps = 64;  // along each side
  const double fold = fold_radius(camera);
  for (int i = 0; i <= kSteps * (kSteps + 2); ++i) {
    const int x = (camera.width_px - 1) * (i % (kSteps + 1)) / kSteps;
    const int y = (camera.height_px - 1) * (i / (kSteps + 1)) / kSteps;
    if (mask != nullptr && mask->valid_pixels().at<unsigned char>(y, x) == 0) continue;
    if (is_covered(camera, Eigen::Vector2d(x, y), fold)) continue;
    throw InputError(fmt::format(
        "{}: the {} lens model is not monotonic over the image: it folds{} before pixel ({}, {}); "
        "calibrate with views of the board up to the corners or with fewer coefficients, or mask "
        "that part of the image (calibration.mask_path)",
        origin, name_of(camera.distortion),
        std::isinf(fold)
            ? ""
            : fmt::format(" {:.1f} deg off the optical axis", std::atan(fold) / kDegree),
        x, y));
  }
}

}  // namespace stillkite
