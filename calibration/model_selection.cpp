#include "calibration/model_selection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace stillkite {
namespace {

constexpr std::size_t kFolds = 5;

std::optional<HeldOutError> held_out_error(std::span<const BoardView> views, const LensModel& model,
                                           int width_px, int height_px) {
  const auto whole = fit_lens(views, model, width_px, height_px);
  if (!whole || !covers_image(whole->camera)) return std::nullopt;
  HeldOutError out{.model = model, .squared_px2 = std::vector<double>(views.size())};
  double sum_px2 = 0, components = 0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<BoardView> fitted;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (v % kFolds != fold) fitted.push_back(views[v]);
    }
    const auto fit = fit_lens(fitted, model, width_px, height_px, &whole->camera);
    if (!fit) return std::nullopt;
    for (std::size_t v = fold; v < views.size(); v += kFolds) {
      const auto pose = board_pose(views[v], model, fit->camera);
      if (!pose) return std::nullopt;
      const auto count = static_cast<double>(2 * views[v].pixels.size());
      sum_px2 += pose->squared_error_px2;
      components += count;
      out.squared_px2[v] = pose->squared_error_px2 / count;
    }
  }
  out.rms_px = std::sqrt(sum_px2 / components);
  return out;
}

}  // namespace

bool covers_image(const Camera& camera) {
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = static_cast<double>(i) / kSteps * (camera.width_px - 1);
    const double y = static_cast<double>(i) / kSteps * (camera.height_px - 1);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(x, 0), Eigen::Vector2d(x, camera.height_px - 1), Eigen::Vector2d(0, y),
          Eigen::Vector2d(camera.width_px - 1, y)}) {
      if (!undistort(camera, pixel)) return false;
    }
  }
  return true;
}

std::vector<HeldOutError> held_out_errors(std::span<const BoardView> views, int width_px,
                                          int height_px) {
  std::vector<HeldOutError> errors;
  for (const LensModel& model : kLensModels) {
    if (const auto error = held_out_error(views, model, width_px, height_px)) {
      errors.push_back(*error);
    }
  }
  return errors;
}

LensModel select_model(std::span<const HeldOutError> errors) {
  const HeldOutError& best =
      *std::ranges::min_element(errors, {}, [](const HeldOutError& one) { return one.rms_px; });
  for (const HeldOutError& simpler : errors) {
    const auto n = static_cast<double>(best.squared_px2.size());
    double sum = 0, squares = 0;
    for (std::size_t v = 0; v < best.squared_px2.size(); ++v) {
      const double difference = simpler.squared_px2[v] - best.squared_px2[v];
      sum += difference;
      squares += difference * difference;
    }
    const double mean = sum / n;
    const double variance = std::max(0.0, squares / n - mean * mean) / std::max(1.0, n - 1);
    if (mean <= std::sqrt(variance)) return simpler.model;
  }
  return best.model;
}

}  // namespace stillkite
