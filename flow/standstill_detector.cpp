#include "flow/standstill_detector.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

// Width of the pyramid level in use: enough tiles, and averaged noise.
constexpr int kMaxWidth_px = 480;
constexpr int kTileColumns = 16, kTileRows = 12;
constexpr int kRegionsAcross = 8;
constexpr std::size_t kRegions = 64;
constexpr std::size_t kMinRegions = 24;  // with texture: most of them are no airframe in view

// Texture of a region over the gradients of its noise, at least: five standard deviations of the
// latter.
constexpr double kMinTexture = 0.1;
// Images of different places have none; half of the variance may be noise.
constexpr double kMinCorrelation = 0.5;
// Smallest standard deviation of a region's displacement, on that level.
constexpr double kMinSigma_px = 0.01;

// Largest displacement at rest, on that level: over `kMinRest_s` 1.2 mm/s per metre of height with
// a field of view of 70 degrees.
constexpr double kMaxDisplacement_px = 0.2;
// Shaking above this frequency does not displace a camera measurably.
constexpr double kMaxShaking_hz = 50;
constexpr int kMaxSpeeds = 15;  // in their mean square
// Median length of a displacement with two Gaussian components: sqrt(2 ln 2) standard deviations.
constexpr double kMedianLengthToSigma = 1 / 1.17741;

using AffineVector = Eigen::Matrix<double, 6, 1>;
using AffineMatrix = Eigen::Matrix<double, 6, 6>;
using AffineJacobian = Eigen::Matrix<double, 2, 6>;

// Displacement at (x, y) over the affine parameters.
AffineJacobian affine_jacobian(double x, double y) {
  AffineJacobian J = AffineJacobian::Zero();
  J.row(0).head<3>() << 1, x, y;
  J.row(1).tail<3>() << 1, x, y;
  return J;
}

int levels_for(int width_px) {
  int levels = 1;
  for (; width_px > kMaxWidth_px; width_px /= 2) ++levels;
  return levels;
}

int level_in_use(const Pyramid& pyramid) {
  return pyramid.levels() - 1;
}

}  // namespace

double StandstillDetector::Region::correlation(double gain) const {
  const double variance = gain * gain * contrast - 2 * gain * gain_product + residual;
  return (gain * contrast - gain_product) / std::sqrt(contrast * variance);
}

double StandstillDetector::AffineDisplacement::rms_px(const AffineVector& parameters) const {
  return std::sqrt(parameters.dot(second_moment * parameters));
}

std::optional<Standstill> StandstillDetector::update(const Frame& frame) {
  current_.build(frame.grey, levels_for(frame.grey.cols));
  const bool is_comparable = reference_.levels() > 0 && rest_since_ < frame.stamp &&
                             mask_ == frame.mask && reference_.level(0).size() == frame.grey.size();
  if (!is_comparable) {
    start_at(frame);
    return std::nullopt;
  }
  std::optional<AffineDisplacement> now;
  if (speeds_ > 0 || displacement_at_rest(sparse_placement_)) {
    now = displacement_at_rest(placement_);
  }
  if (!now) {
    start_at(frame);
    return std::nullopt;
  }
  // interval of at least a period of shaking
  const double dt_s = seconds_between(last_.stamp, frame.stamp);
  if (dt_s >= 1 / kMaxShaking_hz) {
    const double change_px = now->rms_px(now->motion - last_.motion);
    const double speed2 = (change_px * change_px + 2 * now->variance_px2) / (dt_s * dt_s);
    mean_speed2_ += (speed2 - mean_speed2_) / std::min(++speeds_, kMaxSpeeds);
    last_ = {frame.stamp, now->motion};
  }
  if (speeds_ == 0 || seconds_between(rest_since_, frame.stamp) < kMinRest_s) return std::nullopt;
  const double scale = std::ldexp(1.0, level_in_use(current_));
  return Standstill{.speed_px_s = scale * std::sqrt(mean_speed2_),
                    .displacement_px = scale * now->rms_px(now->motion)};
}

std::optional<StandstillDetector::AffineDisplacement> StandstillDetector::displacement_at_rest(
    const TilePlacement& placement) {
  if (!measure(placement)) return std::nullopt;
  const std::optional<AffineDisplacement> displacement = affine_displacement();
  if (!displacement || !(displacement->rms_px(displacement->motion) < kMaxDisplacement_px))
    return std::nullopt;
  return displacement;
}

void StandstillDetector::start_at(const Frame& frame) {
  rest_since_ = frame.stamp;
  last_ = {frame.stamp, AffineVector::Zero()};
  mean_speed2_ = 0;
  speeds_ = 0;
  const cv::Size size = current_.level(level_in_use(current_)).size();
  const bool is_other_size =
      reference_.levels() == 0 || reference_.level(0).size() != frame.grey.size();
  if (is_other_size) reset_grid(size);
  if (is_other_size || mask_ != frame.mask) place_tiles(frame);
  std::swap(reference_, current_);
  textures_.reset(grid_);
}

void StandstillDetector::reset_grid(cv::Size size) {
  grid_ = make_tile_grid(size.width, size.height, kTileColumns, kTileRows);
  region_of_tile_.clear();
  for (std::size_t i = 0; i < grid_.centre_x_px.size(); ++i) {
    const auto region = [](float px, int size_px) {
      return std::clamp(static_cast<int>(px * kRegionsAcross / static_cast<float>(size_px)), 0,
                        kRegionsAcross - 1);
    };
    region_of_tile_.push_back(region(grid_.centre_y_px[i], size.height) * kRegionsAcross +
                              region(grid_.centre_x_px[i], size.width));
  }
}

void StandstillDetector::place_tiles(const Frame& frame) {
  constexpr float kMaxMaskedRatio = 0.1F;
  mask_ = frame.mask;
  const float scale = std::ldexp(1.0F, level_in_use(current_));
  const auto full_resolution = [&](float px) { return scale * (px + 0.5F) - 0.5F; };
  placement_.resize(grid_.count);
  std::fill(placement_.axx.begin(), placement_.axx.end(), 1.0F);
  std::fill(placement_.ayy.begin(), placement_.ayy.end(), 1.0F);
  std::fill(placement_.axy.begin(), placement_.axy.end(), 0.0F);
  std::fill(placement_.ayx.begin(), placement_.ayx.end(), 0.0F);
  sparse_placement_ = placement_;
  for (std::size_t i = 0; i < grid_.centre_x_px.size(); ++i) {
    const float x_px = grid_.centre_x_px[i], y_px = grid_.centre_y_px[i];
    const bool is_masked =
        mask_ && x_px >= 0 &&
        mask_->masked_ratio(full_resolution(x_px), full_resolution(y_px), scale * kTileColumns,
                            scale * kTileRows) > kMaxMaskedRatio;
    const bool is_sparse =
        grid_.left_px[i] / kTileColumns % 2 == 0 && grid_.top_px[i] / kTileRows % 2 == 0;
    placement_.x_px[i] = is_masked ? TilePlacement::kOutside_px : x_px;
    placement_.y_px[i] = is_masked ? TilePlacement::kOutside_px : y_px;
    sparse_placement_.x_px[i] = is_sparse ? placement_.x_px[i] : TilePlacement::kOutside_px;
    sparse_placement_.y_px[i] = is_sparse ? placement_.y_px[i] : TilePlacement::kOutside_px;
  }
}

// Sums of the tiles' information over regions. False if the images cannot be compared.
bool StandstillDetector::measure(const TilePlacement& placement) {
  constexpr float kMaxGainError = 0.01F;
  constexpr float kMaxGain = 2;  // beyond: covered, or light switched on
  const int level = level_in_use(current_);
  const TileMeasurements* m = nullptr;
  float gain = 1;
  for (int pass = 0; pass < 2; ++pass) {
    m = &tile_flow_.measure(reference_.level(level), current_.level(level), grid_, placement,
                            TileWarp::shift, gain, {.quintic = false, .contrast = true}, textures_);
    float contrast = 0, product = 0, residual = 0;
    for (std::size_t i = 0; i < m->contrast.size(); ++i) {
      contrast += m->contrast[i];
      product += m->gain_product[i];
      residual += m->residual[i];
    }
    if (pass > 0) break;
    if (!(contrast > 0)) return false;
    const float ratio = std::sqrt(std::max(0.0F, 1 + (residual - 2 * product) / contrast));
    if (!(ratio > 1 / kMaxGain && ratio < kMaxGain)) return false;
    if (std::abs(ratio - 1) < kMaxGainError) break;
    gain = ratio;  // ratio of contrasts, independent of noise and displacement
  }
  gain_ = static_cast<double>(gain);
  regions_.assign(kRegions, {});
  const double middle_x_px = 0.5 * current_.level(level).cols;
  const double middle_y_px = 0.5 * current_.level(level).rows;
  for (std::size_t i = 0; i < region_of_tile_.size(); ++i) {
    if (placement.x_px[i] < 0) continue;
    Region& region = regions_[static_cast<std::size_t>(region_of_tile_[i])];
    ++region.tiles;
    region.x += (static_cast<double>(placement.x_px[i]) - middle_x_px) / middle_x_px;
    region.y += (static_cast<double>(placement.y_px[i]) - middle_y_px) / middle_x_px;
    region.gxx += static_cast<double>(m->gxx[i]);
    region.gxy += static_cast<double>(m->gxy[i]);
    region.gyy += static_cast<double>(m->gyy[i]);
    region.gx += static_cast<double>(m->gx[i]);
    region.gy += static_cast<double>(m->gy[i]);
    region.residual += static_cast<double>(m->residual[i]);
    region.contrast += static_cast<double>(m->contrast[i]);
    region.gain_product += static_cast<double>(m->gain_product[i]);
  }
  for (Region& region : regions_) {
    if (region.tiles == 0) continue;
    region.x /= region.tiles;
    region.y /= region.tiles;
  }
  return true;
}

// Robust least squares over the regions (Huber). Every region with texture has the same weight:
// strong edges of an airframe in view do not outvote the ground. Empty if most of the image has no
// texture.
std::optional<StandstillDetector::AffineDisplacement> StandstillDetector::affine_displacement()
    const {
  constexpr int kIterations = 5;
  constexpr double kHuber = 1.5;
  std::vector<AffineJacobian> jacobians;
  std::vector<Eigen::Vector2d> displacements;
  for (const Region& region : regions_) {
    // central differences of white noise have half its variance, a difference of images twice
    const double noise_energy = region.residual / 4;
    Eigen::Matrix2d G;
    G << region.gxx - noise_energy, region.gxy, region.gxy, region.gyy - noise_energy;
    const Eigen::Matrix2d above_noise =
        G - kMinTexture * noise_energy * Eigen::Matrix2d::Identity();
    const bool has_texture = above_noise.trace() > 0 && above_noise.determinant() > 0;
    if (!has_texture || !(region.correlation(gain_) > kMinCorrelation)) continue;
    jacobians.push_back(affine_jacobian(region.x, region.y));
    displacements.emplace_back(G.inverse() * Eigen::Vector2d(region.gx, region.gy));
  }
  const std::size_t count = displacements.size();
  if (count < kMinRegions) return std::nullopt;
  AffineDisplacement out;
  AffineMatrix covariance;
  std::vector<double> lengths_px(count);
  double sigma_px = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < count; ++i)
      lengths_px[i] = (displacements[i] - jacobians[i] * out.motion).norm();
    std::vector<double> sorted_px = lengths_px;
    sigma_px = std::max(kMinSigma_px, kMedianLengthToSigma * upper_median(sorted_px));
    AffineMatrix A = AffineMatrix::Zero();
    AffineVector b = AffineVector::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const double weight = std::min(1.0, kHuber * sigma_px / lengths_px[i]);
      A += weight * jacobians[i].transpose() * jacobians[i];
      b += weight * jacobians[i].transpose() * displacements[i];
    }
    covariance = A.ldlt().solve(AffineMatrix::Identity());
    out.motion = covariance * b;
  }
  for (const AffineJacobian& J : jacobians) out.second_moment += J.transpose() * J;
  out.second_moment /= static_cast<double>(count);
  out.variance_px2 = sigma_px * sigma_px * (covariance * out.second_moment).trace();
  return out;
}

}  // namespace stillkite
