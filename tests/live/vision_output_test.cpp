#include "live/mavlink/vision_output.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "geometry/euler.hpp"

namespace stillkite::mavlink {
namespace {

constexpr double kHeight_m = 10, kTolerance = 1e-6;
constexpr double kInterval_s = 0.1, kFocalLength_px = 300;

// Camera that looks down, its image's upper side forward: x right, y back, z down.
RigidTransform nadir_camera() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return {.rotation = Eigen::Quaterniond(R), .translation = Eigen::Vector3d::Zero()};
}

NavigationEstimate at_rest() {
  NavigationEstimate estimate;
  estimate.stamp = {2'000'000'000};
  estimate.verdict = Verdict::ok;
  estimate.scale = ScaleSource::initial_height;
  estimate.quality.inlier_ratio = 0.5;
  estimate.world_from_body.translation.z() = kHeight_m;
  return estimate;
}

// Motion in our body's axes, forward, left, up.
BodyState moving(const Eigen::Vector3d& velocity_m_s, const Eigen::Vector3d& rate_rad_s) {
  const Eigen::Quaterniond camera_from_body = nadir_camera().rotation.conjugate();
  NavigationEstimate estimate = at_rest();
  estimate.twist_in_camera = {.velocity_m_s = camera_from_body * velocity_m_s,
                              .angular_rate_rad_s = camera_from_body * rate_rad_s};
  return body_state(estimate, nadir_camera(), 0).value();
}

OpticalFlow flow_of(const Eigen::Vector3d& velocity_m_s, const Eigen::Vector3d& rate_rad_s) {
  return optical_flow(moving(velocity_m_s, rate_rad_s), kInterval_s, kFocalLength_px).value();
}

BodyState at_position(const Eigen::Vector3d& position_m) {
  NavigationEstimate estimate = at_rest();
  estimate.world_from_body.translation += position_m;
  return body_state(estimate, nadir_camera(), 0).value();
}

BodyState at_attitude(const EulerAngles& angles) {
  NavigationEstimate estimate = at_rest();
  estimate.world_from_body.rotation = to_quaternion(angles);
  return body_state(estimate, nadir_camera(), 0).value();
}

// Our axis and sign of a motion, and the axis (0, 1, 2) and sign of MAVLink's.
struct Axis {
  std::string name;
  Eigen::Vector3d ours;
  int index = 0;
};
const std::vector<Axis> kDirections{
    {"forward", {1, 0, 0}, 0}, {"right", {0, -1, 0}, 1}, {"down", {0, 0, -1}, 2}};
// Rotations with a positive sign in MAVLink: right side down, nose up, nose right.
const std::vector<Axis> kRotations{
    {"roll", {1, 0, 0}, 0}, {"pitch", {0, -1, 0}, 1}, {"yaw", {0, 0, -1}, 2}};

void expect_axis(const Eigen::Vector3d& value, const Axis& axis, const std::string& field) {
  EXPECT_TRUE(value.isApprox(Eigen::Vector3d::Unit(axis.index), kTolerance))
      << field << " " << axis.name << ": " << value.transpose();
}

TEST(VisionOutput, OdometryHasForwardRightDownAxes) {
  for (const Axis& axis : kDirections) {
    const Odometry moved = odometry(at_position(axis.ours));
    expect_axis({moved.x, moved.y, moved.z + kHeight_m}, axis, "position");
    const Odometry moves = odometry(moving(axis.ours, Eigen::Vector3d::Zero()));
    expect_axis({moves.vx, moves.vy, moves.vz}, axis, "velocity");
    EXPECT_EQ(moves.frame_id, 20);
    EXPECT_EQ(moves.child_frame_id, 12);
  }
  for (const Axis& axis : kRotations) {
    const Odometry rotates = odometry(moving(Eigen::Vector3d::Zero(), axis.ours));
    expect_axis({rotates.rollspeed, rotates.pitchspeed, rotates.yawspeed}, axis, "rate");
  }
}

// A small rotation about each of our axes: sign of q's vector part.
TEST(VisionOutput, OdometryAttitudeHasTheSignsOfRollPitchYaw) {
  constexpr double kAngle_rad = 0.2;
  const auto q_of = [](const EulerAngles& angles) {
    const Odometry message = odometry(at_attitude(angles));
    return Eigen::Vector4d(message.q[0], message.q[1], message.q[2], message.q[3]);
  };
  const double c = std::cos(kAngle_rad / 2), s = std::sin(kAngle_rad / 2);
  EXPECT_TRUE(q_of({.roll_rad = kAngle_rad}).isApprox(Eigen::Vector4d(c, s, 0, 0), kTolerance));
  EXPECT_TRUE(q_of({.pitch_rad = -kAngle_rad}).isApprox(Eigen::Vector4d(c, 0, s, 0), kTolerance));
  EXPECT_TRUE(q_of({.yaw_rad = -kAngle_rad}).isApprox(Eigen::Vector4d(c, 0, 0, s), kTolerance));
}

TEST(VisionOutput, VisionPositionEstimateHasForwardRightDownAxesAndAeronauticalAngles) {
  for (const Axis& axis : kDirections) {
    const VisionPositionEstimate message = vision_position_estimate(at_position(axis.ours));
    expect_axis({message.x, message.y, message.z + kHeight_m}, axis, "position");
  }
  const VisionPositionEstimate message =
      vision_position_estimate(at_attitude({.yaw_rad = -0.3, .pitch_rad = -0.2, .roll_rad = 0.1}));
  EXPECT_NEAR(message.roll, 0.1, kTolerance);
  EXPECT_NEAR(message.pitch, 0.2, kTolerance);
  EXPECT_NEAR(message.yaw, 0.3, kTolerance);
}

TEST(VisionOutput, VisionSpeedEstimateIsInTheLocalFrame) {
  for (const Axis& axis : kDirections) {
    const VisionSpeedEstimate message =
        vision_speed_estimate(moving(axis.ours, Eigen::Vector3d::Zero()));
    expect_axis({message.x, message.y, message.z}, axis, "velocity");
  }
  BodyState state = moving({1, 0, 0}, Eigen::Vector3d::Zero());
  state.local_from_body = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());  // nose right
  const VisionSpeedEstimate message = vision_speed_estimate(state);
  EXPECT_NEAR(message.y, 1, kTolerance);
}

// MAVLink: rotation about x or y gives positive flow; motion along +y negative flow_x, along +x
// positive flow_y.
TEST(VisionOutput, OpticalFlowHasTheSignsOfTheSensorsRotation) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  const OpticalFlow forward = flow_of({1, 0, 0}, none);
  EXPECT_NEAR(forward.flow_rate_x, 0, kTolerance);
  EXPECT_NEAR(forward.flow_rate_y, 1 / kHeight_m, kTolerance);
  EXPECT_EQ(forward.flow_x, 0);
  EXPECT_EQ(forward.flow_y, 30);  // 0.1 px: 10 * 300 px * 0.1 rad/s * 0.1 s
  EXPECT_NEAR(forward.flow_comp_m_x, 1, kTolerance);
  EXPECT_NEAR(forward.ground_distance, kHeight_m, kTolerance);
  EXPECT_EQ(forward.quality, 127);
  const OpticalFlow right = flow_of({0, -1, 0}, none);
  EXPECT_NEAR(right.flow_rate_x, -1 / kHeight_m, kTolerance);
  EXPECT_NEAR(right.flow_rate_y, 0, kTolerance);
  EXPECT_NEAR(flow_of({0, 0, -1}, none).flow_rate_x, 0, kTolerance);
  EXPECT_NEAR(flow_of(none, {1, 0, 0}).flow_rate_x, 1, kTolerance);
  EXPECT_NEAR(flow_of(none, {0, -1, 0}).flow_rate_y, 1, kTolerance);
  EXPECT_NEAR(flow_of(none, {0, 0, -1}).flow_rate_y, 0, kTolerance);
}

TEST(VisionOutput, OpticalFlowRadIntegratesOverTheInterval) {
  const OpticalFlowRad message =
      optical_flow_rad(moving({2, 0, 0}, {0.5, -0.25, -1}), 0.04).value();
  EXPECT_EQ(message.integration_time_us, 40'000U);
  EXPECT_NEAR(message.integrated_x, 0.04 * 0.5, kTolerance);
  EXPECT_NEAR(message.integrated_y, 0.04 * (0.25 + 2 / kHeight_m), kTolerance);
  EXPECT_NEAR(message.integrated_xgyro, 0.04 * 0.5, kTolerance);
  EXPECT_NEAR(message.integrated_ygyro, 0.04 * 0.25, kTolerance);
  EXPECT_NEAR(message.integrated_zgyro, 0.04 * 1, kTolerance);
  EXPECT_NEAR(message.distance, kHeight_m, kTolerance);
}

TEST(VisionOutput, VelocityIsThatOfTheBodysOrigin) {
  // camera 1 m ahead of the body's origin, which yaws to the left: the camera moves to the left
  RigidTransform mount = nadir_camera();
  mount.translation = {1, 0, 0};
  NavigationEstimate estimate = at_rest();
  const Eigen::Quaterniond camera_from_body = mount.rotation.conjugate();
  estimate.twist_in_camera = {.velocity_m_s = camera_from_body * Eigen::Vector3d(0, 2, 0),
                              .angular_rate_rad_s = camera_from_body * Eigen::Vector3d(0, 0, 2)};
  EXPECT_TRUE(body_state(estimate, mount, 0)->velocity_in_body_m_s.isZero(kTolerance));
}

TEST(VisionOutput, CovarianceIsTheUpperTriangleInFlippedAxes) {
  NavigationEstimate estimate = at_rest();
  estimate.pose_covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  estimate.pose_covariance(0, 1) = estimate.pose_covariance(1, 0) = 0.5;
  const Odometry message = odometry(body_state(estimate, nadir_camera(), 9).value());
  EXPECT_EQ(message.pose_covariance[0], 1);
  EXPECT_EQ(message.pose_covariance[1], -0.5f);
  EXPECT_EQ(message.pose_covariance[6], 2);
  EXPECT_EQ(message.pose_covariance[11], 3);
  EXPECT_EQ(message.pose_covariance[20], 6);
  EXPECT_EQ(message.reset_counter, 9);
}

TEST(VisionOutput, FrameThatIsNotMeasuredHasNoState) {
  NavigationEstimate estimate = at_rest();
  EXPECT_EQ(body_state(estimate, nadir_camera(), 0)->quality, 50);
  for (const Verdict verdict : {Verdict::first_frame, Verdict::lost, Verdict::frozen}) {
    estimate.verdict = verdict;
    EXPECT_FALSE(body_state(estimate, nadir_camera(), 0));
  }
  estimate.verdict = Verdict::still;
  EXPECT_EQ(body_state(estimate, nadir_camera(), 0)->quality, 100);
  estimate.scale = ScaleSource::none;
  EXPECT_FALSE(body_state(estimate, nadir_camera(), 0));
}

TEST(VisionOutput, EstimateThatIsNotFiniteHasNoState) {
  NavigationEstimate estimate = at_rest();
  estimate.pose_covariance(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(body_state(estimate, nadir_camera(), 0));
}

TEST(VisionOutput, FlowNeedsAGroundBelow) {
  const BodyState below = at_position({0, 0, -2 * kHeight_m});
  EXPECT_FALSE(optical_flow(below, kInterval_s, kFocalLength_px));
  EXPECT_FALSE(optical_flow_rad(below, kInterval_s));
}

TEST(VisionOutput, StampIsInMicroseconds) {
  EXPECT_EQ(odometry(moving({0, 0, 0}, {0, 0, 0})).time_usec, 2'000'000U);
}

TEST(VisionOutput, StatusTextIsCutAtFiftyBytes) {
  const Statustext message = status_text(Severity::warning, std::string(60, 'x'));
  EXPECT_EQ(message.text.back(), 'x');
  EXPECT_EQ(status_text(Severity::info, "ok").text[2], '\0');
}

}  // namespace
}  // namespace stillkite::mavlink
