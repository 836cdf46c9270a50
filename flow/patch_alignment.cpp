#include "flow/patch_alignment.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "flow/feature_patch.hpp"
#include "flow/patch_covariance.hpp"

namespace stillkite {

void PatchAlignment::set_reference(const cv::Mat& grey,
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
}

void PatchAlignment::set_mask(const std::shared_ptr<const ImageMask>& mask) {
  if (mask == mask_) return;
  mask_ = mask;
  update_masked_features();
}

bool PatchAlignment::is_masked(const Eigen::Vector2f& at_px) const {
  constexpr float kMaxMaskedRatio = 0.1F;
  return mask_ && mask_->masked_ratio(at_px.x(), at_px.y(), kPatch_px, kPatch_px) > kMaxMaskedRatio;
}

void PatchAlignment::update_masked_features() {
  masked_.resize(tracks_.reference_px.size());
  std::transform(tracks_.reference_px.begin(), tracks_.reference_px.end(), masked_.begin(),
                 [&](const Eigen::Vector2f& at_px) { return is_masked(at_px) ? 1 : 0; });
}

void PatchAlignment::align_from(const AffineFlow& motion) {
  motion_ = motion;
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    displacements_px_[i] = motion_.at(tracks_.reference_px[i]);
  }
  align(false);
}

void PatchAlignment::align_from_last(const AffineFlow& since) {
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    Eigen::Vector2f& displacement_px = displacements_px_[i];
    if (tracks_.found[i] == 0) displacement_px = motion_.at(tracks_.reference_px[i]);
    displacement_px += since.at(tracks_.reference_px[i] + displacement_px);
  }
  align(true);
}

void PatchAlignment::fit_motion() {
  motion_ = fit_affine_flow(tracks_.reference_px, displacements_px_, tracks_.found);
}

void PatchAlignment::restore(Solution solution, const AffineFlow& motion) {
  tracks_ = std::move(solution.tracks);
  displacements_px_ = std::move(solution.displacements_px);
  motion_ = motion;
}

void PatchAlignment::align(bool is_warm) {
  constexpr int kCoarseSteps = 2;
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

void PatchAlignment::place(int level) {
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

void PatchAlignment::step(int level, TileWarp warp) {
  place(level);
  const bool finest = level == 0;
  const TileMeasurements& m = tiles_.measure(reference_.level(level), current_.level(level),
                                             grids_[static_cast<std::size_t>(level)], placement_,
                                             warp, 1.0F, {.quintic = finest, .contrast = finest},
                                             textures_[static_cast<std::size_t>(level)]);
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    measured_[i] = m.gxx[i] > 0 ? 1 : 0;
    const Eigen::Vector2f u = patch_step_px(m, i);
    last_step_lengths_px_[i] = u.norm();
    displacements_px_[i] += std::ldexp(1.0F, level) * u;
    if (!finest) continue;
    correlations_[i] = patch_correlation(m, i);
  }
}

void PatchAlignment::replace_outliers(int level) {
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

void PatchAlignment::validate() {
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

void PatchAlignment::estimate_covariances() {
  const TileMeasurements& m = tiles_.measurements();
  const std::optional<float> noise_grey2 =
      median_noise_variance_grey2(m, tracks_.found, noise_variances_grey2_);
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] != 0) {
      tracks_.covariance_px2[i] = patch_covariance_px2(m, i, *noise_grey2);
    }
  }
}

void PatchAlignment::check_forward_backward() {
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
      const Eigen::Vector2f u = patch_step_px(m, i);
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
