#include "flow/patch_covariance.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "flow/feature_patch.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

/// Residual variance of a pixel, grey^2, after the better of step and gain; at least the
/// quantization variance of two images.
float noise_variance(const TileMeasurements& m, std::size_t i) {
  constexpr float kParameters = 4;  // step, mean, gain
  constexpr float kRounding_grey2 = 2.0F / 12;
  const Eigen::Vector2f u = patch_step_px(m, i);
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

std::optional<float> median_noise_variance_grey2(const TileMeasurements& m,
                                                 const std::vector<unsigned char>& found,
                                                 std::vector<float>& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] != 0) scratch.push_back(noise_variance(m, i));
  }
  if (scratch.empty()) return std::nullopt;
  return upper_median(scratch);
}

Eigen::Matrix2f patch_covariance_px2(const TileMeasurements& m, std::size_t i,
                                     float median_noise_grey2) {
  constexpr float kExcessWeight = 6;
  const float excess = std::max(noise_variance(m, i) - median_noise_grey2, 0.0F);
  return covariance_of(m, i, median_noise_grey2 + kExcessWeight * excess);
}

}  // namespace stillkite
