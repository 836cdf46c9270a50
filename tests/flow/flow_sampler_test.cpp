#include "flow/flow_sampler.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

// Flow equal to the pixel coordinates.
cv::Mat2f coordinate_flow(int rows, int columns) {
  cv::Mat2f flow(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      flow(row, column) = {static_cast<float>(column), static_cast<float>(row)};
    }
  }
  return flow;
}

TEST(FlowSampler, SamplesVectorAtReportedPixel) {
  FlowSampler sampler(8);
  const std::vector<FlowVector>& vectors = sampler({.flow_px = coordinate_flow(48, 64)});
  ASSERT_EQ(vectors.size(), 6U * 8U);
  EXPECT_EQ(vectors.front().pixel, Eigen::Vector2f(4, 4));
  EXPECT_EQ(vectors.back().pixel, Eigen::Vector2f(60, 44));
  for (const FlowVector& v : vectors) {
    EXPECT_EQ(v.flow_px, v.pixel);
    EXPECT_EQ(v.information_xx, 1);
    EXPECT_EQ(v.information_xy, 0);
    EXPECT_EQ(v.information_yy, 1);
  }
}

TEST(FlowSampler, KeepsStrideAndInformationOfField) {
  cv::Mat1f information(6, 8, 3.0F);
  information(2, 5) = 0;
  FlowSampler sampler(4);
  const std::vector<FlowVector>& vectors =
      sampler({.flow_px = coordinate_flow(6, 8), .information = information, .stride_px = 8});
  ASSERT_EQ(vectors.size(), 6U * 8U);
  const FlowVector& textureless = vectors[2 * 8 + 5];
  EXPECT_EQ(textureless.pixel, Eigen::Vector2f(5 * 8 + 4, 2 * 8 + 4));
  EXPECT_EQ(textureless.information_xx, 0);
  EXPECT_EQ(vectors[0].information_yy, 3);
}

}  // namespace
}  // namespace stillkite
