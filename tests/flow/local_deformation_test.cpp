#include "flow/local_deformation.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

// Grid of 10 px: scale change of 10 % in the right half, none in the left half.
TEST(LocalDeformation, EstimatesGradientOfOwnSurface) {
  std::vector<Eigen::Vector2f> points, displacements;
  const Eigen::Vector2f origin(140, 50);
  for (int y = 0; y < 100; y += 10) {
    for (int x = 0; x < 200; x += 10) {
      points.emplace_back(x, y);
      displacements.emplace_back(x < 100 ? Eigen::Vector2f(0, 0)
                                         : (0.1F * (points.back() - origin)).eval());
    }
  }
  const std::vector<unsigned char> used(points.size(), 1);
  LocalDeformation deformation;
  deformation.set_points(points);
  AffineFlow global;
  global.gradient = 0.05F * Eigen::Matrix2f::Identity();
  const auto& gradients = deformation.fit(displacements, used, global);
  ASSERT_EQ(gradients.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points[i].x() - 95) < 30) continue;
    const float scale_change = points[i].x() < 100 ? 0 : 0.1F;
    EXPECT_LT((gradients[i] - scale_change * Eigen::Matrix2f::Identity()).norm(), 0.015F)
        << points[i].transpose();
  }
}

TEST(LocalDeformation, ReturnsGlobalGradientWithoutNeighbours) {
  AffineFlow global;
  global.gradient << 0.1F, 0.02F, -0.03F, 0.05F;
  const std::vector<Eigen::Vector2f> far_apart{{0, 0}, {300, 0}, {0, 300}};
  LocalDeformation deformation;
  deformation.set_points(far_apart);
  const std::vector<Eigen::Vector2f> displacements(3, {1, 2});
  for (const bool is_used : {false, true}) {
    for (const Eigen::Matrix2f& gradient :
         deformation.fit(displacements, std::vector<unsigned char>(3, is_used ? 1 : 0), global)) {
      EXPECT_EQ(gradient, global.gradient);
    }
  }
  deformation.set_points({});
  EXPECT_TRUE(deformation.fit({}, {}, global).empty());
}

}  // namespace
}  // namespace stillkite
