#pragma once

#include <utility>

#include "estimation/robust_kernel.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// How much a window's vector counts: all the same (the flow paper's), by its information, or by
/// that and by how well the one motion explains it.
enum class Weighting { plain, information, robust };

template <>
struct EnumNames<Weighting> {
  static constexpr auto value = std::to_array<std::pair<Weighting, std::string_view>>(
      {{Weighting::plain, "plain"},
       {Weighting::information, "information"},
       {Weighting::robust, "robust"}});
};

/// What the covariance rests on: `residuals` takes the windows' errors as independent; `cells`
/// deletes one cell of the image at a time (jackknife), true also when neighbours err together.
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
  int max_iterations = 15;
  int min_windows = 24;
  double inlier_px = 1.0;
  double min_inlier_ratio = 0.5;
  double max_condition = 1e6;

  static void fields(auto& self, auto&& field) {
    field("weighting", self.weighting, "how much a window's vector counts");
    field("kernel", self.kernel, "of the robust weighting");
    field("covariance", self.covariance, "what the covariance rests on");
    field("max_iterations", self.max_iterations, Range{1, 100}, "of the reweighting");
    field("min_windows", self.min_windows, Range{6, 1e6}, "with texture, and on the ground");
    field("inlier_px", self.inlier_px, kPositive, "a larger residual makes an outlier");
    field("min_inlier_ratio", self.min_inlier_ratio, Range{0, 1}, "below it no one motion fits");
    field("max_condition", self.max_condition, Range{1, 1e15}, "of the scaled normal matrix");
  }
};

}  // namespace stillkite
