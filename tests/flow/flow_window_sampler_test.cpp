#include "flow/flow_window_sampler.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

// A flow that tells its own place.
cv::Mat2f numbered(int rows, int columns) {
  cv::Mat2f flow(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      flow(row, column) = {static_cast<float>(column), static_cast<float>(row)};
    }
  }
  return flow;
}

TEST(flow_window_sampler, takes_the_vector_of_the_pixel_it_names) {
  FlowWindowSampler sampler(8);
  const std::vector<FlowWindow>& windows = sampler({.flow_px = numbered(48, 64)});
  ASSERT_EQ(windows.size(), 6U * 8U);
  EXPECT_EQ(windows.front().pixel, Eigen::Vector2f(4, 4));
  EXPECT_EQ(windows.back().pixel, Eigen::Vector2f(60, 44));
  for (const FlowWindow& w : windows) {
    EXPECT_EQ(w.flow_px, w.pixel);
    EXPECT_EQ(w.information_xx, 1);
    EXPECT_EQ(w.information_xy, 0);
    EXPECT_EQ(w.information_yy, 1);
  }
}

TEST(flow_window_sampler, keeps_the_fields_own_stride_and_information) {
  cv::Mat1f information(6, 8, 3.0F);
  information(2, 5) = 0;
  FlowWindowSampler sampler(4);
  const std::vector<FlowWindow>& windows =
      sampler({.flow_px = numbered(6, 8), .information = information, .stride_px = 8});
  ASSERT_EQ(windows.size(), 6U * 8U);
  const FlowWindow& bare = windows[2 * 8 + 5];
  EXPECT_EQ(bare.pixel, Eigen::Vector2f(5 * 8 + 4, 2 * 8 + 4));
  EXPECT_EQ(bare.information_xx, 0);
  EXPECT_EQ(windows[0].information_yy, 3);
}

}  // namespace
}  // namespace stillkite
