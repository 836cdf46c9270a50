#include "estimation/two_view/rotation_gate.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

Eigen::Quaterniond rotation_deg(double angle_deg) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_deg * kDegree, Eigen::Vector3d::UnitY()));
}

TEST(RotationGate, AcceptsFourthConsecutiveOutlier) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(rotation_deg(0)));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(gate.accepts(rotation_deg(20))) << i;
  EXPECT_TRUE(gate.accepts(rotation_deg(20)));
  EXPECT_TRUE(gate.accepts(rotation_deg(22)));
  EXPECT_FALSE(gate.accepts(rotation_deg(0)));
}

TEST(RotationGate, AcceptedFrameResetsRejectionCount) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(rotation_deg(0)));
  for (int round = 0; round < 3; ++round) {
    EXPECT_FALSE(gate.accepts(rotation_deg(20)));
    EXPECT_FALSE(gate.accepts(rotation_deg(20)));
    EXPECT_TRUE(gate.accepts(rotation_deg(1)));
  }
}

// 179 and -179 deg differ by 2 deg; the hold paper reports the wrap-around as a bug.
TEST(RotationGate, AcceptsSmallRotationAcrossAngleWrap) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(rotation_deg(179)));
  EXPECT_TRUE(gate.accepts(rotation_deg(-179)));
  const Eigen::Quaterniond same = rotation_deg(-179);
  EXPECT_TRUE(gate.accepts(Eigen::Quaterniond(-same.coeffs())));
}

TEST(RotationGate, AcceptsAnyRotationAfterReset) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(rotation_deg(0)));
  EXPECT_FALSE(gate.accepts(rotation_deg(90)));
  gate.reset();
  EXPECT_TRUE(gate.accepts(rotation_deg(90)));
}

}  // namespace
}  // namespace stillkite
