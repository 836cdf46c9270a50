#include "estimation/plane/plane_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/row_time.hpp"

namespace stillkite {
namespace {

constexpr int kClustersAcross = 8;
constexpr int kClustersDown = PlaneObservations::kClusters / kClustersAcross;

// A deformation that moves a window's corner by less than this is taken to first order.
constexpr float kFirstOrder_px = 1.2F;

// Lucas-Kanade steps of a level, at most; a step that moves less than this is the level's last.
constexpr int most_steps(int level) {
  return level == 0 ? 1 : 2;
}
constexpr double kSettled_px = 0.05;

float later_s(const Camera& camera, const RollingShutter& shutter, float row_px) {
  return static_cast<float>(row_time_s(shutter.readout_s, row_px, camera.height_px));
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
  for (Level& level : levels_) level.textures.forget(level.grid);
}

void PlaneAligner::set_mask(const std::shared_ptr<const ImageMask>& mask) {
  if (mask == mask_) return;
  mask_ = mask;
  for (std::size_t l = 0; mask_ && l < levels_.size(); ++l) {
    const TileGrid& grid = levels_[l].grid;
    levels_[l].hidden.resize(grid.centre_x_px.size());
    for (std::size_t i = 0; i < grid.centre_x_px.size(); ++i) {
      const bool is_hidden_now =
          is_hidden(grid, static_cast<int>(l), grid.centre_x_px[i], grid.centre_y_px[i]);
      levels_[l].hidden[i] = is_hidden_now ? 1 : 0;
    }
  }
}

bool PlaneAligner::is_hidden(const TileGrid& grid, int level, float x_px, float y_px) const {
  constexpr float kMost = 0.1F;
  const float side = std::ldexp(1.0F, level);
  // the whole image's pixel i lies about i, from i - 0.5 on
  const auto in_whole = [&](float at) { return (at + 0.5F) * side - 0.5F; };
  return mask_->hidden_ratio(in_whole(x_px), in_whole(y_px),
                             side * static_cast<float>(grid.columns),
                             side * static_cast<float>(grid.rows)) > kMost;
}

// In either image.
void PlaneAligner::leave_out_hidden(int level) {
  if (!mask_) return;
  const Level& at = levels_[static_cast<std::size_t>(level)];
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    if (placement_.x_px[i] < 0) continue;
    if (at.hidden[i] != 0 || is_hidden(at.grid, level, placement_.x_px[i], placement_.y_px[i])) {
      placement_.x_px[i] = placement_.y_px[i] = TilePlacement::kNowhere_px;
    }
  }
}

PlaneAlignment PlaneAligner::align(const Pyramid& current, const PlaneMotion& guess,
                                   const TiltPrior& tilt, const RollingShutter& shutter) {
  PlaneAlignment out{.motion = guess, .shutter = shutter};
  const bool rolls = shutter.readout_s > 0;
  const int levels =
      std::min({static_cast<int>(levels_.size()), reference_.levels(), current.levels()});
  PlaneSolution solution;
  for (int l = levels - 1; l >= 0; --l) {
    Level& level = levels_[static_cast<std::size_t>(l)];
    const TileRays& rays = rolls ? rays_at_stamp(level, out.motion.normal, shutter) : level.rays;
    for (int s = 0; s < most_steps(l); ++s) {
      // 1. where the motion takes every window
      place_tiles(level.camera, rays, out.motion, tilt.axes, placement_, jacobian_);
      if (rolls) {
        place_tiles(level.camera, rays, out.motion, tilt.axes, placement_, jacobian_,
                    &times_of_rows(level.camera, shutter));
      }
      leave_out_hidden(l);
      // 2. what the images say of it, in information form
      const bool exactly = config_.exact_warp && deformation_px(level.grid) > kFirstOrder_px;
      const TileEffort effort{.quintic = l == 0, .contrast = l > 0 && s == 0};
      measurements_ = &tile_flow_.measure(reference_.level(l), current.level(l), level.grid,
                                          placement_, exactly ? TileWarp::affine : TileWarp::shift,
                                          static_cast<float>(out.gain), effort, level.textures);
      // 3. the motion that explains it
      solution = solver_.solve(observations(level), tilt, out.tilt_rad);
      out.solvable = solution.ok;
      if (!solution.ok) break;
      if (l == 1 && s == 0) out.deviation_px = 2 * solver_.deviation_px(observations(level));
      out.motion = apply(out.motion, solution.step, tilt.axes);
      out.tilt_rad += solution.step.tail<2>();
      if (effort.contrast || exactly) match_brightness(out, l > 0);
      out.last_update_px = update_px(level, solution.step);
      if (out.last_update_px < kSettled_px) break;
    }
  }
  if (out.solvable) assess(solution, out);
  if (out.solvable && rolls) out.motion_by_twist = motion_by_twist(solution);
  return out;
}

// Where the keyframe's windows would have been seen at its stamp. At the time of its row, t later,
// the camera is t v further and the ground t n.v nearer, in heights of the stamp:
//   b' = R b + t v (n . R b) / (1 - t n.v),   R b = b + t w x b
const TileRays& PlaneAligner::rays_at_stamp(const Level& level, const Eigen::Vector3d& normal,
                                            const RollingShutter& shutter) {
  const Eigen::Vector3f n = normal.cast<float>();
  const Eigen::Vector3f v = shutter.reference_twist.head<3>().cast<float>();
  const Eigen::Vector3f w = shutter.reference_twist.tail<3>().cast<float>();
  rays_ = level.rays;
  for (std::size_t i = 0; i < rays_.x.size(); ++i) {
    const float t = later_s(level.camera, shutter, level.grid.centre_y_px[i]);
    const Eigen::Vector3f bearing(rays_.x[i], rays_.y[i], 1);
    const Eigen::Vector3f turned = bearing + t * w.cross(bearing);
    const float inverse_depth = std::max(0.0F, n.dot(turned)) / (1 - t * n.dot(v));
    const Eigen::Vector3f at_stamp = turned + t * inverse_depth * v;
    rays_.x[i] = at_stamp.x() / at_stamp.z();
    rays_.y[i] = at_stamp.y() / at_stamp.z();
  }
  return rays_;
}

// Where a window moves by dy/dt its row is exposed at t = s (y + t dy/dt - middle); out of sight at
// any time.
const TileTimes& PlaneAligner::times_of_rows(const Camera& camera, const RollingShutter& shutter) {
  const auto readout_s = static_cast<float>(shutter.readout_s);
  const float s_per_row = readout_s / static_cast<float>(camera.height_px);
  times_.twist = shutter.current_twist;
  times_.later_s.resize(placement_.y_px.size());
  for (std::size_t i = 0; i < times_.later_s.size(); ++i) {
    float speed_px_s = 0;
    for (int a = 0; a < 6; ++a) {
      speed_px_s -= static_cast<float>(shutter.current_twist[a]) * jacobian_.y(a)[i];
    }
    const float t = later_s(camera, shutter, placement_.y_px[i]) / (1 - s_per_row * speed_px_s);
    times_.later_s[i] = std::clamp(t, -readout_s, readout_s);
  }
  return times_;
}

float PlaneAligner::deformation_px(const TileGrid& grid) const {
  float largest = 0;
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    if (placement_.x_px[i] < 0) continue;
    const float across = std::max(std::abs(placement_.axx[i] - 1), std::abs(placement_.ayx[i]));
    const float down = std::max(std::abs(placement_.axy[i]), std::abs(placement_.ayy[i] - 1));
    largest = std::max(
        largest, across * static_cast<float>(grid.columns) + down * static_cast<float>(grid.rows));
  }
  return 0.5F * largest;
}

double PlaneAligner::update_px(const Level& level, const PlaneMotionStep& step) const {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < level.rays.usable.size(); i += 8) {  // a sample is enough
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
  // of a bare image sums as large as the keyframe's contrast leave nothing but their rounding
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
  // the ratio of contrasts is the gain, however well the images are aligned so far
  if (adapt) out.gain = std::clamp(std::sqrt(variance / contrast), 0.3, 3.0);
}

void PlaneAligner::assess(const PlaneSolution& solution, PlaneAlignment& out) {
  const Level& finest = levels_.front();
  const PlaneObservations seen = observations(finest);
  const std::vector<float>& w = solver_.weights();
  double kept = 0, flow = 0;
  int ground = 0, real = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (finest.rays.usable[i] == 0) continue;
    ++real;
    ground += jacobian_.x(0)[i] != 0 || jacobian_.y(1)[i] != 0 ? 1 : 0;
    if (!(seen.trace(i) > seen.textured())) continue;
    ++out.windows;
    kept += w[i];
    const float dx = placement_.x_px[i] - finest.grid.centre_x_px[i];
    const float dy = placement_.y_px[i] - finest.grid.centre_y_px[i];
    flow += std::sqrt(dx * dx + dy * dy);
  }
  if (out.windows == 0) {
    out.solvable = false;
    return;
  }
  out.inlier_ratio = kept / out.windows;
  out.mean_flow_px = flow / out.windows;
  out.ground_ratio = static_cast<double>(ground) / real;
  out.residual_px = solver_.residual_px(seen);
  const PlaneMotionMatrix scatter = solver_.scatter(seen, solution);
  out.covariance = covariance_of(solution, scatter);
  out.windows_alone = windows_alone(solution, scatter, out.tilt_rad);
  const Matrix6d A = solution.information.topLeftCorner<6, 6>();
  out.smooth_covariance = (solution.tilt_deflation - 1) * A.ldlt().solve(Matrix6d::Identity());
  const Vector6d scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scale.asDiagonal() * A * scale.asDiagonal(),
                                                      Eigen::EigenvaluesOnly);
  out.condition = eigen.eigenvalues()[5] / std::max(eigen.eigenvalues()[0], 1e-15);
}

// A window whose row is exposed t later is J_motion t from where the motion alone takes it, for
// each unit of twist: A^-1 sum w J^T G J_motion t of motion makes up for it. The times are spent.
Matrix6d PlaneAligner::motion_by_twist(const PlaneSolution& solution) {
  std::vector<float>& weights = times_.later_s;
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= solver_.weights()[i];
  const PlaneMotionMatrix sum =
      accumulate(jacobian_, *measurements_, weights).information / solution.noise_variance;
  return motion_by_gradient(solution, sum.leftCols<6>());
}

}  // namespace stillkite
