#include "estimation/sliding_window/epipolar_rotation.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

constexpr double kSigma = 5e-4;

std::vector<BearingMatch> matches_of(const RigidTransform& first_from_second, unsigned seed,
                                     int count = 100) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, kSigma);
  std::uniform_real_distribution<double> image(-0.5, 0.5), depth_m(2, 8);
  std::vector<BearingMatch> matches;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d at = depth_m(random) * Eigen::Vector3d(image(random), image(random), 1);
    const Eigen::Vector3d from = first_from_second * at;
    const auto seen = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
      return {x.x() / x.z() + noise(random), x.y() / x.z() + noise(random), 1};
    };
    matches.push_back({seen(from), seen(at), kSigma * kSigma});
  }
  return matches;
}

class EpipolarRotationTo : public testing::TestWithParam<Eigen::Vector3d> {};

TEST_P(EpipolarRotationTo, IsFoundForAnyTranslation) {
  const Eigen::Quaterniond rotation = so3_exp({0.03, -0.05, 0.08});
  std::vector<BearingMatch> matches = matches_of({rotation, GetParam()}, 1);
  for (int i = 0; i < 8; ++i) matches[i].first += Eigen::Vector3d(0.005, 0.003 * i - 0.01, 0);
  const auto found = epipolar_rotation(matches, Eigen::Quaterniond::Identity());
  ASSERT_TRUE(found);
  EXPECT_LT(angle_between_rad(*found, rotation), 2e-3);
}
INSTANTIATE_TEST_SUITE_P(Each, EpipolarRotationTo,
                         testing::Values(Eigen::Vector3d(0.2, 0, 0),
                                         Eigen::Vector3d(0.05, 0.1, 0.2),
                                         Eigen::Vector3d(0, 0, 0)));

TEST(EpipolarRotation, NeedsTwelveMatches) {
  const auto matches = matches_of({so3_exp({0.01, 0, 0}), {0.1, 0, 0}}, 2, 11);
  EXPECT_FALSE(epipolar_rotation(matches, Eigen::Quaterniond::Identity()));
}

}  // namespace
}  // namespace stillkite
