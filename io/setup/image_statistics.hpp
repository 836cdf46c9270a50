#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "flow/frame.hpp"

namespace stillkite {

/// Gradients of one image, sums over its pixels in grey^2: first derivatives (xx, xy, yy) and
/// squared second derivatives along a direction u = (c, s): sum of (u^T H u)^2 = q(u).
struct ImageGradients {
  Eigen::Matrix2d first = Eigen::Matrix2d::Zero();
  /// Moments of (I_xx, 2 I_xy, I_yy).
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< image displacement since the last frame
};

/// Figures of the grey values of a recording. Sampled: every kRowStep-th row, without masked
/// pixels.
class ImageStatistics {
 public:
  void add(const Frame& frame);

  /// Ratio of pixels within 2 grey of the brightest ones (99.9 % quantile), if these are above 200.
  [[nodiscard]] double saturated_ratio() const;
  /// Ratio of pixels within 2 grey of the darkest ones (0.1 % quantile), if these are below 40.
  [[nodiscard]] double dark_ratio() const;

  /// Standard deviation of the Gaussian that blurs white texture as much as the images are blurred;
  /// an upper bound of the blur of other textures. From the structure functions at 2 and 4 px:
  /// D(r) ~ 1 - exp(-r^2 / (4 sigma^2)). At most kMaxBlur_px.
  [[nodiscard]] double blur_px() const;
  static constexpr double kMaxBlur_px = 20;

  /// Mean ratio of textured blocks (`textured_ratio`).
  [[nodiscard]] double textured_ratio() const;
  [[nodiscard]] int frames() const { return frames_; }

  /// Of one frame, for the motion blur.
  [[nodiscard]] static ImageGradients gradients(const Frame& frame);

 private:
  std::array<std::int64_t, 256> histogram_{};
  std::int64_t pixels_ = 0;
  double structure2_ = 0, structure4_ = 0;
  double textured_sum_ = 0;
  int frames_ = 0;
};

}  // namespace stillkite
