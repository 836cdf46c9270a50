#include "calibration/lens_calibration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "calibration/image_coverage.hpp"
#include "calibration/view_collector.hpp"
#include "calibration/view_selection.hpp"
#include "tests/calibration/synthetic_views.hpp"
#include "tests/geometry/sample_cameras.hpp"

namespace stillkite {
namespace {

constexpr LensModel kRadial4{DistortionModel::radial_tangential, 4};
constexpr LensModel kRadial8{DistortionModel::radial_tangential, 8};
constexpr LensModel kEquidistant{DistortionModel::equidistant, 4};

Camera sample(const std::string& name) {
  for (const SampleCamera& one : sample_cameras()) {
    if (one.name == name) return one.camera;
  }
  return {};
}

double largest_error(const Camera& a, const Camera& b, const LensModel& model) {
  double largest = 0;
  for (int i = 0; i < model.parameters(); ++i) {
    largest = std::max(largest, std::abs(lens_parameter(a, i) - lens_parameter(b, i)));
  }
  return largest;
}

TEST(LensModel, DerivativesAgreeWithDifferences) {
  constexpr double kStep = 1e-6;
  const Eigen::Vector3d point(0.4, -0.25, 1.3);
  for (const auto& [camera, model] :
       {std::pair(sample("radtan8"), kRadial8), std::pair(sample("equidistant"), kEquidistant)}) {
    const auto at = project_with_derivatives(camera, model, point);
    ASSERT_TRUE(at);
    for (int i = 0; i < model.parameters(); ++i) {
      Camera moved = camera;
      add_to_lens(moved, kStep * Eigen::VectorXd::Unit(model.parameters(), i));
      const Eigen::Vector2d difference = (*project(moved, point) - at->pixel) / kStep;
      EXPECT_LT((difference - at->by_parameters.col(i)).norm(), 2e-4)
          << name_of_parameter(model, i);
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector2d difference =
          (*project(camera, point + kStep * Eigen::Vector3d::Unit(i)) - at->pixel) / kStep;
      EXPECT_LT((difference - at->by_point.col(i)).norm(), 2e-3);
    }
  }
}

TEST(LensFit, FindsTheLensOfExactCorners) {
  for (const auto& [name, model] :
       {std::pair("radtan4", kRadial4), std::pair("equidistant", kEquidistant)}) {
    const Camera truth = sample(name);
    const auto views = synthetic_views(truth, 12, 0, 1);
    const auto fit = fit_lens(views, model, truth.width_px, truth.height_px);
    ASSERT_TRUE(fit) << name;
    EXPECT_LT(largest_error(fit->camera, truth, model), 1e-4) << name;
  }
}

TEST(LensFit, RemovesOutliers) {
  const Camera truth = sample("radtan4");
  auto views = synthetic_views(truth, 15, 0.05, 2);
  for (std::size_t v = 0; v < views.size(); v += 3) views[v].pixels[7] += Eigen::Vector2d(3, -2);
  const auto fit = fit_lens(views, kRadial4, truth.width_px, truth.height_px);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->corner_sigma_px, 0.05, 0.005);
  EXPECT_FALSE(fit->inliers[0][7]);
  EXPECT_NEAR(fit->camera.focal_x_px, truth.focal_x_px, 0.4);
}

TEST(LensFit, CovarianceIsConsistent) {
  constexpr int kDraws = 30;
  const Camera truth = sample("radtan4");
  double nees = 0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const auto views = synthetic_views(truth, 15, 0.1, seed);
    const auto fit = fit_lens(views, kRadial4, truth.width_px, truth.height_px, &truth);
    ASSERT_TRUE(fit);
    Eigen::VectorXd error(8);
    for (int i = 0; i < 8; ++i) {
      error(i) = lens_parameter(fit->camera, i) - lens_parameter(truth, i);
    }
    nees += error.dot(fit->covariance.ldlt().solve(error));
  }
  // chi square of 240 degrees of freedom: 240 +- 4 sigma
  EXPECT_NEAR(nees, 8 * kDraws, 4 * std::sqrt(2.0 * 8 * kDraws));
}

TEST(LensCalibration, SelectsTheModelOfTheLens) {
  for (const auto& [name, model] : {std::pair("none", LensModel{}), std::pair("radtan4", kRadial4),
                                    std::pair("equidistant", kEquidistant)}) {
    const Camera truth = sample(name);
    const auto views = synthetic_views(truth, 40, 0.05, 3);
    const LensCalibration calibration = calibrate_lens(views, truth.width_px, truth.height_px);
    EXPECT_EQ(name_of_model(calibration.fit.model), name_of_model(model));
    EXPECT_NEAR(calibration.fit.camera.focal_x_px, truth.focal_x_px, 0.001 * truth.focal_x_px);
    EXPECT_NEAR(calibration.fit.camera.centre_x_px, truth.centre_x_px, 1);
  }
}

TEST(LensCalibration, RefusesViewsWithoutTilt) {
  const Camera truth = sample("radtan4");
  auto views = synthetic_views(truth, 20, 0.1, 4);
  for (BoardView& view : views) {
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      // parallel to the image, at one place
      view.pixels[i] =
          Eigen::Vector2d(376, 240) + 2000 * view.corners_m[i] +
          1e-2 * Eigen::Vector2d(std::sin(3.0 * view.ids[i]), std::cos(5.0 * view.ids[i]));
    }
  }
  EXPECT_THROW((void)calibrate_lens(views, truth.width_px, truth.height_px), InputError);
}

TEST(LensCalibration, RefusesFewViews) {
  const Camera truth = sample("radtan4");
  EXPECT_THROW((void)calibrate_lens(synthetic_views(truth, 6, 0.1, 5), 752, 480), InputError);
}

TEST(ViewSelection, RejectsViewsThatTheLensDoesNotExplain) {
  const Camera truth = sample("radtan4");
  auto views = synthetic_views(truth, 30, 0.1, 6);
  for (std::size_t i = 0; i < views[11].pixels.size(); ++i) {
    views[11].pixels[i].x() += 3 * std::sin(2.0 * views[11].ids[i]);
  }
  const auto selected = select_views(views, kRadial4, truth);
  EXPECT_EQ(std::ranges::count(selected, 11U), 0);
  EXPECT_GT(selected.size(), 10U);
}

TEST(ViewSelection, PrefersNewPlacesAndTilts) {
  const Camera truth = sample("radtan4");
  const auto distinct = synthetic_views(truth, 12, 0, 7);
  std::vector<BoardView> views(40, distinct[0]);  // one view again and again
  views.insert(views.end(), distinct.begin() + 1, distinct.end());
  const auto selected = select_views(views, kRadial4, truth);
  const auto other = std::ranges::count_if(selected, [](std::size_t i) { return i >= 40; });
  EXPECT_GE(other, 8);  // of 11
}

TEST(ViewCollector, KeepsTheSlowestOfNearlyEqualViews) {
  BoardView view{.ids = {0, 1}, .corners_m = {{0, 0}, {1, 0}}, .pixels = {{100, 100}, {200, 100}}};
  ViewCollector collector(1000);
  const auto add_at = [&](double t_s, double x_px) {
    view.stamp = from_seconds(t_s);
    view.pixels = {{x_px, 100}, {x_px + 100, 100}};
    collector.add(view);
  };
  add_at(0, 100);
  add_at(0.1, 112);
  add_at(0.2, 113);  // the slowest of the first three
  add_at(0.3, 400);
  const auto views = collector.views();
  ASSERT_EQ(views.size(), 2U);
  EXPECT_EQ(views[0].pixels[0].x(), 113);
  EXPECT_EQ(views[1].pixels[0].x(), 400);
}

TEST(ImageCoverage, NamesUnseenCorners) {
  BoardView view{.pixels = {{10, 10}, {630, 20}, {20, 470}}};
  const auto unseen = unseen_corners(std::span(&view, 1), 640, 480);
  ASSERT_EQ(unseen.size(), 1U);
  EXPECT_EQ(unseen[0], "lower right");
}

}  // namespace
}  // namespace stillkite
