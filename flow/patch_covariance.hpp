#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "flow/tile_flow.hpp"

namespace stillkite {

/// Median residual variance of a pixel over the patches with `found` = 1; nullopt without any.
/// `scratch`: buffer, its values are overwritten.
[[nodiscard]] std::optional<float> median_noise_variance_grey2(
    const TileMeasurements& m, const std::vector<unsigned char>& found,
    std::vector<float>& scratch);

/// Covariance of the displacement of patch i from its residual under white pixel noise, px^2.
/// Noise: at least the median over the patches, since compression can remove the noise of a patch
/// in both images. Residual in excess of the median is correlated between pixels (patches on
/// occlusion boundaries), hence its weight of 6.
[[nodiscard]] Eigen::Matrix2f patch_covariance_px2(const TileMeasurements& m, std::size_t i,
                                                   float median_noise_grey2);

}  // namespace stillkite
