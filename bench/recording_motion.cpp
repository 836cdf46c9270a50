#include "recording_motion.hpp"

#include <algorithm>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>

#include "evaluation/association.hpp"

namespace stillkite::bench {
namespace {

const Eigen::Vector3d kMirrorY(1, -1, 1);
const Eigen::Vector3d kMirrorX(-1, 1, 1);
const Eigen::Vector3d kHalfTurn(-1, -1, 1);

// A R B of two reflections is a rotation.
RigidTransform reflected(const Eigen::Vector3d& A, const RigidTransform& b_from_a,
                         const Eigen::Vector3d& B) {
  const Eigen::Matrix3d R = A.asDiagonal() * b_from_a.rotation.toRotationMatrix() * B.asDiagonal();
  return {Eigen::Quaterniond(R), A.cwiseProduct(b_from_a.translation)};
}

// Lens of the image flipped left to right, and upside down if `rotated`. Tangential coefficients:
// p1 acts on rows, p2 on columns.
Camera flipped(Camera camera, bool rotated) {
  const bool tangential = camera.distortion == DistortionModel::radial_tangential;
  camera.centre_x_px = camera.width_px - 1 - camera.centre_x_px;
  if (tangential) camera.coefficients[3] *= -1;
  if (!rotated) return camera;
  camera.centre_y_px = camera.height_px - 1 - camera.centre_y_px;
  if (tangential) camera.coefficients[2] *= -1;
  return camera;
}

enum class Flip { horizontal = 1, both = -1 };

std::vector<RecordedImage> flipped(const std::vector<RecordedImage>& images, Flip flip) {
  std::vector<RecordedImage> out;
  for (const RecordedImage& image : images) {
    cv::Mat grey;
    cv::flip(image.grey, grey, static_cast<int>(flip));
    out.push_back({image.stamp, grey});
  }
  return out;
}

// Index of the image with this stamp; nullopt without one.
std::optional<std::size_t> image_at(const std::vector<RecordedImage>& images, Timestamp stamp) {
  const auto at = std::ranges::lower_bound(images, stamp, {}, &RecordedImage::stamp);
  if (at == images.end() || at->stamp != stamp) return std::nullopt;
  return static_cast<std::size_t>(at - images.begin());
}

// True twists of one interval, each over its own part, averaged in the camera at its middle.
// Nullopt without a row for each image after `first`.
std::optional<Twist> mean_over(const Recording& recording, std::size_t first, std::size_t last) {
  constexpr double kTolerance_s = 0.05;
  const auto camera_at = [&](Timestamp a, Timestamp b) {
    return pose_at(recording.poses, {a.ns + (b.ns - a.ns) / 2}, kTolerance_s);
  };
  const auto& images = recording.images;
  const auto middle = camera_at(images[first].stamp, images[last].stamp);
  Twist sum;
  for (std::size_t i = first + 1; i <= last; ++i) {
    const auto twist =
        std::ranges::find(recording.twists_in_camera, images[i].stamp, &StampedTwist::stamp);
    const auto pose = camera_at(images[i - 1].stamp, images[i].stamp);
    if (twist == recording.twists_in_camera.end() || !pose || !middle) return std::nullopt;
    const RigidTransform& mount = recording.body_from_camera;
    const Eigen::Quaterniond middle_from_camera =
        (middle->rotation * mount.rotation).conjugate() * pose->rotation * mount.rotation;
    const double share = seconds_between(images[i - 1].stamp, images[i].stamp) /
                         seconds_between(images[first].stamp, images[last].stamp);
    sum.velocity_m_s += share * (middle_from_camera * twist->twist.velocity_m_s);
    sum.angular_rate_rad_s += share * (middle_from_camera * twist->twist.angular_rate_rad_s);
  }
  return sum;
}

}  // namespace

Recording every_nth_image(const Recording& recording, int n) {
  Recording out = recording;
  out.images.clear();
  out.twists_in_camera.clear();
  const auto step = static_cast<std::size_t>(n);
  for (std::size_t i = 0; i < recording.images.size(); i += step) {
    out.images.push_back(recording.images[i]);
    if (i == 0) continue;
    if (const auto twist = mean_over(recording, i - step, i)) {
      out.twists_in_camera.push_back({recording.images[i].stamp, *twist});
    }
  }
  return out;
}

Recording backwards(const Recording& recording) {
  const std::int64_t sum_ns = recording.images.front().stamp.ns + recording.images.back().stamp.ns;
  const auto reversed = [sum_ns](Timestamp stamp) { return Timestamp{sum_ns - stamp.ns}; };
  Recording out = recording;
  out.camera = flipped(recording.camera, true);
  const Eigen::Quaterniond half_turn(0, 0, 0, 1);
  out.body_from_camera.rotation = recording.body_from_camera.rotation * half_turn;

  out.images = flipped(recording.images, Flip::both);
  for (RecordedImage& image : out.images) image.stamp = reversed(image.stamp);
  std::ranges::reverse(out.images);
  for (StampedPose& pose : out.poses) pose.stamp = reversed(pose.stamp);
  std::ranges::reverse(out.poses);

  out.twists_in_camera.clear();
  for (const StampedTwist& row : recording.twists_in_camera) {
    const auto end = image_at(recording.images, row.stamp);
    if (!end || *end == 0) continue;
    // the interval now ends where it began
    out.twists_in_camera.push_back({reversed(recording.images[*end - 1].stamp),
                                    {-kHalfTurn.cwiseProduct(row.twist.velocity_m_s),
                                     -kHalfTurn.cwiseProduct(row.twist.angular_rate_rad_s)}});
  }
  std::ranges::reverse(out.twists_in_camera);

  for (Timestamp& stamp : out.imu.stamps) stamp = reversed(stamp);
  std::ranges::reverse(out.imu.stamps);
  for (Vector6d& reading : out.imu.values) reading.head<3>() *= -1;
  std::ranges::reverse(out.imu.values);
  return out;
}

Recording mirrored(const Recording& recording) {
  Recording out = recording;
  out.camera = flipped(recording.camera, false);
  out.images = flipped(recording.images, Flip::horizontal);
  out.body_from_camera = reflected(kMirrorY, recording.body_from_camera, kMirrorX);
  for (StampedPose& pose : out.poses) {
    pose.world_from_body = reflected(kMirrorY, pose.world_from_body, kMirrorY);
  }
  for (StampedTwist& row : out.twists_in_camera) {
    row.twist = {kMirrorX.cwiseProduct(row.twist.velocity_m_s),
                 -kMirrorX.cwiseProduct(row.twist.angular_rate_rad_s)};
  }
  for (Vector6d& reading : out.imu.values) {
    reading << -kMirrorY.cwiseProduct(reading.head<3>()), kMirrorY.cwiseProduct(reading.tail<3>());
  }
  return out;
}

Recording from_origin(const Recording& recording) {
  constexpr double kTolerance_s = 0.1;
  Recording out = recording;
  const auto first = pose_at(recording.poses, recording.images.front().stamp, kTolerance_s);
  if (!first) throw InputError("the truth does not cover the first image");
  for (StampedPose& pose : out.poses) {
    pose.world_from_body.translation.head<2>() -= first->translation.head<2>();
  }
  return out;
}

Recording with_rotated_world(const Recording& recording) {
  const RigidTransform rotation{
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
      Eigen::Vector3d::Zero()};
  Recording out = recording;
  for (StampedPose& pose : out.poses) pose.world_from_body = rotation * pose.world_from_body;
  return out;
}

}  // namespace stillkite::bench
