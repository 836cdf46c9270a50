#include "calibration/lens_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/view_equations.hpp"
#include "estimation/robust_kernel.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr int kMaxIterations = 60;
constexpr double kConverged = 1e-9;  // relative decrease of the squared error

// Iterations over lens and poses; the state is that of the fit.
class LensSolver {
 public:
  LensSolver(std::span<const BoardView> views, LensFit& fit) : views_(views), fit_(fit) {}

  // `free`: number of leading parameters that are estimated. Returns false if the error is not
  // finite.
  bool solve(int free) {
    double lambda = 1e-3;
    std::vector<ViewEquations> equations = linearize(fit_.camera, fit_.camera_from_board);
    double error_px2 = error_of(equations);
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      if (!std::isfinite(error_px2)) return false;
      const auto [camera, poses] = stepped(equations, free, lambda);
      std::vector<ViewEquations> next = linearize(camera, poses);
      const double next_px2 = error_of(next);
      if (!(next_px2 <= error_px2)) {
        if ((lambda *= 10) > 1e9) break;  // at the minimum, up to rounding
        continue;
      }
      const bool is_converged = error_px2 - next_px2 < kConverged * error_px2;
      fit_.camera = camera;
      fit_.camera_from_board = poses;
      equations = std::move(next);
      error_px2 = next_px2;
      lambda = std::max(1e-9, 0.1 * lambda);
      if (is_converged) break;
    }
    finish(equations, error_px2);
    return std::isfinite(error_px2);
  }

 private:
  [[nodiscard]] std::vector<ViewEquations> linearize(
      const Camera& camera, const std::vector<RigidTransform>& poses) const {
    std::vector<ViewEquations> equations;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      equations.push_back(view_equations(views_[v], fit_.inliers[v], fit_.model, camera, poses[v]));
    }
    return equations;
  }

  static double error_of(const std::vector<ViewEquations>& equations) {
    double sum_px2 = 0;
    for (const ViewEquations& view : equations) {
      sum_px2 += view.is_in_front ? view.squared_error_px2 : HUGE_VAL;
    }
    return sum_px2;
  }

  // Lens parameters by the Schur complement, then the poses.
  [[nodiscard]] std::pair<Camera, std::vector<RigidTransform>> stepped(
      const std::vector<ViewEquations>& equations, int free, double lambda) const {
    const int n = fit_.model.parameters();
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::LDLT<Matrix6d>> factors;
    for (const ViewEquations& view : equations) {
      Matrix6d H = view.H_pose;
      H.diagonal() *= 1 + lambda;
      factors.emplace_back(H);
      S += view.H_lens - view.H_lens_pose * factors.back().solve(view.H_lens_pose.transpose());
      S.diagonal() += lambda * view.H_lens.diagonal();
      g += view.g_lens - view.H_lens_pose * factors.back().solve(view.g_pose);
    }
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    step.head(free) = S.topLeftCorner(free, free).ldlt().solve(g.head(free));
    Camera camera = fit_.camera;
    add_to_lens(camera, step);
    std::vector<RigidTransform> poses;
    for (std::size_t v = 0; v < equations.size(); ++v) {
      const Vector6d pose_step =
          factors[v].solve(equations[v].g_pose - equations[v].H_lens_pose.transpose() * step);
      poses.push_back(moved_pose(fit_.camera_from_board[v], pose_step));
    }
    return {camera, poses};
  }

  void finish(const std::vector<ViewEquations>& equations, double error_px2) {
    const int n = fit_.model.parameters();
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    std::int64_t freedom = -n - 6 * std::ssize(equations);
    fit_.residuals.clear();
    for (std::size_t v = 0; v < equations.size(); ++v) {
      const ViewEquations& view = equations[v];
      information +=
          view.H_lens - view.H_lens_pose * view.H_pose.ldlt().solve(view.H_lens_pose.transpose());
      freedom += 2 * std::ranges::count(fit_.inliers[v], true);
      fit_.residuals.push_back(view.residuals);
    }
    const double variance_px2 = error_px2 / static_cast<double>(std::max<std::int64_t>(1, freedom));
    fit_.corner_sigma_px = std::sqrt(variance_px2);
    fit_.covariance = variance_px2 * information.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  }

  std::span<const BoardView> views_;
  LensFit& fit_;
};

std::optional<LensFit> initial_fit(std::span<const BoardView> views, const LensModel& model,
                                   const Camera& camera) {
  LensFit fit{.model = model, .camera = camera};
  for (const BoardView& view : views) {
    const auto pose = initial_pose(view, camera);
    if (!pose) return std::nullopt;
    fit.camera_from_board.push_back(*pose);
    fit.inliers.emplace_back(view.pixels.size(), true);
  }
  return fit;
}

// Focal length and poses first, then the first coefficients, then everything.
std::optional<LensFit> fit_from(std::span<const BoardView> views, const LensModel& model,
                                const Camera& camera, bool is_first_estimate) {
  std::optional<LensFit> fit = initial_fit(views, model, camera);
  if (!fit) return fit;
  LensSolver solver(views, *fit);
  if (is_first_estimate && !(solver.solve(2) && solver.solve(std::min(6, model.parameters())))) {
    return std::nullopt;
  }
  if (!solver.solve(model.parameters())) return std::nullopt;
  return fit;
}

double median_distance_px(const std::vector<std::vector<Eigen::Vector2d>>& residuals) {
  std::vector<double> distances_px;
  for (const auto& view : residuals) {
    for (const Eigen::Vector2d& residual : view) distances_px.push_back(residual.norm());
  }
  return median(distances_px);
}

// False if no corner changed its side.
bool update_inliers(LensFit& fit) {
  constexpr double kMaxSigmas = 4;
  const double limit_px = kMaxSigmas * median_distance_px(fit.residuals) / kRayleighMedian;
  bool is_changed = false;
  for (std::size_t v = 0; v < fit.residuals.size(); ++v) {
    for (std::size_t i = 0; i < fit.residuals[v].size(); ++i) {
      const bool is_inlier = fit.residuals[v][i].norm() <= limit_px;
      is_changed |= is_inlier != fit.inliers[v][i];
      fit.inliers[v][i] = is_inlier;
    }
  }
  return is_changed;
}

}  // namespace

std::optional<LensFit> fit_lens(std::span<const BoardView> views, const LensModel& model,
                                int width_px, int height_px, const Camera* initial) {
  constexpr std::array kFocal_ratios{0.25, 0.4, 0.6, 0.9, 1.4, 2.2};  // of the image width
  constexpr int kOutlierRounds = 3;
  std::optional<LensFit> best;
  if (initial != nullptr) {
    best = fit_from(views, model, *initial, false);
  } else {
    for (const double ratio : kFocal_ratios) {
      const Camera camera{.width_px = width_px,
                          .height_px = height_px,
                          .focal_x_px = ratio * width_px,
                          .focal_y_px = ratio * width_px,
                          .centre_x_px = 0.5 * (width_px - 1),
                          .centre_y_px = 0.5 * (height_px - 1),
                          .distortion = model.distortion};
      std::optional<LensFit> fit = fit_from(views, model, camera, true);
      if (fit && (!best || fit->corner_sigma_px < best->corner_sigma_px)) best = std::move(fit);
    }
  }
  for (int round = 0; best && round < kOutlierRounds && update_inliers(*best); ++round) {
    if (!LensSolver(views, *best).solve(model.parameters())) return std::nullopt;
  }
  if (best && !(best->camera.focal_x_px > 0 && best->camera.focal_y_px > 0)) return std::nullopt;
  return best;
}

std::optional<BoardPose> board_pose(const BoardView& view, const LensModel& model,
                                    const Camera& camera) {
  constexpr int kMaxPoseIterations = 20;
  constexpr double kMinDecrease = 1e-6;
  const auto initial = initial_pose(view, camera);
  if (!initial) return std::nullopt;
  BoardPose best{.camera_from_board = *initial, .squared_error_px2 = HUGE_VAL};
  RigidTransform pose = *initial;
  for (int iteration = 0; iteration < kMaxPoseIterations; ++iteration) {
    const ViewEquations equations = view_equations(view, {}, model, camera, pose);
    if (!equations.is_in_front) return std::nullopt;
    const double decrease = best.squared_error_px2 - equations.squared_error_px2;
    if (decrease > 0) best = {pose, equations.squared_error_px2};
    if (!(decrease > kMinDecrease * equations.squared_error_px2)) break;
    pose = moved_pose(pose, equations.H_pose.ldlt().solve(equations.g_pose));
  }
  return best;
}

Eigen::MatrixXd lens_information(const BoardView& view, const LensModel& model,
                                 const Camera& camera, const RigidTransform& camera_from_board) {
  const ViewEquations equations = view_equations(view, {}, model, camera, camera_from_board);
  return equations.H_lens -
         equations.H_lens_pose * equations.H_pose.ldlt().solve(equations.H_lens_pose.transpose());
}

double view_rms_px(const std::vector<Eigen::Vector2d>& residuals) {
  double sum_px2 = 0;
  for (const Eigen::Vector2d& residual : residuals) sum_px2 += residual.squaredNorm();
  return std::sqrt(sum_px2 / (2 * static_cast<double>(std::max<std::size_t>(1, residuals.size()))));
}

}  // namespace stillkite
