#include "estimation/ego_motion/flow_rows.hpp"

#include <gtest/gtest.h>

#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "estimation/ego_motion/motion_field.hpp"
#include "tests/estimation/ego_motion/flow_scene.hpp"

namespace stillkite {
namespace {

struct Reference {
  TwistEquations sums;
  std::vector<double> squared_distances;
};

Eigen::Matrix2d information_of(const FlowRows& rows, std::size_t i) {
  Eigen::Matrix2d G;
  G << rows.gxx[i], rows.gxy[i], rows.gxy[i], rows.gyy[i];
  return G;
}

// The sums as their formulas read.
Reference straightforward(const FlowRows& rows, const Vector6d& twist,
                          const std::vector<double>& weights) {
  Reference out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const MotionFieldMatrix m = motion_field({rows.x[i], rows.y[i]}, rows.inverse_depth[i]);
    const Eigen::Matrix2d G = information_of(rows, i);
    const Eigen::Vector2d flow(rows.flow_x[i], rows.flow_y[i]);
    out.sums.N += weights[i] * m.transpose() * G * m;
    out.sums.b += weights[i] * m.transpose() * G * flow;
    const Eigen::Vector2d r = flow - m * twist;
    out.squared_distances.push_back(r.dot(G * r));
  }
  return out;
}

std::vector<FlowWindow> varied_windows(const test::FlowScene& scene, std::mt19937& random) {
  std::vector<FlowWindow> windows = scene.flow();
  std::uniform_real_distribution<float> texture(0.2F, 4.0F);
  for (FlowWindow& w : windows) {
    w.information_xx = texture(random);
    w.information_yy = texture(random);
    w.information_xy = 0.5F * std::sqrt(w.information_xx * w.information_yy);
  }
  test::add_noise(windows, 0.5, random);
  return windows;
}

class FlowRowsOnEveryTarget : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { allow(GetParam()); }
  void TearDown() override { allow(0); }

 private:
  static void allow(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST_P(FlowRowsOnEveryTarget, SumsAreTheFormulas) {
  const test::FlowScene scene;
  std::mt19937 random(1);
  const std::vector<FlowWindow> windows = varied_windows(scene, random);
  FlowRowMaker maker(scene.camera);
  const FlowRows& rows = maker.make(windows, scene.ground(), scene.dt_s, true);
  std::vector<double> weights(rows.size());
  std::uniform_real_distribution<double> weight(0, 1);
  for (double& w : weights) w = weight(random);
  const Vector6d twist{1, -2, 0.5, 0.1, 0.2, -0.3};

  const Reference expected = straightforward(rows, twist, weights);
  TwistEquations sums;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    sums += weighted_sums(rows, rows.cell_begin[cell], rows.cell_begin[cell + 1], weights);
  }
  EXPECT_LT((sums.N - expected.sums.N).norm(), 1e-12 * expected.sums.N.norm());
  EXPECT_LT((sums.b - expected.sums.b).norm(), 1e-12 * expected.sums.b.norm());

  std::vector<double> squared_distances(rows.size());
  measure_squared_distances(rows, twist, squared_distances);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_NEAR(squared_distances[i], expected.squared_distances[i],
                1e-12 * (1 + expected.squared_distances[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FlowRowsOnEveryTarget,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& instance) {
                           return std::string(hwy::TargetName(instance.param));
                         });

TEST(FlowRows, MovedWindowsAreLookedUpAgain) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  FlowRowMaker maker(scene.camera);
  static_cast<void>(maker.make(windows, scene.ground(), scene.dt_s, true));
  for (FlowWindow& w : windows) w.pixel += Eigen::Vector2f(3, 5);
  windows.resize(windows.size() / 2);
  const FlowRows moved = maker.make(windows, scene.ground(), scene.dt_s, true);
  FlowRowMaker fresh_maker(scene.camera);
  const FlowRows fresh = fresh_maker.make(windows, scene.ground(), scene.dt_s, true);
  EXPECT_EQ(moved.x, fresh.x);
  EXPECT_EQ(moved.y, fresh.y);
  EXPECT_EQ(moved.flow_x, fresh.flow_x);
  EXPECT_EQ(moved.cell_begin, fresh.cell_begin);
}

TEST(FlowRows, AWindowThatLostItsTextureLeavesNothingBehind) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  FlowRowMaker maker(scene.camera);
  static_cast<void>(maker.make(windows, scene.ground(), scene.dt_s, true));
  for (FlowWindow& w : windows) w.information_xx = w.information_yy = 0;
  const FlowRows& rows = maker.make(windows, scene.ground(), scene.dt_s, true);
  const std::vector<double> weights(rows.size(), 1.0);
  EXPECT_EQ(weighted_sums(rows, 0, rows.size(), weights).N.norm(), 0);
}

}  // namespace
}  // namespace stillkite
