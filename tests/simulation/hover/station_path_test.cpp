#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "simulation/hover/station_path.hpp"

namespace stillkite {
namespace {

struct Displacement {
  double mean_m = 0;       // of |d|
  double deviation_m = 0;  // of signed d
};

// Statistics along the moved axis, uniformly sampled in time.
Displacement displacement_of(const StationPath& path, PaperAxis moved) {
  const Eigen::Vector3d axis = paper_axis_in_world(moved);
  const Eigen::Vector3d start = path.at(0).world_from_station.translation;
  constexpr int kSamples = 20000;
  double sum = 0, sum_of_magnitudes = 0, sum_of_squares = 0;
  for (int k = 0; k < kSamples; ++k) {
    const double t_s = (k + 0.5) / kSamples * path.duration_s();
    const double d = axis.dot(path.at(t_s).world_from_station.translation - start);
    sum += d;
    sum_of_magnitudes += std::abs(d);
    sum_of_squares += d * d;
  }
  const double mean = sum / kSamples;
  return {sum_of_magnitudes / kSamples, std::sqrt(sum_of_squares / kSamples - mean * mean)};
}

// Ramps of 1 s and 0.1 m each: 2 m take 11 s, 4 m take 21 s.
TEST(StationPath, ReachesReversalsAtComputedTimes) {
  const StationPath path({.height_m = 0.7}, PaperAxis::x);
  EXPECT_NEAR(path.duration_s(), 43, 1e-12);
  const auto x_at = [&](double t_s) {
    const StationState state = path.at(t_s);
    EXPECT_EQ(state.world_from_station.translation.y(), 0);
    EXPECT_EQ(state.world_from_station.translation.z(), 0.7);
    return state.world_from_station.translation.x();
  };
  EXPECT_EQ(x_at(-1), 0);
  EXPECT_NEAR(x_at(1), 0.1, 1e-12);
  EXPECT_NEAR(x_at(5.5), 1, 1e-12);
  EXPECT_NEAR(x_at(11), 2, 1e-12);
  EXPECT_NEAR(x_at(21.5), 0, 1e-12);
  EXPECT_NEAR(x_at(32), -2, 1e-12);
  EXPECT_NEAR(x_at(43), 0, 1e-12);
  EXPECT_EQ(x_at(50), 0);
}

TEST(StationPath, RespectsLimitsAndVelocityIsDerivative) {
  for (const PaperAxis axis : {PaperAxis::x, PaperAxis::y, PaperAxis::z}) {
    const StationPath path({.vertical_reach_m = 0.15}, axis);
    constexpr double kStep_s = 1e-3;
    for (double t_s = 0.0105; t_s < path.duration_s() + 1; t_s += 0.013) {
      const StationState before = path.at(t_s - kStep_s);
      const StationState after = path.at(t_s + kStep_s);
      const Eigen::Vector3d velocity = path.at(t_s).velocity_in_world_m_s;
      const Eigen::Vector3d by_difference =
          (after.world_from_station.translation - before.world_from_station.translation) /
          (2 * kStep_s);
      const Eigen::Vector3d acceleration =
          (after.velocity_in_world_m_s - before.velocity_in_world_m_s) / (2 * kStep_s);
      ASSERT_LT((velocity - by_difference).norm(), 2.1e-4);  // half a step of acceleration
      ASSERT_LE(velocity.norm(), 0.2 + 1e-9);
      ASSERT_LE(acceleration.norm(), 0.2 + 1e-9);
    }
  }
}

TEST(StationPath, HeadsAlongHorizontalAxis) {
  for (const PaperAxis axis : {PaperAxis::x, PaperAxis::z}) {
    const StationState station = StationPath({}, axis).at(3);
    const Eigen::Vector3d ahead = station.world_from_station.rotation * Eigen::Vector3d::UnitX();
    EXPECT_LT((ahead - paper_axis_in_world(axis)).norm(), 1e-12);
    EXPECT_NEAR(station.velocity_in_world_m_s.dot(ahead), 0.2, 1e-12);
  }
  EXPECT_LT((paper_axis_in_world(PaperAxis::x).cross(paper_axis_in_world(PaperAxis::y)) -
             paper_axis_in_world(PaperAxis::z))
                .norm(),
            1e-12);
}

// Hold paper, Table I, without stabilization: the drone follows its station. Tolerance 10 %.
TEST(StationPath, MatchesPaperStatisticsWithoutStabilization) {
  struct OffColumn {
    PaperAxis axis;
    double mean_m;
    double deviation_m;
  };
  double weighted_mean = 0, weighted_square = 0, duration_s = 0;
  for (const OffColumn& paper :
       {OffColumn{PaperAxis::x, 1.06, 1.22}, OffColumn{PaperAxis::y, 0.43, 0.52},
        OffColumn{PaperAxis::z, 1.08, 1.19}}) {
    const StationPath path({}, paper.axis);
    const Displacement ours = displacement_of(path, paper.axis);
    EXPECT_NEAR(ours.mean_m, paper.mean_m, 0.1 * paper.mean_m);
    EXPECT_NEAR(ours.deviation_m, paper.deviation_m, 0.1 * paper.deviation_m);
    const std::string axis(name_of(paper.axis));
    RecordProperty(axis + "_mean_m", std::to_string(ours.mean_m));
    RecordProperty(axis + "_std_m", std::to_string(ours.deviation_m));
    weighted_mean += ours.mean_m * path.duration_s();
    weighted_square += ours.deviation_m * ours.deviation_m * path.duration_s();
    duration_s += path.duration_s();
  }
  EXPECT_NEAR(weighted_mean / duration_s, 0.98, 0.098);
  EXPECT_NEAR(std::sqrt(weighted_square / duration_s), 1.18, 0.118);
  RecordProperty("all_mean_m", std::to_string(weighted_mean / duration_s));
  RecordProperty("all_std_m", std::to_string(std::sqrt(weighted_square / duration_s)));
}

// Triangle wave of amplitude 2 m: mean |d| 1 m, standard deviation 2 / sqrt(3) m.
TEST(StationPath, IsTriangleWaveAtInfiniteAcceleration) {
  const Displacement ours =
      displacement_of(StationPath({.acceleration_m_s2 = 1e6}, PaperAxis::x), PaperAxis::x);
  EXPECT_NEAR(ours.mean_m, 1, 1e-4);
  EXPECT_NEAR(ours.deviation_m, 2 / std::sqrt(3), 1e-4);
}

}  // namespace
}  // namespace stillkite
