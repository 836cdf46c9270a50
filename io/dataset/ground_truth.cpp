#include "io/dataset/ground_truth.hpp"

#include <fmt/core.h>

#include <span>
#include <utility>
#include <vector>

#include "geometry/median.hpp"
#include "io/dataset/trajectory_file.hpp"

namespace stillkite {
namespace {

// Poses of the configuration, else of the data set.
GroundTruth read_poses(const TruthConfig& config, const std::optional<EurocDataset>& dataset) {
  if (config.path && config.positions) {
    throw InputError("truth.path and truth.positions are both set; keep one");
  }
  if (config.positions) {
    return {.poses = read_positions(*config.positions), .has_attitude = false};
  }
  std::optional<std::filesystem::path> file;
  if (config.path) {
    file = find_trajectory(*config.path);
  } else if (dataset) {
    file = dataset->truth;
  }
  if (!file) return {};
  GroundTruth truth{.poses = read_trajectory(*file)};
  truth.has_attitude = has_attitude(truth.poses);
  if (dataset && dataset->camera_twists && file == dataset->truth) {
    truth.twists_in_camera = read_twists(*dataset->camera_twists);
  }
  return truth;
}

// Rejects positions in millimetres.
void check_speed(std::span<const StampedPose> poses, const TruthConfig& config) {
  constexpr double kMaxSpeed_m_s = 340;
  std::vector<double> speeds_m_s;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double length_m =
        (poses[i].world_from_body.translation - poses[i - 1].world_from_body.translation).norm();
    speeds_m_s.push_back(length_m / seconds_between(poses[i - 1].stamp, poses[i].stamp));
  }
  if (speeds_m_s.empty()) return;
  const double speed_m_s = median(std::move(speeds_m_s));
  if (speed_m_s <= kMaxSpeed_m_s) return;
  throw InputError(fmt::format(
      "{}: the truth moves at {:.4g} m/s (median), expected below {}; give its positions in metres",
      config.positions ? "truth.positions" : "truth.path", speed_m_s, kMaxSpeed_m_s));
}

}  // namespace

RowSpan rows_of(const GroundTruth& truth) {
  if (!truth.poses.empty()) return row_span(truth.poses);
  if (!truth.velocities.empty()) return row_span(truth.velocities);
  return row_span(truth.twists_in_camera);
}

GroundTruth with_velocities(GroundTruth truth, const std::filesystem::path& file) {
  constexpr std::size_t kInWorld = 4, kInCamera = 7;
  const std::size_t columns = count_columns(file);
  truth.twists_in_camera.clear();
  if (columns == kInWorld) {
    truth.velocities = read_velocities(file);
  } else if (columns == kInCamera) {
    truth.twists_in_camera = read_twists(file);
  } else {
    throw InputError(fmt::format(
        "{}: {} columns; expected 4 (t, velocity in the world) or 7 (t, velocity and angular rate "
        "in the camera), separated by commas",
        file.string(), columns));
  }
  return truth;
}

GroundTruth with_time_offset(GroundTruth truth, double offset_s) {
  const std::int64_t offset_ns = from_seconds(offset_s).ns;
  for (StampedPose& pose : truth.poses) pose.stamp.ns += offset_ns;
  for (StampedTwist& twist : truth.twists_in_camera) twist.stamp.ns += offset_ns;
  for (StampedVelocity& velocity : truth.velocities) velocity.stamp.ns += offset_ns;
  return truth;
}

GroundTruth read_ground_truth(const TruthConfig& config,
                              const std::optional<EurocDataset>& dataset) {
  GroundTruth truth = read_poses(config, dataset);
  for (StampedPose& pose : truth.poses) {
    pose.world_from_body.translation.z() -= config.ground_z_m;
  }
  check_speed(truth.poses, config);
  if (config.velocity) truth = with_velocities(std::move(truth), *config.velocity);
  return with_time_offset(std::move(truth), config.time_offset_s);
}

}  // namespace stillkite
