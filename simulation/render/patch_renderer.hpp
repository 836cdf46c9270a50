#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "simulation/render/bearing_table.hpp"
#include "simulation/render/patch_view.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// An open shutter: the camera moves evenly from one pose to the other. The samples of a pixel are
/// dealt out to `instants`, evenly spaced, so that blur costs next to nothing.
struct Shutter {
  RigidTransform world_from_camera_at_opening;
  RigidTransform world_from_camera_at_closing;
  int instants = 4;  ///< divides the samples a pixel
};

/// One camera with the bearings of all its samples, computed once, over scenes of patches.
class PatchRenderer {
 public:
  /// `supersampling`: samples a pixel and direction, 1 to 4. Throws InputError on a bad camera.
  PatchRenderer(const Camera& camera, int supersampling);

  /// Noise-free image, CV_32FC1 in grey values: every pixel the mean of its samples, each of
  /// which shows the nearest patch that its ray meets.
  [[nodiscard]] cv::Mat render(const PatchScene& scene,
                               const RigidTransform& world_from_camera) const;

  /// Throws InputError if `instants` does not divide the samples a pixel.
  [[nodiscard]] cv::Mat render(const PatchScene& scene, const Shutter& shutter) const;

 private:
  Camera camera_;
  BearingTable bearings_;
  std::vector<BearingBounds> bands_;   // of rows of tiles
  std::vector<BearingBounds> groups_;  // of neighbours in a band
  std::vector<BearingBounds> tiles_;   // row by row
};

}  // namespace stillkite
