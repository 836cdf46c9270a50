#include "flow/local_deformation.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

// Points 10 px apart: those right of the middle grow by a tenth, the others do not.
TEST(LocalDeformation, IsThatOfTheSurfaceAPointLiesOn) {
  std::vector<Eigen::Vector2f> points, displacements;
  const Eigen::Vector2f about(140, 50);
  for (int y = 0; y < 100; y += 10) {
    for (int x = 0; x < 200; x += 10) {
      points.emplace_back(x, y);
      displacements.emplace_back(x < 100 ? Eigen::Vector2f(0, 0)
                                         : (0.1F * (points.back() - about)).eval());
    }
  }
  const std::vector<unsigned char> used(points.size(), 1);
  LocalDeformation deformation;
  deformation.set_points(points);
  AffineFlow whole;
  whole.gradient = 0.05F * Eigen::Matrix2f::Identity();
  const auto& gradients = deformation.fit(displacements, used, whole);
  ASSERT_EQ(gradients.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points[i].x() - 95) < 30) continue;
    const float growth = points[i].x() < 100 ? 0 : 0.1F;
    EXPECT_LT((gradients[i] - growth * Eigen::Matrix2f::Identity()).norm(), 0.015F)
        << points[i].transpose();
  }
}

TEST(LocalDeformation, WithoutNeighboursItIsTheWholes) {
  AffineFlow whole;
  whole.gradient << 0.1F, 0.02F, -0.03F, 0.05F;
  const std::vector<Eigen::Vector2f> far_apart{{0, 0}, {300, 0}, {0, 300}};
  LocalDeformation deformation;
  deformation.set_points(far_apart);
  const std::vector<Eigen::Vector2f> displacements(3, {1, 2});
  for (const bool is_used : {false, true}) {
    for (const Eigen::Matrix2f& gradient :
         deformation.fit(displacements, std::vector<unsigned char>(3, is_used ? 1 : 0), whole)) {
      EXPECT_EQ(gradient, whole.gradient);
    }
  }
  deformation.set_points({});
  EXPECT_TRUE(deformation.fit({}, {}, whole).empty());
}

}  // namespace
}  // namespace stillkite
