#include "stabilization/hold_setpoint.hpp"

#include <gtest/gtest.h>

#include "stabilization/hold_errors.hpp"
#include "tests/stabilization/hold_scene.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

RigidTransform camera_at(const Vector3d& position_m, double yaw_rad) {
  return {so3_exp({0, 0, yaw_rad}) * forward_camera(), position_m};
}

// Reference, pose to hold and camera in the station's frame; the error is their difference.
TEST(HoldSetpoint, ErrorIsThatToThePoseOfTheCommand) {
  const RigidTransform reference = camera_at({0, 0, 2}, 0);
  const RigidTransform held = camera_at({3, -1, 2.5}, 0.4);
  const RigidTransform camera = camera_at({3.2, -1.1, 2.4}, 0.3);
  HoldSetpoint setpoint;
  ASSERT_TRUE(setpoint.move_to(exact_estimate(reference, held)));
  const MotionEstimate estimate = setpoint.relative(exact_estimate(reference, camera));
  const Vector3d error_m = position_error_in_station(estimate, camera.rotation);
  EXPECT_LT((error_m - Vector3d(-0.2, 0.1, 0.1)).norm(), 1e-12);
  EXPECT_NEAR(yaw_error_rad(estimate, camera.rotation), 0.1, 1e-12);
}

TEST(HoldSetpoint, CameraAtRestAtTheReferenceIsDisplacedFromThePoseToHold) {
  const RigidTransform reference = camera_at({0, 0, 2}, 0);
  HoldSetpoint setpoint;
  ASSERT_TRUE(setpoint.move_to(exact_estimate(reference, camera_at({0.5, 0, 2}, 0))));
  MotionEstimate at_rest = exact_estimate(reference, reference);
  at_rest.displacement_kind = DisplacementKind::zero;
  const MotionEstimate estimate = setpoint.relative(at_rest);
  EXPECT_EQ(estimate.displacement_kind, DisplacementKind::metric);
  EXPECT_LT((position_error_in_station(estimate, reference.rotation) - Vector3d(0.5, 0, 0)).norm(),
            1e-12);
}

TEST(HoldSetpoint, NeedsAMeasuredMetricDisplacement) {
  const MotionEstimate metric =
      exact_estimate(camera_at({0, 0, 2}, 0), camera_at({0.5, 0, 2}, 0.2));
  HoldSetpoint setpoint;
  for (const DisplacementKind kind : {DisplacementKind::direction, DisplacementKind::unknown}) {
    MotionEstimate estimate = metric;
    estimate.displacement_kind = kind;
    EXPECT_FALSE(setpoint.move_to(estimate));
  }
  MotionEstimate predicted = metric;
  predicted.status = EstimateStatus::predicted;
  EXPECT_FALSE(setpoint.move_to(predicted));
  EXPECT_EQ(setpoint.relative(metric).displacement_in_reference, metric.displacement_in_reference);
  ASSERT_TRUE(setpoint.move_to(metric));
  MotionEstimate direction = metric;
  direction.displacement_kind = DisplacementKind::direction;
  EXPECT_EQ(setpoint.relative(direction).displacement_kind, DisplacementKind::unknown);
}

}  // namespace
}  // namespace stillkite
