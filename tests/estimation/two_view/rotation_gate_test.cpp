#include "estimation/two_view/rotation_gate.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

Eigen::Quaterniond turned_deg(double angle_deg) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_deg * kDegree, Eigen::Vector3d::UnitY()));
}

TEST(RotationGate, AcceptsTheFourthOutlierAsTheNewValue) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(turned_deg(0)));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(gate.accepts(turned_deg(20))) << i;
  EXPECT_TRUE(gate.accepts(turned_deg(20)));
  EXPECT_TRUE(gate.accepts(turned_deg(22)));
  EXPECT_FALSE(gate.accepts(turned_deg(0)));
}

TEST(RotationGate, AGoodFrameClearsTheStrikes) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(turned_deg(0)));
  for (int round = 0; round < 3; ++round) {
    EXPECT_FALSE(gate.accepts(turned_deg(20)));
    EXPECT_FALSE(gate.accepts(turned_deg(20)));
    EXPECT_TRUE(gate.accepts(turned_deg(1)));
  }
}

// What jumps from 180 to -180 degrees has hardly turned: the hold paper's authors met that as a
// bug.
TEST(RotationGate, DoesNotMindAnglesThatWrap) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(turned_deg(179)));
  EXPECT_TRUE(gate.accepts(turned_deg(-179)));
  const Eigen::Quaterniond same = turned_deg(-179);
  EXPECT_TRUE(gate.accepts(Eigen::Quaterniond(-same.coeffs())));
}

TEST(RotationGate, AcceptsAnythingAfterAReset) {
  RotationGate gate({});
  EXPECT_TRUE(gate.accepts(turned_deg(0)));
  EXPECT_FALSE(gate.accepts(turned_deg(90)));
  gate.reset();
  EXPECT_TRUE(gate.accepts(turned_deg(90)));
}

}  // namespace
}  // namespace stillkite
