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

constexpr int kFeatureWindow_px = 16;
constexpr float kFeatureWindowPixels = kFeatureWindow_px * kFeatureWindow_px;
constexpr int kCoarseSteps = 2;
constexpr float kLongestStep_px = 3;
// smaller eigenvalue of the structure tensor that noise of a grey value or two does not feign
constexpr float kTexture = kFeatureWindowPixels / 2;
constexpr int kFewestToGuide = 8;

/// One tile a feature, as near to it as whole pixels and the image's border allow.
TileGrid feature_grid(const std::vector<Eigen::Vector2f>& centres_px, float scale,
                      const cv::Mat& image) {
  TileGrid grid;
  grid.columns = grid.rows = kFeatureWindow_px;
  const int count = static_cast<int>(centres_px.size());
  grid.count = (count + TileGrid::kPadding - 1) / TileGrid::kPadding * TileGrid::kPadding;
  constexpr float kHalf = 0.5F * (kFeatureWindow_px - 1);
  const auto first = [](float centre, int size) {
    return std::clamp(static_cast<int>(std::lround(centre - kHalf)), TileGrid::kBefore_px,
                      size - kFeatureWindow_px - TileGrid::kAfter_px);
  };
  for (int i = 0; i < grid.count; ++i) {
    const bool real = i < count;
    const Eigen::Vector2f at =
        real ? (((centres_px[static_cast<std::size_t>(i)].array() + 0.5F) * scale) - 0.5F).eval()
             : Eigen::Array2f::Constant(kHalf + TileGrid::kBefore_px).eval();
    grid.left_px.push_back(first(at.x(), image.cols));
    grid.top_px.push_back(first(at.y(), image.rows));
    const float nowhere = real ? 0 : TilePlacement::kNowhere_px;
    grid.centre_x_px.push_back(nowhere + static_cast<float>(grid.left_px.back()) + kHalf);
    grid.centre_y_px.push_back(nowhere + static_cast<float>(grid.top_px.back()) + kHalf);
  }
  return grid;
}

float determinant_of(const TileMeasurements& m, std::size_t i) {
  return m.gxx[i] * m.gyy[i] - m.gxy[i] * m.gxy[i];
}

float smaller_eigenvalue(const TileMeasurements& m, std::size_t i) {
  const float half_trace = 0.5F * (m.gxx[i] + m.gyy[i]);
  return half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - determinant_of(m, i)));
}

/// The Lucas-Kanade step G u = g of one tile; nothing happens where there is too little texture.
Eigen::Vector2f tile_step(const TileMeasurements& m, std::size_t i) {
  if (smaller_eigenvalue(m, i) < kTexture) return Eigen::Vector2f::Zero();
  const float determinant = determinant_of(m, i);
  const Eigen::Vector2f u((m.gyy[i] * m.gx[i] - m.gxy[i] * m.gy[i]) / determinant,
                          (m.gxx[i] * m.gy[i] - m.gxy[i] * m.gx[i]) / determinant);
  const float length = u.norm();
  return length > kLongestStep_px ? (u * (kLongestStep_px / length)).eval() : u;
}

/// Of the window in the reference with the window now, before the last step.
float correlation_of(const TileMeasurements& m, std::size_t i) {
  const float current = m.contrast[i] - 2 * m.gain_product[i] + m.residual[i];
  // of a bare window as large sums leave nothing but their rounding
  constexpr float kRounding = 1e-4F;
  if (!(m.contrast[i] > 0 && current > kRounding * m.contrast[i])) return -1;
  return (m.contrast[i] - m.gain_product[i]) / std::sqrt(m.contrast[i] * current);
}

/// Of a pixel, grey^2: what a step, or else a gain, does not explain; at least that of two
/// roundings.
float noise_of(const TileMeasurements& m, std::size_t i) {
  constexpr float kUnknowns = 4;  // step, mean, gain
  constexpr float kRounding_grey2 = 2.0F / 12;
  const Eigen::Vector2f u = tile_step(m, i);
  const float gained =
      m.contrast[i] > 0 ? m.gain_product[i] * m.gain_product[i] / m.contrast[i] : 0.0F;
  const float explained = std::max(m.gx[i] * u.x() + m.gy[i] * u.y(), gained);
  return std::max(kRounding_grey2,
                  (m.residual[i] - explained) / (kFeatureWindowPixels - kUnknowns));
}

/// The noise s^2 is in the gradients as well, which are those of one of two images, by central
/// differences: of the structure tensor G of n pixels n s^2 / 4 are none of the texture's, T. A
/// step is off by T^-1 times sums that vary by s^2 G, hence (T G^-1 T / s^2)^-1.
Eigen::Matrix2f covariance_of(const TileMeasurements& m, std::size_t i, float noise) {
  constexpr float kMostNoise = 0.8F;  // of the smaller eigenvalue
  const float smaller = smaller_eigenvalue(m, i);
  // an edge alone, or nothing: it may be anywhere in its window
  if (!(smaller >= kTexture)) {
    return 0.25F * kFeatureWindowPixels * Eigen::Matrix2f::Identity();
  }
  Eigen::Matrix2f G;
  G << m.gxx[i], m.gxy[i], m.gxy[i], m.gyy[i];
  const float of_noise = std::min(0.25F * kFeatureWindowPixels * noise, kMostNoise * smaller);
  const Eigen::Matrix2f T_inverse = (G - of_noise * Eigen::Matrix2f::Identity()).inverse();
  return noise * T_inverse * G * T_inverse;
}

}  // namespace

void FeatureTracker::set_reference(const cv::Mat& grey,
                                   const std::vector<cv::Point2f>& features_px) {
  reference_.build(grey, config_.levels);
  tracks_ = {};
  for (const cv::Point2f& at : features_px) {
    const float left = std::round(at.x) - 0.5F * kFeatureWindow_px;
    const float top = std::round(at.y) - 0.5F * kFeatureWindow_px;
    constexpr float kReach_px = kFeatureWindow_px + TileGrid::kAfter_px;
    const bool is_inside = left >= TileGrid::kBefore_px && top >= TileGrid::kBefore_px &&
                           left + kReach_px <= static_cast<float>(grey.cols) &&
                           top + kReach_px <= static_cast<float>(grey.rows);
    // what is followed is the window's centre, half a pixel from the corner
    if (is_inside) tracks_.reference_px.emplace_back(left + 7.5F, top + 7.5F);
  }
  grids_.clear();
  textures_.resize(static_cast<std::size_t>(reference_.levels()));
  for (int level = 0; level < reference_.levels(); ++level) {
    grids_.push_back(
        feature_grid(tracks_.reference_px, std::ldexp(1.0F, -level), reference_.level(level)));
    textures_[static_cast<std::size_t>(level)].forget(grids_.back());
  }
  const std::size_t count = tracks_.reference_px.size();
  tracks_.current_px = tracks_.reference_px;
  tracks_.found.assign(count, 0);
  tracks_.covariance_px2.assign(count, Eigen::Matrix2f::Zero());
  displacements_px_.assign(count, Eigen::Vector2f::Zero());
  last_steps_px_.assign(count, 0);
  correlations_.assign(count, 0);
  alive_.assign(count, 0);
  learn_hidden();
  motion_ = {};
  deformation_.set_points(tracks_.reference_px);
  gradients_.assign(count, Eigen::Matrix2f::Zero());
  last_found_count_ = 0;
  has_last_ = false;
}

void FeatureTracker::set_mask(const std::shared_ptr<const ImageMask>& mask) {
  if (mask == mask_) return;
  mask_ = mask;
  learn_hidden();
}

bool FeatureTracker::is_hidden(const Eigen::Vector2f& at_px) const {
  constexpr float kMost = 0.1F;
  return mask_ &&
         mask_->hidden_ratio(at_px.x(), at_px.y(), kFeatureWindow_px, kFeatureWindow_px) > kMost;
}

void FeatureTracker::learn_hidden() {
  hidden_.resize(tracks_.reference_px.size());
  std::transform(tracks_.reference_px.begin(), tracks_.reference_px.end(), hidden_.begin(),
                 [&](const Eigen::Vector2f& at_px) { return is_hidden(at_px) ? 1 : 0; });
}

const FeatureTracks& FeatureTracker::track(const cv::Mat& grey,
                                           std::optional<double> known_turn_rad) {
  current_.build(grey, config_.levels);
  // 1. From where the features were last, or from where they are in the reference.
  const bool warm = config_.warm_start && has_last_;
  if (!warm) motion_ = {};
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    if (!warm || tracks_.found[i] == 0) {
      displacements_px_[i] = motion_.at(tracks_.reference_px[i]);
    }
  }
  align(warm);
  // 2. Where next to none is there, the whole image may have moved far: search it.
  if (config_.search && is_lost()) search(known_turn_rad);
  // 3. Still lost, as in a smeared image: what is found is chance, the next one starts from the
  // last good one and is searched again.
  if (is_lost()) return tracks_;
  if (tracks_.found_count >= kFewestToGuide) {
    motion_ = fit_affine_flow(tracks_.reference_px, displacements_px_, tracks_.found);
    has_last_ = true;
  }
  last_found_count_ = tracks_.found_count;
  return tracks_;
}

void FeatureTracker::align(bool is_warm) {
  // 1. Lucas-Kanade, coarse to fine; what strays on a coarse level goes on with the others.
  for (int level = reference_.levels() - 1; level > 0; --level) {
    for (int i = 0; i < kCoarseSteps; ++i) step(level, TileWarp::shift);
    regularise(level);
  }
  constexpr float kSlightDeformation = 0.03F;
  const TileWarp warp =
      motion_.gradient.norm() > kSlightDeformation ? TileWarp::affine : TileWarp::shift;
  for (std::size_t i = 0; i < gradients_.size(); ++i) {
    if (!is_warm || tracks_.found[i] == 0) gradients_[i] = motion_.gradient;
  }
  // settled by half, the displacements tell how each window is deformed
  for (int i = 0; i < config_.steps; ++i) {
    step(0, warp);
    if (i == config_.steps / 2) gradients_ = deformation_.fit(displacements_px_, alive_, motion_);
  }
  // 2. What has left the image, looks different or does not lead back is lost.
  judge();
  tell_covariances();
  if (config_.forward_backward_px > 0) track_back();
  tracks_.found_count = static_cast<int>(std::count(tracks_.found.begin(), tracks_.found.end(), 1));
}

// Few are left, and they did not leave one by one.
bool FeatureTracker::is_lost() const {
  constexpr double kFewShare = 0.25;
  constexpr double kSuddenShare = 0.5;
  return tracks_.found_count < kFewShare * static_cast<double>(tracks_.found.size()) &&
         (last_found_count_ < kFewestToGuide ||
          tracks_.found_count < kSuddenShare * last_found_count_);
}

void FeatureTracker::search(std::optional<double> known_turn_rad) {
  const AffineFlow last_motion = motion_;
  if (known_turn_rad) {
    search(std::array{*known_turn_rad});
  } else if (!search(kNoTurn_rad)) {
    // most images have hardly turned about their middle, and are found in a seventh of the time
    search(kSlightTurns_rad);
  }
  motion_ = last_motion;
}

// True where the features are found, beyond doubt; else the best that there was is kept.
bool FeatureTracker::search(std::span<const double> turns_rad) {
  constexpr double kEnoughShare = 0.5;  // which no wrong place reaches
  const auto is_found = [&](const FeatureTracks& tracks) {
    return tracks.found_count >= kEnoughShare * static_cast<double>(tracks.found.size());
  };
  FeatureTracks best = tracks_;
  std::vector<Eigen::Vector2f> best_displacements_px = displacements_px_;
  for (const ImageShift& shift : find_shifts(reference_.level(0), current_.level(0),
                                             Eigen::Matrix3d::Identity(), turns_rad)) {
    if (is_found(best)) break;
    start_from(shift);
    align(false);
    if (tracks_.found_count <= best.found_count) continue;
    best = tracks_;
    best_displacements_px = displacements_px_;
  }
  tracks_ = std::move(best);
  displacements_px_ = std::move(best_displacements_px);
  return is_found(tracks_);
}

void FeatureTracker::start_from(const ImageShift& shift) {
  motion_ = {.about_px = {0.5F * static_cast<float>(current_.level(0).cols - 1),
                          0.5F * static_cast<float>(current_.level(0).rows - 1)},
             .offset_px = shift.shift_px.cast<float>()};
  motion_.gradient = Eigen::Rotation2Df(static_cast<float>(shift.turn_rad)).toRotationMatrix() -
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
    const bool is_left_out = k < hidden_.size() && hidden_[k] != 0;
    placement_.x_px[k] = is_left_out ? TilePlacement::kNowhere_px : grid.centre_x_px[k] + d.x();
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
    alive_[i] = m.gxx[i] > 0 ? 1 : 0;
    const Eigen::Vector2f u = tile_step(m, i);
    last_steps_px_[i] = u.norm();
    displacements_px_[i] += std::ldexp(1.0F, level) * u;
    if (!finest) continue;
    correlations_[i] = correlation_of(m, i);
  }
}

void FeatureTracker::regularise(int level) {
  constexpr float kStraySigmas = 4;
  motion_ = fit_affine_flow(tracks_.reference_px, displacements_px_, alive_);
  if (motion_.inliers < kFewestToGuide) {
    motion_.gradient.setZero();
    return;
  }
  const float stray_px = std::max(kStraySigmas * motion_.deviation_px, std::ldexp(1.0F, level));
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    const Eigen::Vector2f expected = motion_.at(tracks_.reference_px[i]);
    if (alive_[i] == 0 || (displacements_px_[i] - expected).norm() > stray_px) {
      displacements_px_[i] = expected;
    }
  }
}

void FeatureTracker::judge() {
  constexpr float kSettled_px = 0.2F;
  constexpr float kMargin_px = 0.5F * kFeatureWindow_px;
  const Eigen::Array2f last = Eigen::Array2f(static_cast<float>(current_.level(0).cols - 1),
                                             static_cast<float>(current_.level(0).rows - 1)) -
                              kMargin_px;
  for (std::size_t i = 0; i < displacements_px_.size(); ++i) {
    tracks_.current_px[i] = tracks_.reference_px[i] + displacements_px_[i];
    const Eigen::Array2f at = tracks_.current_px[i].array();
    const bool is_inside = (at > kMargin_px).all() && (at < last).all();
    tracks_.found[i] = alive_[i] != 0 && is_inside && last_steps_px_[i] < kSettled_px &&
                               correlations_[i] > static_cast<float>(config_.min_correlation) &&
                               !is_hidden(tracks_.current_px[i])
                           ? 1
                           : 0;
  }
}

// By the noise of each window, but no less than that of the median: a camera's is much the same all
// over, and where compression has flattened two windows alike nothing is left of it to be seen.
// What exceeds that hangs together over pixels, as where a window lies over two depths and half of
// it moves otherwise, and moves the window by more than white noise of as many squares would.
void FeatureTracker::tell_covariances() {
  const TileMeasurements& m = tiles_.measurements();
  noise_grey2_.clear();
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] != 0) noise_grey2_.push_back(noise_of(m, i));
  }
  if (noise_grey2_.empty()) return;
  const float least = upper_median(noise_grey2_);
  constexpr float kExcessWeight = 6;
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] == 0) continue;
    const float excess = std::max(noise_of(m, i) - least, 0.0F);
    tracks_.covariance_px2[i] = covariance_of(m, i, least + kExcessWeight * excess);
  }
}

void FeatureTracker::track_back() {
  constexpr int kBackSteps = 3;
  constexpr float kStartOff_px = 2;
  back_grid_ = feature_grid(tracks_.current_px, 1, current_.level(0));
  back_textures_.forget(back_grid_);
  placement_.resize(back_grid_.count);
  const auto back_of = [&](std::size_t i) -> Eigen::Matrix2f {
    const Eigen::Matrix2f A = Eigen::Matrix2f::Identity() + gradients_[i];
    return A.determinant() > 0.1F ? A.inverse().eval() : Eigen::Matrix2f::Identity();
  };
  for (std::size_t i = 0; i < placement_.x_px.size(); ++i) {
    const bool real = i < tracks_.found.size() && tracks_.found[i] != 0;
    Eigen::Vector2f start(TilePlacement::kNowhere_px, TilePlacement::kNowhere_px);
    Eigen::Matrix2f back = Eigen::Matrix2f::Identity();
    if (real) {
      back = back_of(i);
      // from where the image as a whole would have it, not from the answer that is tested
      const Eigen::Vector2f whole = motion_.at(tracks_.reference_px[i]) - displacements_px_[i];
      const float length = whole.norm();
      const Eigen::Vector2f off = whole * std::min(1.0F, kStartOff_px / std::max(length, 1e-6F));
      const Eigen::Vector2f centre(back_grid_.centre_x_px[i], back_grid_.centre_y_px[i]);
      start = tracks_.reference_px[i] + back * (centre - tracks_.current_px[i]) - off;
    }
    placement_.x_px[i] = start.x();
    placement_.y_px[i] = start.y();
    placement_.axx[i] = back(0, 0);
    placement_.axy[i] = back(0, 1);
    placement_.ayx[i] = back(1, 0);
    placement_.ayy[i] = back(1, 1);
  }
  for (int step = 0; step < kBackSteps; ++step) {
    const TileMeasurements& m =
        tiles_.measure(current_.level(0), reference_.level(0), back_grid_, placement_,
                       TileWarp::shift, 1.0F, {.quintic = true, .contrast = false}, back_textures_);
    for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
      const Eigen::Vector2f u = tile_step(m, i);
      placement_.x_px[i] += u.x();
      placement_.y_px[i] += u.y();
    }
  }
  for (std::size_t i = 0; i < tracks_.found.size(); ++i) {
    if (tracks_.found[i] == 0) continue;
    const Eigen::Vector2f centre(back_grid_.centre_x_px[i], back_grid_.centre_y_px[i]);
    const Eigen::Vector2f led_to(placement_.x_px[i], placement_.y_px[i]);
    const Eigen::Vector2f began =
        tracks_.reference_px[i] + back_of(i) * (centre - tracks_.current_px[i]);
    if ((led_to - began).norm() > static_cast<float>(config_.forward_backward_px)) {
      tracks_.found[i] = 0;
    }
  }
}

}  // namespace stillkite
