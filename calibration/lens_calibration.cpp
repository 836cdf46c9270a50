#include "calibration/lens_calibration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/lens_uncertainty.hpp"
#include "calibration/view_selection.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMinViews = 10;
constexpr const char* kRemedy =
    "record the board over the whole image, tilted by 20 to 45 degrees to each side, sharp and at "
    "several distances";

std::vector<BoardView> views_at(std::span<const BoardView> views,
                                const std::vector<std::size_t>& indices) {
  std::vector<BoardView> out;
  for (const std::size_t i : indices) out.push_back(views[i]);
  return out;
}

std::vector<std::size_t> evenly_spaced(std::size_t count, std::size_t limit) {
  std::vector<std::size_t> indices;
  const std::size_t n = std::min(count, limit);
  for (std::size_t i = 0; i < n; ++i) indices.push_back(i * count / n);
  return indices;
}

// First estimate, to judge all views with: the model of the smallest residuals.
std::optional<LensFit> preliminary_fit(std::span<const BoardView> views, int width_px,
                                       int height_px) {
  constexpr std::size_t kMaxViews = 30;
  constexpr std::array kModels{LensModel{DistortionModel::radial_tangential, 4},
                               LensModel{DistortionModel::equidistant, 4}};
  const std::vector<BoardView> some = views_at(views, evenly_spaced(views.size(), kMaxViews));
  std::optional<LensFit> best;
  for (const LensModel& model : kModels) {
    auto fit = fit_lens(some, model, width_px, height_px);
    if (fit && (!best || fit->corner_sigma_px < best->corner_sigma_px)) best = std::move(fit);
  }
  return best;
}

void check_determined(const LensFit& fit) {
  constexpr double kMaxFocalSigma_ratio = 0.02;
  const double sigma_px = std::sqrt(std::max(fit.covariance(0, 0), fit.covariance(1, 1)));
  if (!(sigma_px <= kMaxFocalSigma_ratio * fit.camera.focal_x_px)) {
    throw InputError(
        fmt::format("calibration_board: the views determine the focal length to {:.1f} % only; {}",
                    100 * sigma_px / fit.camera.focal_x_px, kRemedy));
  }
}

}  // namespace

LensCalibration calibrate_lens(std::span<const BoardView> views, int width_px, int height_px) {
  if (views.size() < kMinViews) {
    throw InputError(fmt::format(
        "calibration_board: found in {} different views, at least {} are needed; check type, "
        "columns and rows, and {}",
        views.size(), kMinViews, kRemedy));
  }
  const auto preliminary = preliminary_fit(views, width_px, height_px);
  if (!preliminary) {
    throw InputError(
        fmt::format("calibration_board: no lens fits the views; check the keys of the "
                    "board, and {}",
                    kRemedy));
  }
  LensCalibration out{.fit = *preliminary,
                      .selected = select_views(views, preliminary->model, preliminary->camera)};
  const std::vector<BoardView> selected = views_at(views, out.selected);
  if (selected.size() < kMinViews) {
    throw InputError(
        fmt::format("calibration_board: {} of {} views are usable, at least {} are needed; {}",
                    selected.size(), views.size(), kMinViews, kRemedy));
  }
  out.models = held_out_errors(selected, width_px, height_px);
  if (out.models.empty()) {
    throw InputError(fmt::format(
        "calibration_board: no lens model fits the views and covers the image; {}", kRemedy));
  }
  const auto fit = fit_lens(selected, select_model(out.models), width_px, height_px);
  if (!fit) throw InputError(fmt::format("calibration_board: the fit diverges; {}", kRemedy));
  check_determined(*fit);
  out.fit = *fit;
  out.lens_sigma_px = lens_sigma_px(out.fit);
  return out;
}

}  // namespace stillkite
