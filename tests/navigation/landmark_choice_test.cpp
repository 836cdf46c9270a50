#include "navigation/landmark_choice.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

// Of one feature that is told to be good to a thousandth.
double told_variance(int landmarks, double unit_variance, const Eigen::Vector2d& at = {0.1, 0.2}) {
  FusionConfig config;
  config.landmarks = landmarks;
  LandmarkChoice choice(config, 500);
  for (int i = 0; i < 1000; ++i) choice.weigh(unit_variance);
  const FeatureBearings bearings{.pairs = {{.reference = at, .current = at}},
                                 .feature_of_pair = {0},
                                 .covariance = {1e-6 * Eigen::Matrix2d::Identity()}};
  return choice.views(bearings, {1}).front().covariance(0, 0);
}

// One frame of a false pose says nothing of others, but of itself; one of none says nothing.
TEST(LandmarkChoice, AFrameThatIsOffByFarIsToldSo) {
  LandmarkChoice choice({}, 500);
  for (int i = 0; i < 1000; ++i) choice.weigh(1);
  choice.weigh(300);
  EXPECT_EQ(choice.unit_variance(), 300);
  choice.weigh({});
  EXPECT_NEAR(choice.unit_variance(), 1.1, 0.02);
  choice.weigh(2);
  EXPECT_NEAR(choice.unit_variance(), 1.1, 0.02);
}

// What a lens is off by is alike in neighbours, and no noise that many of them average.
TEST(LandmarkChoice, MoreLandmarksTellNoMoreThroughALensThatIsNotAsTold) {
  EXPECT_DOUBLE_EQ(told_variance(96, 2), told_variance(48, 2));
  const double as_noise = told_variance(48, 12) / told_variance(48, 2);
  EXPECT_NEAR(as_noise, 6, 0.3);
  EXPECT_GT(told_variance(96, 12), 1.5 * told_variance(48, 12));
  EXPECT_LE(told_variance(96, 12), 2 * told_variance(48, 12));
}

TEST(LandmarkChoice, ALensThatIsNotAsToldErrsOutwards) {
  const Eigen::Vector2d middle(0, 0), edge(1, 0.5);
  EXPECT_DOUBLE_EQ(told_variance(96, 10, edge), told_variance(96, 10, middle)) << "coding";
  EXPECT_GT(told_variance(96, 30, edge), 10 * told_variance(96, 30, middle));
}

}  // namespace
}  // namespace stillkite
