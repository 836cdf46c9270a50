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

NavigationEstimate at(double t_s, double yaw_rad) {
  NavigationEstimate estimate{.stamp = from_seconds(t_s), .verdict = Verdict::ok};
  estimate.world_from_body.rotation = so3_exp({0, 0, yaw_rad});
  return estimate;
}

TEST(ReportSeries, UnwrapsAngles) {
  std::vector<NavigationEstimate> estimates;
  std::vector<std::optional<RigidTransform>> truth;
  for (int i = 0; i <= 40; ++i) {
    estimates.push_back(at(i, 0.5 * i));
    truth.emplace_back(RigidTransform{.rotation = so3_exp({0, 0, 0.5 * i - 0.01})});
  }
  const ReportSeries series = report_series({.estimates = estimates, .truth = truth});
  EXPECT_NEAR(series.at("yaw_deg").back(), 20 * 180 / M_PI, 1e-2);
  EXPECT_NEAR(series.at("yaw_true_deg").back(), 19.99 * 180 / M_PI, 1e-2);
  EXPECT_NEAR(series.at("attitude_error_z_deg").back(), 0.01 * 180 / M_PI, 1e-4);
}

TEST(ReportSeries, DifferentiatesTruthPositionsAndKeepsGaps) {
  std::vector<NavigationEstimate> estimates{at(0, 0), at(0.5, 0), at(1, 0)};
  const std::vector<std::optional<RigidTransform>> truth{
      RigidTransform{}, RigidTransform{.translation = {2, 0, 1}}, std::nullopt};
  const ReportSeries in_heights = report_series({.estimates = estimates, .truth = truth});
  EXPECT_TRUE(std::isnan(in_heights.at("position_error_x_m")[1]))
      << "no metric error of lengths in heights";
  EXPECT_FALSE(std::isnan(in_heights.at("attitude_error_x_deg")[1]));
  for (NavigationEstimate& estimate : estimates) estimate.scale = ScaleSource::initial_height;
  const ReportSeries series = report_series({.estimates = estimates, .truth = truth});
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
  const ReportSeries series = report_series(
      {.estimates = estimates, .body_from_camera = {.rotation = Eigen::Quaterniond(0, 1, 0, 0)}});
  EXPECT_NEAR(series.at("velocity_sigma_x_m_s")[0], 2, 1e-6);
  EXPECT_NEAR(series.at("velocity_sigma_z_m_s")[0], 0.1, 1e-6);
}

TEST(VerdictIntervals, MergeEqualNeighbours) {
  std::vector<NavigationEstimate> estimates{at(10, 0), at(11, 0), at(12, 0), at(13, 0)};
  estimates[2].verdict = Verdict::frozen;
  const auto intervals = verdict_intervals(estimates);
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
