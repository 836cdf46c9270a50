#include "estimation/ego_motion/flow_rows.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

std::size_t cell_of(const Camera& camera, const Eigen::Vector2f& pixel) {
  const auto index = [](float position, int size, int cells) {
    const float ratio = (position + 0.5F) / static_cast<float>(size);
    return std::clamp(static_cast<int>(ratio * static_cast<float>(cells)), 0, cells - 1);
  };
  const int row = index(pixel.y(), camera.height_px, kCellRows);
  const int column = index(pixel.x(), camera.width_px, kCellColumns);
  return static_cast<std::size_t>(row) * kCellColumns + static_cast<std::size_t>(column);
}

// Larger eigenvalue of the information matrix; 0 if it is not positive and finite.
double max_information(const FlowVector& vector) {
  const double half_trace = 0.5 * (vector.information_xx + vector.information_yy);
  const double half_difference = 0.5 * (vector.information_xx - vector.information_yy);
  const double xy = vector.information_xy;
  const double eigenvalue = half_trace + std::sqrt(half_difference * half_difference + xy * xy);
  return eigenvalue > 0 && std::isfinite(eigenvalue) ? eigenvalue : 0.0;
}

}  // namespace

void FlowRows::resize(std::size_t size) {
  for (std::vector<double>* column :
       {&x, &y, &inverse_depth, &flow_x, &flow_y, &gxx, &gxy, &gyy, &max_information}) {
    column->assign(size, 0.0);
  }
}

void FlowRows::clear_row(std::size_t row) {
  for (std::vector<double>* column : {&flow_x, &flow_y, &gxx, &gxy, &gyy, &max_information}) {
    (*column)[row] = 0.0;
  }
}

bool FlowRowMaker::is_cached(std::span<const FlowVector> vectors) const {
  return std::equal(vectors.begin(), vectors.end(), rays_.begin(), rays_.end(),
                    [](const FlowVector& v, const Ray& ray) { return v.pixel == ray.pixel; });
}

void FlowRowMaker::cache_rays(std::span<const FlowVector> vectors) {
  rays_.assign(vectors.size(), {});
  std::array<std::size_t, kCells> count{};
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    Ray& ray = rays_[i];
    ray.pixel = vectors[i].pixel;
    if (!ray.pixel.allFinite()) continue;
    const auto bearing = undistort(camera_, ray.pixel.cast<double>());
    if (!bearing) continue;
    ray.valid = true;
    ray.bearing = *bearing;
    ray.pixel_by_bearing = distort(camera_, *bearing).jacobian;
    ray.bearing_by_pixel = ray.pixel_by_bearing.inverse();
    ray.row = count[cell_of(camera_, ray.pixel)]++;
  }
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    constexpr std::size_t kPadding = FlowRows::kPadding;
    const std::size_t padded = (count[cell] + kPadding - 1) / kPadding * kPadding;
    rows_.cell_begin[cell + 1] = rows_.cell_begin[cell] + padded;
  }
  rows_.resize(rows_.cell_begin.back());
  for (Ray& ray : rays_) {
    if (!ray.valid) continue;
    ray.row += rows_.cell_begin[cell_of(camera_, ray.pixel)];
    rows_.x[ray.row] = ray.bearing.x();
    rows_.y[ray.row] = ray.bearing.y();
  }
}

const FlowRows& FlowRowMaker::make(std::span<const FlowVector> vectors, const GroundPlane& ground,
                                   double dt_s, bool use_information) {
  if (!is_cached(vectors)) cache_rays(vectors);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const FlowVector& vector = vectors[i];
    const Ray& ray = rays_[i];
    if (!ray.valid) continue;
    const double information = max_information(vector);
    if (!vector.flow_px.allFinite() || information == 0) {
      rows_.clear_row(ray.row);
      continue;
    }
    Eigen::Matrix2d G = Eigen::Matrix2d::Identity();
    if (use_information) {
      G << vector.information_xx, vector.information_xy, vector.information_xy,
          vector.information_yy;
    }
    const Eigen::Matrix2d& J = ray.pixel_by_bearing;
    const Eigen::Matrix2d rate_information = dt_s * dt_s * J.transpose() * G * J;
    const Eigen::Vector2d flow = ray.bearing_by_pixel * (vector.flow_px.cast<double>() / dt_s);
    rows_.inverse_depth[ray.row] = std::max(0.0, inverse_depth(ground, ray.bearing));
    rows_.flow_x[ray.row] = flow.x();
    rows_.flow_y[ray.row] = flow.y();
    rows_.gxx[ray.row] = rate_information(0, 0);
    rows_.gxy[ray.row] = rate_information(0, 1);
    rows_.gyy[ray.row] = rate_information(1, 1);
    rows_.max_information[ray.row] = use_information ? information : 1.0;
  }
  return rows_;
}

}  // namespace stillkite
