#include "flow/feature_tracker.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/mat.hpp>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr int kPatch_px = 16;
constexpr float kPatchPixels = kPatch_px * kPatch_px;
constexpr int kCoarseSteps = 2;
constexpr float kMaxStep_px = 3;
// minimum eigenvalue of the structure tensor, above that of 1 to 2 grey levels of noise
constexpr float kMinEigenvalue = kPatchPixels / 2;
constexpr int kMinMotionFeatures = 8;

/// One tile per feature, at the nearest integer position inside the image.
TileGrid patch_grid(const std::vector<Eigen::Vector2f>& centres_px, float scale,
                    const cv::Mat& image) {
  TileGrid grid;
  grid.columns = grid.rows = kPatch_px;
  const int count = static_cast<int>(centres_px.size());
  grid.count = (count + TileGrid::kPadding - 1) / TileGrid::kPadding * TileGrid::kPadding;
  constexpr float kHalf = 0.5F * (kPatch_px - 1);
  const auto first = [](float centre, int size) {
    return std::clamp(static_cast<int>(std::lround(centre - kHalf)), TileGrid::kBefore_px,
                      size - kPatch_px - TileGrid::kAfter_px);
  };
  for (int i = 0; i < grid.count; ++i) {
    const bool is_feature = i < count;
    const Eigen::Vector2f at =
        is_feature
            ? (((centres_px[static_cast<std::size_t>(i)].array() + 0.5F) * scale) - 0.5F).eval()
            : Eigen::Array2f::Constant(kHalf + TileGrid::kBefore_px).eval();
    grid.left_px.push_back(first(at.x(), image.cols));
    grid.top_px.push_back(first(at.y(), image.rows));
    const float offset_px = is_feature ? 0 : TilePlacement::kOutside_px;
    grid.centre_x_px.push_back(offset_px + static_cast<float>(grid.left_px.back()) + kHalf);
    grid.centre_y_px.push_back(offset_px + static_cast<float>(grid.top_px.back()) + kHalf);
  }
  return grid;
}

float determinant_of(const TileMeasurements& m, std::size_t i) {
  return m.gxx[i] * m.gyy[i] - m.gxy[i] * m.gxy[i];
}

float min_eigenvalue(const TileMeasurements& m, std::size_t i) {
  const float half_trace = 0.5F * (m.gxx[i] + m.gyy[i]);
  return half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - determinant_of(m, i)));
}

/// Lucas-Kanade step, G u = g, of one tile, limited in length; zero without sufficient texture.
Eigen::Vector2f tile_step(const TileMeasurements& m, std::size_t i) {
  if (min_eigenvalue(m, i) < kMinEigenvalue) return Eigen::Vector2f::Zero();
  const float determinant = determinant_of(m, i);
  const Eigen::Vector2f u((m.gyy[i] * m.gx[i] - m.gxy[i] * m.gy[i]) / determinant,
                          (m.gxx[i] * m.gy[i] - m.gxy[i] * m.gx[i]) / determinant);
  const float length = u.norm();
  return length > kMaxStep_px ? (u * (kMaxStep_px / length)).eval() : u;
}

/// Normalized correlation of reference and current patch, before the last step; -1 if undefined.
float correlation(const TileMeasurements& m, std::size_t i) {
  const float current = m.contrast[i] - 2 * m.gain_product[i] + m.residual[i];
  // textureless patches: below the rounding error of the sums
  constexpr float kRounding = 1e-4F;
  if (!(m.contrast[i] > 0 && current > kRounding * m.contrast[i])) return -1;
  return (m.contrast[i] - m.gain_product[i]) / std::sqrt(m.contrast[i] * current);
}

/// Residual variance of a pixel, grey^2, after the better of step and gain; at least the
/// quantization variance of two images.
float noise_variance(const TileMeasurements& m, std::size_t i) {
  constexpr float kParameters = 4;  // step, mean, gain
  constexpr float kRounding_grey2 = 2.0F / 12;
  const Eigen::Vector2f u = tile_step(m, i);
  const float gain_grey2 =
      m.contrast[i] > 0 ? m.gain_product[i] * m.gain_product[i] / m.contrast[i] : 0.0F;
  const float explained_grey2 = std::max(m.gx[i] * u.x() + m.gy[i] * u.y(), gain_grey2);
  return std::max(kRounding_grey2,
                  (m.residual[i] - explained_grey2) / (kPatchPixels - kParameters));
}

/// s^2 T^-1 G T^-1 with the residual variance s^2, which is the noise of two images. Noise in the
/// central differences of one image biases G over n pixels: T = G - (n s^2 / 4) I.
Eigen::Matrix2f covariance_of(const TileMeasurements& m, std::size_t i, float noise) {
  constexpr float kMaxNoiseRatio = 0.8F;  // of the smaller eigenvalue
  const float smaller = min_eigenvalue(m, i);
  // edge or no texture: anywhere in the patch
  if (!(smaller >= kMinEigenvalue)) {
    return 0.25F * kPatchPixels * Eigen::Matrix2f::Identity();
  }
  Eigen::Matrix2f G;
  G << m.gxx[i], m.gxy[i], m.gxy[i], m.gyy[i];
  const float noise_eigenvalue = std::min(0.25F * kPatchPixels * noise, kMaxNoiseRatio * smaller);
  const Eigen::Matrix2f T_inverse = (G - noise_eigenvalue * Eigen::Matrix2f::Identity()).inverse();
  return noise * T_inverse * G * T_inverse;
}

}  // namespace

void FeatureTracker::set_reference(const cv::Mat& grey,
                                   const std::vector<cv::Point2f>& features_px) {
  reference_.build(grey, config_.levels);
  tracks_ = {};
  for (const cv::Point2f& at : features_px) {
    const float left = std::round(at.x) - 0.5F * kPatch_px;
    const float top = std::round(at.y) - 0.5F * kPatch_px;
    constexpr float kExtent_px = kPatch_px + TileGrid::kAfter_px;
    const bool is_inside = left >= TileGrid::kBefore_px && top >= TileGrid::kBefore_px &&
                           left + kExtent_px <= static_cast<float>(grey.cols) &&
                           top + kExtent_px <= static_cast<float>(grey.rows);
    // tracks the centre of the patch, half a pixel from the corner
    if (is_inside) tracks_.reference_px.emplace_back(left + 7.5F, top + 7.5F);
  }
  grids_.clear();
  textures_.resize(static_cast<std::size_t>(reference_.levels()));
  for (int level = 0; level < reference_.levels(); ++level) {
    grids_.push_back(
        patch_grid(tracks_.reference_px, std::ldexp(1.0F, -level), reference_.level(level)));
    textures_[static_cast<std::size_t>(level)].reset(grids_.back());
  }
  const std::size_t count = tracks_.reference_px.size();
  tracks_.current_px = tracks_.reference_px;
  tracks_.found.assign(count, 0);
  tracks_.covariance_px2.assign(count, Eigen::Matrix2f::Zero());
  displacements_px_.assign(count, Eigen::Vector2f::Zero());
  last_step_lengths_px_.assign(count, 0);
  correlations_.assign(count, 0);
  measured_.assign(count, 0);
  update_masked_features();
  motion_ = {};
  deformation_.set_points(tracks_.reference_px);
  gradients_.assign(count, Eigen::Matrix2f::Zero());
  previous_found_count_ = 0;
  has_previous_ = false;
}

void FeatureTracker::set_mask(const std::shared_ptr<const ImageMask>& mask) {
  if (mask == mask_) return;
  mask_ = mask;
  update_masked_features();
}

bool FeatureTracker::is_masked(const Eigen::Vector2f& at_px) const {
  constexpr float kMaxMaskedRatio = 0.1F;
  return mask_ && mask_->masked_ratio(at_px.x(), at_px.y(), kPatch_px, kPatch_px) > kMaxMaskedRatio;
}

void FeatureTracker::update_masked_features() {
  masked_.resize(tracks_.reference_px.size());
  std::transform(tracks_.reference_px.begin(), tracks_.reference_px.end(), masked_.begin(),
                 [&](const Eigen::Vector2f& at_px) { return is_masked(at_px) ? 1 : 0; });
}

const FeatureTracks& FeatureTracker::track(const cv::Mat& grey,
                                           std::optional<double> image_rotation_rad) {
  current_.build(grey, config_.levels);
  // 1. Initial displacements: previous frame (lost features: its global motion), else zero.
  const bool is_warm = config_.warm_start && has_previous_;
  if (!is_warm) motion_ = {};
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    if (!is_warm || tracks_.found[i] == 0) {
      displacements_px_[i] = motion_.at(tracks_.reference_px[i]);
    }
  }
  align(is_warm);
  // 2. Most features lost, e.g. after a large motion: register the whole image.
  if (config_.search && is_lost()) register_reference(image_rotation_rad);
  // 3. Still lost, e.g. by motion blur: keep the last valid motion as the next initial value.
  if (is_lost()) return tracks_;
  if (tracks_.found_count >= kMinMotionFeatures) {
    motion_ = fit_affine_flow(tracks_.reference_px, displacements_px_, tracks_.found);
    has_previous_ = true;
  }
  previous_found_count_ = tracks_.found_count;
  return tracks_;
}

void FeatureTracker::align(bool is_warm) {
  // 1. Lucas-Kanade, coarse to fine; outliers of a coarse level take the global motion.
  for (int level = reference_.levels() - 1; level > 0; --level) {
    for (int i = 0; i < kCoarseSteps; ++i) step(level, TileWarp::shift);
    replace_outliers(level);
  }
  constexpr float kMaxShiftGradient = 0.03F;
  const TileWarp warp =
      motion_.gradient.norm() > kMaxShiftGradient ? TileWarp::affine : TileWarp::shift;
  for (std::size_t i = 0; i < gradients_.size(); ++i) {
    if (!is_warm || tracks_.found[i] == 0) gradients_[i] = motion_.gradient;
  }
  // half converged: local deformations from the displacements
  for (int i = 0; i < config_.steps; ++i) {
    step(0, warp);
    if (i == config_.steps / 2) {
      gradients_ = deformation_.fit(displacements_px_, measured_, motion_);
    }
  }
  // 2. Validation: inside the image, converged, correlated, forward-backward consistent.
  validate();
  estimate_covariances();
  if (config_.forward_backward_px > 0) check_forward_backward();
  tracks_.found_count = static_cast<int>(std::count(tracks_.found.begin(), tracks_.found.end(), 1));
}

// Few features found after a sudden drop.
bool FeatureTracker::is_lost() const {
  constexpr double kMinFoundRatio = 0.25;
  constexpr double kMinRemainingRatio = 0.5;
  return tracks_.found_count < kMinFoundRatio * static_cast<double>(tracks_.found.size()) &&
         (previous_found_count_ < kMinMotionFeatures ||
          tracks_.found_count < kMinRemainingRatio * previous_found_count_);
}

void FeatureTracker::register_reference(std::optional<double> image_rotation_rad) {
  const AffineFlow previous_motion = motion_;
  if (image_rotation_rad) {
    register_reference(std::array{*image_rotation_rad});
  } else if (!register_reference(kNoRotation_rad)) {
    // rotation 0 first: usually sufficient and 7 times faster
    register_reference(kSmallRotations_rad);
  }
  motion_ = previous_motion;
}

// Returns true if enough features are found; keeps the best result in any case.
bool FeatureTracker::register_reference(std::span<const double> rotations_rad) {
  constexpr double kMinFoundRatio = 0.5;  // never reached at a wrong registration
  const auto is_found = [&](const FeatureTracks& tracks) {
    return tracks.found_count >= kMinFoundRatio * static_cast<double>(tracks.found.size());
  };
  FeatureTracks best = tracks_;
  std::vector<Eigen::Vector2f> best_displacements_px = displacements_px_;
  for (const ImageRegistration& registration : register_images(
           reference_.level(0), current_.level(0), Eigen::Matrix3d::Identity(), rotations_rad)) {
    if (is_found(best)) break;
    initialize_from(registration);
    align(false);
    if (tracks_.found_count <= best.found_count) continue;
    best = tracks_;
    best_displacements_px = displacements_px_;
  }
  tracks_ = std::move(best);
  displacements_px_ = std::move(best_displacements_px);
  return is_found(tracks_);
}

void FeatureTracker::initialize_from(const ImageRegistration& registration) {
  motion_ = {.origin_px = {0.5F * static_cast<float>(current_.level(0).cols - 1),
                           0.5F * static_cast<float>(current_.level(0).rows - 1)},
             .offset_px = registration.shift_px.cast<float>()};
  motion_.gradient =
      Eigen::Rotation2Df(static_cast<float>(registration.rotation_rad)).toRotationMatrix() -
      Eigen::Matrix2f::Identity();
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    displacements_px_[i] = motion_.at(tracks_.reference_px[i]);
  }
}

void FeatureTracker::place(int level) {
  const TileGrid& grid = grids_[static_cast<std::size_t>(level)];
  const float scale = std::ldexp(1.0F, -level);
  placement_.resize(grid.count);
  for (int i = 0; i < grid.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector2f d = k < displacements_px_.size() ? (scale * displacements_px_[k]).eval()
                                                           : Eigen::Vector2f(0, 0);
    const bool is_skipped = k < masked_.size() && masked_[k] != 0;
    placement_.x_px[k] = is_skipped ? TilePlacement::kOutside_px : grid.centre_x_px[k] + d.x();
    placement_.y_px[k] = grid.centre_y_px[k] + d.y();
    const Eigen::Matrix2f& gradient =
        level == 0 && k < gradients_.size() ? gradients_[k] : motion_.gradient;
    placement_.axx[k] = 1 + gradient(0, 0);
    placement_.axy[k] = gradient(0, 1);
    placement_.ayx[k] = gradient(1, 0);
    placement_.ayy[k] = 1 + gradient(1, 1);
  }
}

void FeatureTracker::step(int level, TileWarp warp) {
  place(level);
  const bool finest = level == 0;
  const TileMeasurements& m = tiles_.measure(reference_.level(level), current_.level(level),
                                             grids_[static_cast<std::size_t>(level)], placement_,
                                             warp, 1.0F, {.quintic = finest, .contrast = finest},
                                             textures_[static_cast<std::size_t>(level)]);
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    measured_[i] = m.gxx[i] > 0 ? 1 : 0;
    const Eigen::Vector2f u = tile_step(m, i);
    last_step_lengths_px_[i] = u.norm();
    displacements_px_[i] += std::ldexp(1.0F, level) * u;
    if (!finest) continue;
    correlations_[i] = correlation(m, i);
  }
}

void FeatureTracker::replace_outliers(int level) {
  constexpr float kOutlierSigmas = 4;
  motion_ = fit_affine_flow(tracks_.reference_px, displacements_px_, measured_);
  if (motion_.inliers < kMinMotionFeatures) {
    motion_.gradient.setZero();
    return;
  }
  const float max_residual_px =
      std::max(kOutlierSigmas * motion_.sigma_px, std::ldexp(1.0F, level));
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    const Eigen::Vector2f expected = motion_.at(tracks_.reference_px[i]);
    if (measured_[i] == 0 || (displacements_px_[i] - expected).norm() > max_residual_px) {
      displacements_px_[i] = expected;
    }
  }
}

void FeatureTracker::validate() {
  constexpr float kConvergedStep_px = 0.2F;
  constexpr float kMargin_px = 0.5F * kPatch_px;
  const Eigen::Array2f last = Eigen::Array2f(static_cast<float>(current_.level(0).cols - 1),
                                             static_cast<float>(current_.level(0).rows - 1)) -
                              kMargin_px;
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    tracks_.current_px[i] = tracks_.reference_px[i] + displacements_px_[i];
    const Eigen::Array2f at = tracks_.current_px[i].array();
    const bool is_inside = (at > kMargin_px).all() && (at < last).all();
    tracks_.found[i] = measured_[i] != 0 && is_inside &&
                               last_step_lengths_px_[i] < kConvergedStep_px &&
                               correlations_[i] > static_cast<float>(config_.min_correlation) &&
                               !is_masked(tracks_.current_px[i])
                           ? 1
                           : 0;
  }
}

// Noise of each patch, at least the median: compression can remove the noise of a patch in both
// images. Residual in excess of the median is correlated between pixels (patches on occlusion
// boundaries), hence its weight.
void FeatureTracker::estimate_covariances() {
  const TileMeasurements& m = tiles_.measurements();
  noise_variances_grey2_.clear();
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] != 0) noise_variances_grey2_.push_back(noise_variance(m, i));
  }
  if (noise_variances_grey2_.empty()) return;
  const float median_noise = upper_median(noise_variances_grey2_);
  constexpr float kExcessWeight = 6;
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] == 0) continue;
    const float excess = std::max(noise_variance(m, i) - median_noise, 0.0F);
    tracks_.covariance_px2[i] = covariance_of(m, i, median_noise + kExcessWeight * excess);
  }
}

void FeatureTracker::check_forward_backward() {
  constexpr int kBackwardSteps = 3;
  constexpr float kMaxOffset_px = 2;
  backward_grid_ = patch_grid(tracks_.current_px, 1, current_.level(0));
  backward_textures_.reset(backward_grid_);
  placement_.resize(backward_grid_.count);
  const auto backward_deformation = [&](std::size_t i) -> Eigen::Matrix2f {
    const Eigen::Matrix2f A = Eigen::Matrix2f::Identity() + gradients_[i];
    return A.determinant() > 0.1F ? A.inverse().eval() : Eigen::Matrix2f::Identity();
  };
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    const bool is_feature = i < tracks_.found.size() && tracks_.found[i] != 0;
    Eigen::Vector2f initial_px(TilePlacement::kOutside_px, TilePlacement::kOutside_px);
    Eigen::Matrix2f deformation = Eigen::Matrix2f::Identity();
    if (is_feature) {
      deformation = backward_deformation(i);
      // starts at the global motion, independent of the result under test
      const Eigen::Vector2f motion_residual_px =
          motion_.at(tracks_.reference_px[i]) - displacements_px_[i];
      const float length = motion_residual_px.norm();
      const Eigen::Vector2f offset_px =
          motion_residual_px * std::min(1.0F, kMaxOffset_px / std::max(length, 1e-6F));
      const Eigen::Vector2f centre(backward_grid_.centre_x_px[i], backward_grid_.centre_y_px[i]);
      initial_px =
          tracks_.reference_px[i] + deformation * (centre - tracks_.current_px[i]) - offset_px;
    }
    placement_.x_px[i] = initial_px.x();
    placement_.y_px[i] = initial_px.y();
    placement_.axx[i] = deformation(0, 0);
    placement_.axy[i] = deformation(0, 1);
    placement_.ayx[i] = deformation(1, 0);
    placement_.ayy[i] = deformation(1, 1);
  }
  for (int step = 0; step < kBackwardSteps; ++step) {
    const TileMeasurements& m = tiles_.measure(
        current_.level(0), reference_.level(0), backward_grid_, placement_, TileWarp::shift, 1.0F,
        {.quintic = true, .contrast = false}, backward_textures_);
    for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
      const Eigen::Vector2f u = tile_step(m, i);
      placement_.x_px[i] += u.x();
      placement_.y_px[i] += u.y();
    }
  }
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] == 0) continue;
    const Eigen::Vector2f centre(backward_grid_.centre_x_px[i], backward_grid_.centre_y_px[i]);
    const Eigen::Vector2f end_px(placement_.x_px[i], placement_.y_px[i]);
    const Eigen::Vector2f expected_px =
        tracks_.reference_px[i] + backward_deformation(i) * (centre - tracks_.current_px[i]);
    if ((end_px - expected_px).norm() > static_cast<float>(config_.forward_backward_px)) {
      tracks_.found[i] = 0;
    }
  }
}

}  // namespace stillkite
