// Lens calibration by simulated boards: errors and their covariance. Usage: bench_lens_calibration
// [--board NAME] [--lenses N] [--seed N]
#include "calibration/lens_calibration.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <random>

#include "board_scene.hpp"
#include "calibration/board_detector.hpp"
#include "calibration/view_collector.hpp"

namespace stillkite {
namespace {

// Lenses of 45 to 120 degrees: radial-tangential and equidistant in turn.
Camera draw_lens(std::mt19937_64& random, int number) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const bool is_fisheye = number % 4 == 3;
  Camera camera{.width_px = 960, .height_px = 720};
  camera.focal_x_px = (is_fisheye ? uniform(0.45, 0.65) : uniform(0.6, 1.2)) * camera.width_px;
  camera.focal_y_px = camera.focal_x_px * uniform(0.99, 1.01);
  camera.centre_x_px = 479.5 + uniform(-15, 15);
  camera.centre_y_px = 359.5 + uniform(-15, 15);
  if (is_fisheye) {
    camera.distortion = DistortionModel::equidistant;
    camera.coefficients = {uniform(-0.03, 0.03), uniform(-0.01, 0.01)};
  } else {
    camera.distortion = DistortionModel::radial_tangential;
    camera.coefficients = {uniform(-0.28, 0.05), uniform(0.01, 0.08), uniform(-1e-3, 1e-3),
                           uniform(-1e-3, 1e-3)};
  }
  return camera;
}

struct LensErrors {
  double focal_percent = 0;  // the larger one
  double centre_px = 0;
  double nees = 0;  // of focal lengths and centre, 4 degrees of freedom
};

LensErrors errors_of(const LensFit& fit, const Camera& truth) {
  Eigen::Vector4d error;
  for (int i = 0; i < 4; ++i) error(i) = lens_parameter(fit.camera, i) - lens_parameter(truth, i);
  const Eigen::Matrix4d P = fit.covariance.topLeftCorner<4, 4>();
  return {.focal_percent = 100 * std::max(std::abs(error(0)) / truth.focal_x_px,
                                          std::abs(error(1)) / truth.focal_y_px),
          .centre_px = error.tail<2>().norm(),
          .nees = error.dot(P.ldlt().solve(error))};
}

void run_bench(const BoardConfig& board, int lenses, int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  fmt::print("{:>4} {:<36} {:>5} {:>9} {:>9} {:>9} {:>7} {:>8} {:>9} {:>8}\n", "lens", "model",
             "views", "focal, %", "sigma, %", "centre,px", "sigma", "NEES/4", "corner,px",
             "lens,px");
  double focal_max = 0, centre_max = 0, nees_sum = 0;
  const BoardDetector detector(board);
  for (int number = 0; number < lenses; ++number) {
    const Camera truth = draw_lens(random, number);
    ViewCollector collector(truth.width_px);
    std::int64_t index = 0;
    for (const cv::Mat& image : render_board_views({.board = board, .camera = truth}, random())) {
      auto view = detector.detect(image);
      if (!view) continue;
      view->stamp = Timestamp{1'000'000'000 * ++index};
      collector.add(std::move(*view));
    }
    const auto calibration = calibrate_lens(collector.views(), truth.width_px, truth.height_px);
    const LensFit& fit = calibration.fit;
    const LensErrors errors = errors_of(fit, truth);
    focal_max = std::max(focal_max, errors.focal_percent);
    centre_max = std::max(centre_max, errors.centre_px);
    nees_sum += errors.nees;
    fmt::print(
        "{:>4} {:<36} {:>5} {:>9.4f} {:>9.4f} {:>9.3f} {:>7.3f} {:>8.2f} {:>9.4f} {:>8.4f}\n",
        number + 1, name_of_model(fit.model), calibration.selected.size(), errors.focal_percent,
        100 * std::sqrt(fit.covariance(0, 0)) / truth.focal_x_px, errors.centre_px,
        std::sqrt(fit.covariance(2, 2)), errors.nees / 4, fit.corner_sigma_px,
        calibration.lens_sigma_px);
  }
  fmt::print(
      "largest focal error {:.4f} %, centre {:.3f} px; mean NEES per degree of freedom {:.2f}\n",
      focal_max, centre_max, nees_sum / (4 * lenses));
}

}  // namespace
}  // namespace stillkite

int main(int argc, char** argv) {
  CLI::App app("Lens calibration by simulated boards");
  std::string name = "charuco";
  int lenses = 20, seed = 1;
  app.add_option("--board", name, "Type of the board")
      ->check(CLI::IsMember({"checkerboard", "charuco", "aprilgrid"}));
  app.add_option("--lenses", lenses, "Number of lenses")->check(CLI::Range(1, 1000));
  app.add_option("--seed", seed, "Seed of lenses, views and noise")->check(CLI::Range(1, 1000000));
  CLI11_PARSE(app, argc, argv);
  using stillkite::BoardType;
  stillkite::BoardConfig board;
  if (name == "charuco") {
    board = {.type = BoardType::charuco, .columns = 10, .rows = 7};
  } else if (name == "aprilgrid") {
    board = {.type = BoardType::aprilgrid, .columns = 6, .rows = 5, .square_m = 0.05};
  }
  stillkite::run_bench(board, lenses, seed);
}
