#include "io/report/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/report/base64.hpp"
#include "io/report/decimation.hpp"
#include "io/report/report_series.hpp"
#include "tests/browser/synthetic_flight.hpp"

namespace stillkite {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::string encoded(std::string_view text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Base64, MatchesTestVectorsOfRfc4648) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, EncodesFloatsLittleEndian) {
  const std::vector<float> one{1.0F};  // 0x3f800000
  EXPECT_EQ(base64(one), "AACAPw==");
}

TEST(KeepExtremes, ReturnsShortSeriesUnchanged) {
  const std::vector<float> values{3, 1, 2};
  EXPECT_EQ(keep_extremes(values, 4), values);
}

TEST(KeepExtremes, KeepsSpikesInOrder) {
  std::vector<float> values(1000, 0.0F);
  values[501] = 9;
  values[505] = -4;
  const std::vector<float> kept = keep_extremes(values, 20);
  ASSERT_EQ(kept.size(), 20U);
  EXPECT_EQ(kept[10], 9);
  EXPECT_EQ(kept[11], -4);
}

TEST(KeepExtremes, IgnoresNaN) {
  const std::vector<float> values{kNaN, kNaN, kNaN, 5, kNaN, 4, 1, 2};
  const std::vector<float> kept = keep_extremes(values, 4);
  ASSERT_EQ(kept.size(), 4U);
  EXPECT_EQ(kept[0], 5);
  EXPECT_EQ(kept[1], 5);
  EXPECT_EQ(kept[2], 4);
  EXPECT_EQ(kept[3], 1);
  EXPECT_TRUE(std::isnan(keep_extremes(std::vector<float>(9, kNaN), 2)[0]));
}

TEST(KeepEveryNth, KeepsFirstAndLast) {
  std::vector<float> values(101);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  EXPECT_EQ(keep_every_nth(values, 5), (std::vector<float>{0, 25, 50, 75, 100}));
}

DecimatedTable table_of(const std::vector<float>& values, std::size_t max_blocks) {
  DecimatedTable table(max_blocks);
  for (const float value : values) {
    table.add({"v", "alue"}, value);
    table.end_frame();
  }
  return table;
}

TEST(DecimatedTable, KeepsAllValuesUpToItsSize) {
  const std::vector<float> values{3, 1, kNaN, 2};
  const auto kept = table_of(values, 4).extremes().at("value");
  ASSERT_EQ(kept.size(), 4U);
  EXPECT_EQ(kept[1], 1);
  EXPECT_TRUE(std::isnan(kept[2]));
  EXPECT_EQ(table_of(values, 4).samples().at("value").size(), 4U);
}

// 1000 frames in at most 64 blocks: blocks of 16 frames, 62 full ones and one of 8 frames.
TEST(DecimatedTable, KeepsSpikesInOrderInBoundedMemory) {
  std::vector<float> values(1000, 0.0F);
  values[500] = 9;
  values[505] = -4;
  values[999] = 7;
  const DecimatedTable table = table_of(values, 64);
  EXPECT_EQ(table.frames(), 1000U);
  const auto kept = table.extremes().at("value");
  ASSERT_EQ(kept.size(), 2 * 63U);
  EXPECT_EQ(kept[62], 9) << "frame 500 in block 31";
  EXPECT_EQ(kept[63], -4);
  EXPECT_EQ(kept[125], 7);
  const auto samples = table.samples().at("value");
  ASSERT_EQ(samples.size(), 64U);
  EXPECT_EQ(samples.back(), 7) << "last frame";
}

TEST(DecimatedTable, OrdersExtremesOfRisingAndFallingValues) {
  std::vector<float> values;
  for (int i = 0; i < 64; ++i) values.push_back(static_cast<float>(i < 32 ? i : 63 - i));
  EXPECT_EQ(table_of(values, 4).extremes().at("value"),
            (std::vector<float>{0, 15, 16, 31, 31, 16, 15, 0}));
}

TEST(DecimatedTable, IgnoresNaN) {
  const std::vector<float> values{kNaN, kNaN, kNaN, 5, 4, kNaN, 2, 3};
  const auto kept = table_of(values, 2).extremes().at("value");
  EXPECT_EQ(kept, (std::vector<float>{5, 5, 4, 2}));
  EXPECT_TRUE(std::isnan(table_of(std::vector<float>(9, kNaN), 2).extremes().at("value")[0]));
}

NavigationEstimate at(double t_s, double yaw_rad) {
  NavigationEstimate estimate{.stamp = from_seconds(t_s), .verdict = Verdict::ok};
  estimate.world_from_body.rotation = so3_exp({0, 0, yaw_rad});
  return estimate;
}

ReportSeries report_series(const std::vector<NavigationEstimate>& estimates,
                           const std::vector<std::optional<RigidTransform>>& truth,
                           const RigidTransform& body_from_camera = {}) {
  return recorded_charts(estimates, truth, body_from_camera).columns;
}

TEST(ReportSeries, UnwrapsAngles) {
  std::vector<NavigationEstimate> estimates;
  std::vector<std::optional<RigidTransform>> truth;
  for (int i = 0; i <= 40; ++i) {
    estimates.push_back(at(i, 0.5 * i));
    truth.emplace_back(RigidTransform{.rotation = so3_exp({0, 0, 0.5 * i - 0.01})});
  }
  const ReportSeries series = report_series(estimates, truth);
  EXPECT_NEAR(series.at("yaw_deg").back(), 20 * 180 / M_PI, 1e-2);
  EXPECT_NEAR(series.at("yaw_true_deg").back(), 19.99 * 180 / M_PI, 1e-2);
  EXPECT_NEAR(series.at("attitude_error_z_deg").back(), 0.01 * 180 / M_PI, 1e-4);
}

TEST(ReportSeries, DifferentiatesTruthPositionsAndKeepsGaps) {
  std::vector<NavigationEstimate> estimates{at(0, 0), at(0.5, 0), at(1, 0)};
  const std::vector<std::optional<RigidTransform>> truth{
      RigidTransform{}, RigidTransform{.translation = {2, 0, 1}}, std::nullopt};
  const ReportSeries in_heights = report_series(estimates, truth);
  EXPECT_TRUE(std::isnan(in_heights.at("position_error_x_m")[1]))
      << "no metric error of lengths in heights";
  EXPECT_FALSE(std::isnan(in_heights.at("attitude_error_x_deg")[1]));
  for (NavigationEstimate& estimate : estimates) estimate.scale = ScaleSource::initial_height;
  const ReportSeries series = report_series(estimates, truth);
  EXPECT_TRUE(std::isnan(series.at("velocity_true_x_m_s")[0]));
  EXPECT_FLOAT_EQ(series.at("velocity_true_x_m_s")[1], 4);
  EXPECT_FLOAT_EQ(series.at("velocity_true_z_m_s")[1], 2);
  EXPECT_TRUE(std::isnan(series.at("velocity_true_x_m_s")[2]));
  EXPECT_FLOAT_EQ(series.at("position_error_x_m")[1], -2);
  EXPECT_TRUE(std::isnan(series.at("position_error_x_m")[2]));
}

// Velocity sigma 0.1 m/s along the camera's z axis, the world's -z.
TEST(ReportSeries, RotatesVelocityCovarianceToTheWorld) {
  std::vector<NavigationEstimate> estimates{at(0, 0.7)};
  estimates[0].twist_covariance.diagonal() << 4, 4, 0.01, 0, 0, 0;
  const ReportSeries series =
      report_series(estimates, {}, {.rotation = Eigen::Quaterniond(0, 1, 0, 0)});
  EXPECT_NEAR(series.at("velocity_sigma_x_m_s")[0], 2, 1e-6);
  EXPECT_NEAR(series.at("velocity_sigma_z_m_s")[0], 0.1, 1e-6);
}

TEST(VerdictIntervals, MergeEqualNeighbours) {
  std::vector<NavigationEstimate> estimates{at(10, 0), at(11, 0), at(12, 0), at(13, 0)};
  estimates[2].verdict = Verdict::frozen;
  const auto intervals = recorded_charts(estimates, {}).verdicts;
  ASSERT_EQ(intervals.size(), 3U);
  EXPECT_EQ(intervals[0].end_s, 2);
  EXPECT_EQ(intervals[1].verdict, Verdict::frozen);
  EXPECT_EQ(intervals[1].start_s, 2);
  EXPECT_EQ(intervals[1].end_s, 3);
}

TEST(Report, IsSmall) {
  const SyntheticFlight flight = synthetic_flight(3750);
  EXPECT_LT(report_html(flight.content("flight", true), synthetic_summary(flight)).size(),
            1'500'000U);
  const SyntheticFlight long_flight = synthetic_flight(20000);
  EXPECT_LT(report_html(long_flight.content("long", true), synthetic_summary(long_flight)).size(),
            1'500'000U);
}

TEST(Report, IsSelfContained) {
  const SyntheticFlight flight = synthetic_flight(10);
  const std::string html = report_html(flight.content("flight", true), synthetic_summary(flight));
  EXPECT_EQ(html.find("<script src"), std::string::npos);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
}

}  // namespace
}  // namespace stillkite
