#pragma once

#include <utility>

#include "estimation/robust_kernel.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// Weight of a flow vector: uniform (flow paper), its information matrix, or that times an
/// M-estimator weight.
enum class Weighting { plain, information, robust };

template <>
struct EnumNames<Weighting> {
  static constexpr auto value = std::to_array<std::pair<Weighting, std::string_view>>(
      {{Weighting::plain, "plain"},
       {Weighting::information, "information"},
       {Weighting::robust, "robust"}});
};

/// Covariance estimator: `residuals` assumes independent flow errors; `cells` is a delete-one-cell
/// jackknife, consistent for spatially correlated errors as well.
enum class CovarianceForm { residuals, cells };

template <>
struct EnumNames<CovarianceForm> {
  static constexpr auto value = std::to_array<std::pair<CovarianceForm, std::string_view>>(
      {{CovarianceForm::residuals, "residuals"}, {CovarianceForm::cells, "cells"}});
};

struct LeastSquaresConfig {
  Weighting weighting = Weighting::robust;
  RobustKernel kernel = RobustKernel::tukey;
  CovarianceForm covariance = CovarianceForm::cells;
  int min_windows = 24;
  double inlier_px = 1.0;
  double min_inlier_ratio = 0.5;
  double max_condition = 1e6;

  static void fields(auto& self, auto&& field) {
    field("weighting", self.weighting, "weight of a flow vector");
    field("kernel", self.kernel, "M-estimator kernel of the robust weighting");
    field("covariance", self.covariance, "covariance estimator");
    field("min_windows", self.min_windows, Range{6, 1e6},
          "minimum number of textured flow vectors, and of those on the ground");
    field("inlier_px", self.inlier_px, kPositive, "maximum residual of an inlier, px");
    field("min_inlier_ratio", self.min_inlier_ratio, Range{0, 1},
          "minimum ratio of inliers for a valid estimate");
    field("max_condition", self.max_condition, Range{1, 1e15},
          "maximum condition number of the scaled normal matrix");
  }
};

}  // namespace stillkite
