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

struct Expected {
  TwistEquations sums;
  std::vector<double> squared_distances;
};

Eigen::Matrix2d information_of(const FlowRows& rows, std::size_t i) {
  Eigen::Matrix2d G;
  G << rows.gxx[i], rows.gxy[i], rows.gxy[i], rows.gyy[i];
  return G;
}

// Sums by their definition.
Expected direct_sums(const FlowRows& rows, const Vector6d& twist,
                     const std::vector<double>& weights) {
  Expected out;
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

std::vector<FlowVector> random_vectors(const test::FlowScene& scene, std::mt19937& random) {
  std::vector<FlowVector> vectors = scene.flow();
  std::uniform_real_distribution<float> texture(0.2F, 4.0F);
  for (FlowVector& v : vectors) {
    v.information_xx = texture(random);
    v.information_yy = texture(random);
    v.information_xy = 0.5F * std::sqrt(v.information_xx * v.information_yy);
  }
  test::add_noise(vectors, 0.5, random);
  return vectors;
}

class FlowRowsSimd : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { restrict_to(GetParam()); }
  void TearDown() override { restrict_to(0); }

 private:
  static void restrict_to(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST_P(FlowRowsSimd, SumsMatchDefinition) {
  const test::FlowScene scene;
  std::mt19937 random(1);
  const std::vector<FlowVector> vectors = random_vectors(scene, random);
  FlowRowMaker maker(scene.camera);
  const FlowRows& rows = maker.make(vectors, scene.ground(), scene.dt_s, true);
  std::vector<double> weights(rows.size());
  std::uniform_real_distribution<double> weight(0, 1);
  for (double& v : weights) v = weight(random);
  const Vector6d twist{1, -2, 0.5, 0.1, 0.2, -0.3};

  const Expected expected = direct_sums(rows, twist, weights);
  TwistEquations sums;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    sums += weighted_sums(rows, rows.cell_begin[cell], rows.cell_begin[cell + 1], weights);
  }
  EXPECT_LT((sums.N - expected.sums.N).norm(), 1e-12 * expected.sums.N.norm());
  EXPECT_LT((sums.b - expected.sums.b).norm(), 1e-12 * expected.sums.b.norm());

  std::vector<double> squared_distances(rows.size());
  compute_squared_distances(rows, twist, squared_distances);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_NEAR(squared_distances[i], expected.squared_distances[i],
                1e-12 * (1 + expected.squared_distances[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FlowRowsSimd,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& instance) {
                           return std::string(hwy::TargetName(instance.param));
                         });

TEST(FlowRows, MovedVectorsUpdateCachedRays) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  FlowRowMaker maker(scene.camera);
  static_cast<void>(maker.make(vectors, scene.ground(), scene.dt_s, true));
  for (FlowVector& v : vectors) v.pixel += Eigen::Vector2f(3, 5);
  vectors.resize(vectors.size() / 2);
  const FlowRows moved = maker.make(vectors, scene.ground(), scene.dt_s, true);
  FlowRowMaker fresh_maker(scene.camera);
  const FlowRows fresh = fresh_maker.make(vectors, scene.ground(), scene.dt_s, true);
  EXPECT_EQ(moved.x, fresh.x);
  EXPECT_EQ(moved.y, fresh.y);
  EXPECT_EQ(moved.flow_x, fresh.flow_x);
  EXPECT_EQ(moved.cell_begin, fresh.cell_begin);
}

TEST(FlowRows, TexturelessVectorClearsItsRow) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  FlowRowMaker maker(scene.camera);
  static_cast<void>(maker.make(vectors, scene.ground(), scene.dt_s, true));
  for (FlowVector& v : vectors) v.information_xx = v.information_yy = 0;
  const FlowRows& rows = maker.make(vectors, scene.ground(), scene.dt_s, true);
  const std::vector<double> weights(rows.size(), 1.0);
  EXPECT_EQ(weighted_sums(rows, 0, rows.size(), weights).N.norm(), 0);
}

}  // namespace
}  // namespace stillkite
