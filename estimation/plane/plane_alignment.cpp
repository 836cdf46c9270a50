#include "estimation/plane/plane_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/lens_error.hpp"
#include "estimation/plane/smooth_residual.hpp"
#include "geometry/camera.hpp"

namespace stillkite {
namespace {

constexpr int kClustersAcross = PlaneObservations::kClustersAcross;
constexpr int kClustersDown = PlaneObservations::kClusters / kClustersAcross;

// Maximum displacement of a tile corner by deformation for the first-order warp.
constexpr float kMaxFirstOrderDeformation_px = 1.2F;

// Maximum Lucas-Kanade steps of a level.
constexpr int max_steps(int level) {
  return level == 0 ? 1 : 2;
}
// Convergence threshold of a step.
constexpr double kConverged_px = 0.05;

float row_delay_s(const Camera& camera, const RollingShutter& shutter, float row_px) {
  return static_cast<float>(row_time_offset_s(shutter.readout_s, row_px, camera.height_px));
}

int cell(float position, int size, int cells) {
  const float at = position * static_cast<float>(cells) / static_cast<float>(size);
  return std::clamp(static_cast<int>(at), 0, cells - 1);
}

}  // namespace

PlaneAligner::PlaneAligner(const Camera& camera, const PlaneAlignmentConfig& config)
    : config_(config), solver_(config.solver) {
  const int count = pyramid_levels(camera.width_px, camera.height_px, config.levels);
  Camera at = camera;
  for (int i = 0; i < count; ++i) {
    Level level{
        at, make_tile_grid(at.width_px, at.height_px, config.tile_columns, config.tile_rows),
        {}, {},
        {}, {}};
    level.rays = make_tile_rays(at, level.grid);
    for (std::size_t k = 0; k < level.grid.centre_x_px.size(); ++k) {
      level.cluster.push_back(cell(level.grid.centre_y_px[k], at.height_px, kClustersDown) *
                                  kClustersAcross +
                              cell(level.grid.centre_x_px[k], at.width_px, kClustersAcross));
    }
    levels_.push_back(std::move(level));
    at = half_resolution(at);
  }
}

PlaneObservations PlaneAligner::observations(const Level& level) const {
  return {jacobian_, *measurements_, level.cluster,
          static_cast<float>(level.grid.columns * level.grid.rows)};
}

void PlaneAligner::set_reference(Pyramid& pyramid) {
  std::swap(reference_, pyramid);
  for (Level& level : levels_) level.textures.reset(level.grid);
}

void PlaneAligner::set_mask(const std::shared_ptr<const ImageMask>& mask) {
  if (mask == mask_) return;
  mask_ = mask;
  for (std::size_t l = 0; mask_ && l < levels_.size(); ++l) {
    const TileGrid& grid = levels_[l].grid;
    levels_[l].masked.resize(grid.centre_x_px.size());
    for (std::size_t i = 0; i < grid.centre_x_px.size(); ++i) {
      const bool masked =
          is_masked(grid, static_cast<int>(l), grid.centre_x_px[i], grid.centre_y_px[i]);
      levels_[l].masked[i] = masked ? 1 : 0;
    }
  }
}

bool PlaneAligner::is_masked(const TileGrid& grid, int level, float x_px, float y_px) const {
  constexpr float kMaxMaskedRatio = 0.1F;
  const float scale_factor = std::ldexp(1.0F, level);
  // pixel i of the full image covers [i - 0.5, i + 0.5)
  const auto full_resolution = [&](float px) { return (px + 0.5F) * scale_factor - 0.5F; };
  return mask_->masked_ratio(full_resolution(x_px), full_resolution(y_px),
                             scale_factor * static_cast<float>(grid.columns),
                             scale_factor * static_cast<float>(grid.rows)) > kMaxMaskedRatio;
}

// Masked in the reference or in the current image.
void PlaneAligner::reject_masked(int level) {
  if (!mask_) return;
  const Level& at = levels_[static_cast<std::size_t>(level)];
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    if (placement_.x_px[i] < 0) continue;
    if (at.masked[i] != 0 || is_masked(at.grid, level, placement_.x_px[i], placement_.y_px[i])) {
      placement_.x_px[i] = placement_.y_px[i] = TilePlacement::kOutside_px;
    }
  }
}

PlaneAlignment PlaneAligner::align(const Pyramid& current, const PlaneMotion& initial,
                                   const TiltPrior& tilt, const RollingShutter& shutter,
                                   const SmoothErrors& smooth) {
  PlaneAlignment out{.motion = initial, .shutter = shutter};
  const bool rolling_shutter = shutter.readout_s > 0;
  const int levels =
      std::min({static_cast<int>(levels_.size()), reference_.levels(), current.levels()});
  PlaneSolution solution;
  for (int l = levels - 1; l >= 0; --l) {
    Level& level = levels_[static_cast<std::size_t>(l)];
    const TileRays& rays =
        rolling_shutter ? rays_at_stamp(level, out.motion.normal, shutter) : level.rays;
    for (int s = 0; s < max_steps(l); ++s) {
      // 1. place the tiles by the current motion
      place_tiles(level.camera, rays, out.motion, tilt.axes, placement_, jacobian_);
      if (rolling_shutter) {
        place_tiles(level.camera, rays, out.motion, tilt.axes, placement_, jacobian_,
                    &row_times(level.camera, shutter));
      }
      reject_masked(l);
      // 2. Lucas-Kanade per tile, in information form
      const bool exact =
          config_.exact_warp && deformation_px(level.grid) > kMaxFirstOrderDeformation_px;
      const TileOptions options{.quintic = l == 0, .contrast = l > 0 && s == 0};
      measurements_ = &tile_flow_.measure(reference_.level(l), current.level(l), level.grid,
                                          placement_, exact ? TileWarp::affine : TileWarp::shift,
                                          static_cast<float>(out.gain), options, level.textures);
      // 3. Gauss-Newton step of the motion
      solution = solver_.solve(observations(level), tilt, out.tilt_rad,
                               smooth_sigma_rad(level, out.motion, smooth));
      out.solvable = solution.ok;
      if (!solution.ok) break;
      if (l == 1 && s == 0) out.deviation_px = 2 * solver_.deviation_px(observations(level));
      if (l > 0 && s == 0) {  // the finest level within the range of Lucas-Kanade, or the coarsest
        const auto relief = measure_relief(observations(level), solution, out.motion.translation);
        if (relief && (!out.relief || is_in_range(*relief, smooth.relief_ratio)))
          out.relief = relief;
      }
      out.motion = apply(out.motion, solution.step, tilt.axes);
      out.tilt_rad += solution.step.tail<2>();
      if (options.contrast || exact) match_brightness(out, l > 0);
      out.last_update_px = update_px(level, solution.step);
      if (out.last_update_px < kConverged_px) break;
    }
  }
  if (out.solvable) {
    assess(solution,
           smooth_sigma_rad(levels_.front(), out.motion, {.lens_sigma_px = smooth.lens_sigma_px}),
           out);
  }
  if (out.solvable && rolling_shutter) out.motion_by_twist = motion_by_twist(solution);
  return out;
}

// Bearings of the keyframe's tiles, reduced to its stamp. At row delay t the camera has moved by t
// v and the ground is nearer by t n.v (in heights at the stamp):
//   b' = R b + t v (n . R b) / (1 - t n.v),   R b = b + t w x b
const TileRays& PlaneAligner::rays_at_stamp(const Level& level, const Eigen::Vector3d& normal,
                                            const RollingShutter& shutter) {
  const Eigen::Vector3f n = normal.cast<float>();
  const Eigen::Vector3f v = shutter.reference_twist.head<3>().cast<float>();
  const Eigen::Vector3f w = shutter.reference_twist.tail<3>().cast<float>();
  rays_ = level.rays;
  for (std::size_t i = 0; i < rays_.x.size(); ++i) {
    const float t = row_delay_s(level.camera, shutter, level.grid.centre_y_px[i]);
    const Eigen::Vector3f bearing(rays_.x[i], rays_.y[i], 1);
    const Eigen::Vector3f rotated = bearing + t * w.cross(bearing);
    const float inverse_depth = std::max(0.0F, n.dot(rotated)) / (1 - t * n.dot(v));
    const Eigen::Vector3f at_stamp = rotated + t * inverse_depth * v;
    rays_.x[i] = at_stamp.x() / at_stamp.z();
    rays_.y[i] = at_stamp.y() / at_stamp.z();
  }
  return rays_;
}

// A tile with image velocity dy/dt is exposed at t = s (y + t dy/dt - middle). Unused for tiles
// outside the image.
const TileTimes& PlaneAligner::row_times(const Camera& camera, const RollingShutter& shutter) {
  const auto readout_s = static_cast<float>(shutter.readout_s);
  const float s_per_row = readout_s / static_cast<float>(camera.height_px);
  times_.twist = shutter.current_twist;
  times_.row_delay_s.resize(placement_.y_px.size());
  for (std::size_t i = 0; i < times_.row_delay_s.size(); ++i) {
    float speed_px_s = 0;
    for (int a = 0; a < 6; ++a) {
      speed_px_s -= static_cast<float>(shutter.current_twist[a]) * jacobian_.y(a)[i];
    }
    const float t = row_delay_s(camera, shutter, placement_.y_px[i]) / (1 - s_per_row * speed_px_s);
    times_.row_delay_s[i] = std::clamp(t, -readout_s, readout_s);
  }
  return times_;
}

float PlaneAligner::deformation_px(const TileGrid& grid) const {
  float max_px = 0;
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    if (placement_.x_px[i] < 0) continue;
    const float across = std::max(std::abs(placement_.axx[i] - 1), std::abs(placement_.ayx[i]));
    const float down = std::max(std::abs(placement_.axy[i]), std::abs(placement_.ayy[i] - 1));
    max_px = std::max(
        max_px, across * static_cast<float>(grid.columns) + down * static_cast<float>(grid.rows));
  }
  return 0.5F * max_px;
}

// Lens: the error e(x) of the calibration is a smooth field in both images, so that a displacement
// u leaves e(x + u) - e(x), of variance 2 sigma^2 (1 - exp(-u^2 / (2 L^2))) for a Gaussian field of
// correlation length L. Relief: kLinearRatio times the residuals' part of the translation's flow.
double PlaneAligner::smooth_sigma_rad(const Level& level, const PlaneMotion& motion,
                                      const SmoothErrors& smooth) const {
  const Eigen::Vector3f t = motion.translation.cast<float>();
  double shift2 = 0, parallax2 = 0;
  int count = 0;
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    if (placement_.x_px[i] < 0) continue;
    const float dx = placement_.x_px[i] - level.grid.centre_x_px[i];
    const float dy = placement_.y_px[i] - level.grid.centre_y_px[i];
    shift2 += static_cast<double>(dx * dx + dy * dy);
    parallax2 += static_cast<double>(parallax_px(jacobian_, t, i).squaredNorm());
    ++count;
  }
  if (count == 0) return 0;
  const double width_px = level.camera.width_px;
  const double lens_px =
      lens_change_sigma(smooth.lens_sigma_px * width_px / levels_.front().camera.width_px,
                        std::sqrt(shift2 / count), width_px);
  const double relief_px =
      ReliefFilter::kLinearRatio * smooth.relief_ratio * std::sqrt(parallax2 / count);
  return std::hypot(lens_px, relief_px) / level.camera.focal_x_px;
}

// Residuals show the part of a smooth error that no plane motion explains. A plane takes up
// kLinearRatio times that of self-affine terrain (Hurst exponent 0.8).
double PlaneAligner::smooth_residual_rad(const PlaneSolution& solution) const {
  constexpr double kLinearRatio = 2;
  const auto residual =
      measure_smooth_residual(observations(levels_.front()), solution, solver_.weights());
  if (!residual) return std::numeric_limits<double>::infinity();
  const double residual_px = std::sqrt(std::max(0.0, residual->variance_px2) + residual->sigma_px2);
  return kLinearRatio * residual_px / levels_.front().camera.focal_x_px;
}

double PlaneAligner::update_px(const Level& level, const PlaneMotionStep& step) const {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < level.rays.usable.size(); i += 8) {  // subsample
    if (placement_.x_px[i] < 0) continue;
    double ux = 0, uy = 0;
    for (int a = 0; a < 8; ++a) {
      ux += static_cast<double>(jacobian_.x(a)[i]) * step[a];
      uy += static_cast<double>(jacobian_.y(a)[i]) * step[a];
    }
    sum += ux * ux + uy * uy;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

void PlaneAligner::match_brightness(PlaneAlignment& out, bool adapt) const {
  // on a uniform image the variance is a difference of large sums: rounding error only
  constexpr double kRounding = 1e-4;
  double contrast = 0, product = 0, residual = 0;
  const std::vector<float>& w = solver_.weights();
  for (std::size_t i = 0; i < w.size(); ++i) {
    contrast += static_cast<double>(w[i]) * measurements_->contrast[i];
    product += static_cast<double>(w[i]) * measurements_->gain_product[i];
    residual += static_cast<double>(w[i]) * measurements_->residual[i];
  }
  const double variance = out.gain * out.gain * contrast - 2 * out.gain * product + residual;
  if (!(contrast > 0 && variance > kRounding * contrast)) {
    out.correlation = 0;
    return;
  }
  out.correlation = (out.gain * contrast - product) / std::sqrt(contrast * variance);
  // gain = ratio of contrasts, independent of the alignment error
  if (adapt) out.gain = std::clamp(std::sqrt(variance / contrast), 0.3, 3.0);
}

void PlaneAligner::assess(const PlaneSolution& solution, double lens_sigma_rad,
                          PlaneAlignment& out) {
  const Level& finest = levels_.front();
  const PlaneObservations tiles = observations(finest);
  const std::vector<float>& w = solver_.weights();
  double weight_sum = 0, flow_sum = 0;
  int ground_tiles = 0, usable_tiles = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (finest.rays.usable[i] == 0) continue;
    ++usable_tiles;
    ground_tiles += jacobian_.x(0)[i] != 0 || jacobian_.y(1)[i] != 0 ? 1 : 0;
    if (!(tiles.trace(i) > tiles.min_trace())) continue;
    ++out.tiles;
    weight_sum += w[i];
    const float dx = placement_.x_px[i] - finest.grid.centre_x_px[i];
    const float dy = placement_.y_px[i] - finest.grid.centre_y_px[i];
    flow_sum += std::sqrt(dx * dx + dy * dy);
  }
  if (out.tiles == 0) {
    out.solvable = false;
    return;
  }
  out.inlier_ratio = weight_sum / out.tiles;
  out.mean_flow_px = flow_sum / out.tiles;
  out.ground_ratio = static_cast<double>(ground_tiles) / usable_tiles;
  out.residual_px = solver_.residual_px(tiles);
  const PlaneMotionMatrix scatter = solver_.scatter(tiles, solution);
  out.covariance = covariance_of(solution, scatter);
  out.plane_likelihood = plane_likelihood(solution, scatter, out.tilt_rad);
  PlaneSolution measured = solution;
  measured.smooth_factor = smooth_factor(solution.information - solution.prior,
                                         std::hypot(lens_sigma_rad, smooth_residual_rad(solution)));
  out.measured_likelihood = plane_likelihood(measured, scatter, out.tilt_rad);
  const Matrix6d A = solution.information.topLeftCorner<6, 6>();
  out.smooth_covariance = (solution.smooth_factor - 1) * A.ldlt().solve(Matrix6d::Identity());
  const Vector6d scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scale.asDiagonal() * A * scale.asDiagonal(),
                                                      Eigen::EigenvaluesOnly);
  out.condition = eigen.eigenvalues()[5] / std::max(eigen.eigenvalues()[0], 1e-15);
}

// d(motion)/d(twist) = A^-1 sum w J^T G J_motion t: a row delay t displaces a tile by J_motion t
// per unit of twist. Overwrites `times_`.
Matrix6d PlaneAligner::motion_by_twist(const PlaneSolution& solution) {
  std::vector<float>& weights = times_.row_delay_s;
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= solver_.weights()[i];
  const PlaneMotionMatrix sum =
      accumulate(jacobian_, *measurements_, weights).information / solution.noise_variance;
  return motion_by_gradient(solution, sum.leftCols<6>());
}

}  // namespace stillkite
