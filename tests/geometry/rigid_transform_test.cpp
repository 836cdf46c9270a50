#include "geometry/rigid_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/geometry/random_values.hpp"

namespace stillkite {
namespace {

using std::numbers::pi;

RigidTransform random_transform(std::mt19937& random) {
  return {random_rotation(random), random_vector(random, 10.0)};
}

TEST(RigidTransform, TranslationIsOriginOfAInB) {
  const RigidTransform b_from_a{
      Eigen::Quaterniond(Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitZ())), {1, 2, 3}};
  EXPECT_TRUE((b_from_a * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-15));
  EXPECT_EQ(b_from_a * Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3));
}

TEST(RigidTransform, CompositionAndInverseFormGroup) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const RigidTransform c_from_b = random_transform(random);
    const RigidTransform b_from_a = random_transform(random);
    const Eigen::Vector3d x = random_vector(random, 5.0);
    EXPECT_TRUE((c_from_b * b_from_a * x).isApprox(c_from_b * (b_from_a * x), 1e-13));
    EXPECT_TRUE((b_from_a.inverse() * (b_from_a * x)).isApprox(x, 1e-12));
    EXPECT_TRUE((b_from_a.inverse() * b_from_a).translation.isZero(1e-13));
  }
}

TEST(RigidTransform, LongProductKeepsUnitQuaternion) {
  const RigidTransform step{so3_exp({0.1, -0.2, 0.3}), Eigen::Vector3d::Zero()};
  RigidTransform pose;
  for (int i = 0; i < 100'000; ++i) pose = pose * step;
  EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-14);
}

TEST(Skew, MatchesCrossProduct) {
  const Eigen::Vector3d a(1, -2, 3);
  const Eigen::Vector3d b(0.5, 4, -1);
  EXPECT_EQ(skew(a) * b, a.cross(b));
}

TEST(So3, ExpMatchesAngleAxis) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3.0;
  for (const double angle : {0.0, 1e-12, 1e-7, 1e-6, 1e-3, 1.0, 3.0, pi, 5.0}) {
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, axis));
    EXPECT_TRUE(so3_exp(angle * axis).isApprox(expected, 1e-15)) << angle;
  }
}

TEST(So3, LogInvertsExpUpToPi) {
  std::mt19937 random(3);
  for (const double angle : {0.0, 1e-15, 1e-10, 2e-9, 1e-6, 1e-3, 0.5, 1.0, 2.0, 3.0, pi - 1e-3,
                             pi - 1e-6, pi - 1e-9, pi - 1e-12}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d w = angle * random_vector(random, 1.0).normalized();
      EXPECT_NEAR((so3_log(so3_exp(w)) - w).norm(), 0.0, 4e-15 * std::max(1.0, angle)) << angle;
    }
  }
}

TEST(So3, LogIsAccurateForSmallAngles) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3.0;
  for (const double angle : {1e-15, 1e-12, 1e-9, 3e-9, 1e-6}) {
    EXPECT_TRUE(so3_log(so3_exp(angle * axis)).isApprox(angle * axis, 1e-14)) << angle;
  }
}

TEST(So3, LogReturnsShortestRotationForBothSigns) {
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond q = random_rotation(random);
    const Eigen::Quaterniond negative(-q.coeffs());
    EXPECT_LE(so3_log(q).norm(), pi);
    EXPECT_TRUE(so3_log(q).isApprox(so3_log(negative), 1e-15));
  }
  // 4 rad is equivalent to 4 - 2 pi
  EXPECT_TRUE(so3_log(so3_exp({0, 0, 4.0})).isApprox(Eigen::Vector3d(0, 0, 4.0 - 2 * pi), 1e-15));
}

TEST(So3, LeftJacobianMatchesNumericDerivative) {
  std::mt19937 random(5);
  constexpr double kStep = 1e-6;
  for (const double angle : {0.0, 1e-7, 9e-6, 1.1e-5, 1e-4, 1e-2, 0.7, 2.0, 3.1}) {
    const Eigen::Vector3d w = angle * random_vector(random, 1.0).normalized();
    const Eigen::Matrix3d J = so3_left_jacobian(w);
    Eigen::Matrix3d numeric;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
      numeric.col(axis) = so3_log(so3_exp(w + d) * so3_exp(w - d).conjugate()) / (2 * kStep);
    }
    EXPECT_LT((J - numeric).norm(), 1e-9) << angle;
  }
}

TEST(So3, AngleBetweenIgnoresOrderAndSign) {
  const Eigen::Quaterniond a = so3_exp({0.3, -0.1, 0.2});
  const Eigen::Quaterniond b = a * so3_exp({0, 1.25, 0});
  EXPECT_NEAR(angle_between_rad(a, b), 1.25, 1e-15);
  EXPECT_NEAR(angle_between_rad(b, a), 1.25, 1e-15);
  EXPECT_NEAR(angle_between_rad(a, Eigen::Quaterniond(-b.coeffs())), 1.25, 1e-15);
  EXPECT_EQ(angle_between_rad(a, a), 0.0);
}

TEST(Interpolate, IsLinearInTranslationAndAngle) {
  const RigidTransform a{so3_exp({0, 0, 0.2}), {1, 0, -1}};
  const RigidTransform b{so3_exp({0, 0, 1.0}), {3, 4, -1}};
  const RigidTransform quarter = interpolate(a, b, 0.25);
  EXPECT_TRUE(quarter.translation.isApprox(Eigen::Vector3d(1.5, 1, -1), 1e-15));
  EXPECT_TRUE(so3_log(quarter.rotation).isApprox(Eigen::Vector3d(0, 0, 0.4), 1e-14));
  EXPECT_NEAR(angle_between_rad(interpolate(a, b, 0).rotation, a.rotation), 0.0, 1e-15);
  EXPECT_NEAR(angle_between_rad(interpolate(a, b, 1).rotation, b.rotation), 0.0, 1e-15);
}

TEST(RotationBetween, MapsOneDirectionToTheOtherByTheSmallestAngle) {
  const Eigen::Vector3d a(1, 2, -3);
  const Eigen::Vector3d b(0.5, -1, 4);
  const Eigen::Quaterniond rotation = rotation_between(a, b);
  EXPECT_LT((rotation * a.normalized() - b.normalized()).norm(), 1e-15);
  EXPECT_NEAR(so3_log(rotation).norm(), angle_between_rad(a, b), 1e-15);
  EXPECT_LT((rotation.coeffs() - Eigen::Quaterniond::FromTwoVectors(a, b).coeffs()).norm(), 1e-15);
}

TEST(RotationBetween, RotatesByHalfATurnBetweenOppositeDirections) {
  const Eigen::Vector3d a(1, 2, -3);
  EXPECT_LT((rotation_between(a, -2 * a) * a + a).norm(), 1e-12);
}

}  // namespace
}  // namespace stillkite
