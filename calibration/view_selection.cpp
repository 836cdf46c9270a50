#include "calibration/view_selection.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

struct Candidate {
  std::size_t view;
  Eigen::MatrixXd information;
  double rms_px;
};

std::vector<Candidate> candidates_of(std::span<const BoardView> views, const LensModel& model,
                                     const Camera& camera) {
  constexpr double kMaxRms_medians = 3;
  std::vector<Candidate> candidates;
  std::vector<double> all_px;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto pose = board_pose(views[v], model, camera);
    if (!pose) continue;
    const auto components = static_cast<double>(2 * views[v].pixels.size());
    const double rms_px = std::sqrt(pose->squared_error_px2 / components);
    all_px.push_back(rms_px);
    candidates.push_back(
        {v, lens_information(views[v], model, camera, pose->camera_from_board), rms_px});
  }
  if (candidates.empty()) return candidates;
  const double limit_px = kMaxRms_medians * median(all_px);
  std::erase_if(candidates, [&](const Candidate& one) { return one.rms_px > limit_px; });
  return candidates;
}

double log_determinant(const Eigen::MatrixXd& information) {
  return information.ldlt().vectorD().cwiseMax(1e-300).array().log().sum();
}

}  // namespace

std::vector<std::size_t> select_views(std::span<const BoardView> views, const LensModel& model,
                                      const Camera& camera) {
  constexpr double kMinReduction = 0.01;
  constexpr double kRegularization = 1e-12;  // until a few views determine the lens
  std::vector<Candidate> candidates = candidates_of(views, model, camera);
  std::vector<std::size_t> selected;
  if (candidates.empty()) return selected;
  const int n = model.parameters();
  // in units of each parameter's information in all views
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(n);
  for (const Candidate& one : candidates) unit += one.information.diagonal();
  unit = unit.cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd total = kRegularization * Eigen::MatrixXd::Identity(n, n);
  double determinant = log_determinant(total);
  while (!candidates.empty()) {
    std::size_t best = 0;
    double best_determinant = -HUGE_VAL;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double with = log_determinant(total + unit.asDiagonal() * candidates[i].information *
                                                      unit.asDiagonal());
      if (with > best_determinant) {
        best_determinant = with;
        best = i;
      }
    }
    // the determinant is that of the inverse covariance: n parameters, sigma squared
    if (best_determinant - determinant < 2 * n * kMinReduction) break;
    determinant = best_determinant;
    total += unit.asDiagonal() * candidates[best].information * unit.asDiagonal();
    selected.push_back(candidates[best].view);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
  }
  std::ranges::sort(selected);
  return selected;
}

}  // namespace stillkite
