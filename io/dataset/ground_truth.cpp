#include "io/dataset/ground_truth.hpp"

#include <filesystem>

#include "io/dataset/trajectory_file.hpp"

namespace stillkite {

GroundTruth read_ground_truth(const TruthConfig& config,
                              const std::optional<EurocDataset>& dataset) {
  std::optional<std::filesystem::path> file;
  if (config.path) {
    file = find_trajectory(*config.path);
  } else if (dataset) {
    file = dataset->truth;
  }
  if (!file) return {};
  GroundTruth truth{.poses = read_trajectory(*file), .twists_in_camera = {}};
  for (StampedPose& pose : truth.poses) {
    pose.world_from_body.translation.z() -= config.ground_z_m;
  }
  if (dataset && dataset->camera_twists && file == dataset->truth) {
    truth.twists_in_camera = read_twists(*dataset->camera_twists);
  }
  return truth;
}

}  // namespace stillkite
