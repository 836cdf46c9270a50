#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "simulation/render/bearing_table.hpp"
#include "simulation/render/patch_view.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Exposure with uniform camera motion between two poses. The samples of a pixel are distributed
/// over `instants` equally spaced poses, so that motion blur costs little extra time.
struct Shutter {
  RigidTransform world_from_camera_at_opening;
  RigidTransform world_from_camera_at_closing;
  int instants = 4;  ///< divisor of the samples per pixel
};

/// Renderer of one camera for scenes of patches; the bearings of all samples are computed once.
class PatchRenderer {
 public:
  /// `supersampling`: samples per pixel and direction, 1 to 4. Throws InputError for an invalid
  /// camera or supersampling.
  PatchRenderer(const Camera& camera, int supersampling, const LensError& lens_error = {});

  /// Noise-free image, CV_32FC1 in grey values. A sample is the nearest patch along its ray; a
  /// pixel is the mean of its samples.
  [[nodiscard]] cv::Mat render(const PatchScene& scene,
                               const RigidTransform& world_from_camera) const;

  /// Image with motion blur. Throws InputError if `instants` does not divide the samples per pixel.
  [[nodiscard]] cv::Mat render(const PatchScene& scene, const Shutter& shutter) const;

  /// Renders only `rows` into `image`, CV_32FC1.
  void render_rows(const PatchScene& scene, const Shutter& shutter, const cv::Range& rows,
                   cv::Mat& image) const;

 private:
  Camera camera_;
  BearingTable bearings_;
  std::vector<BearingBounds> bands_;   // one per row of tiles
  std::vector<BearingBounds> groups_;  // adjacent tiles of a band
  std::vector<BearingBounds> tiles_;   // row by row
};

}  // namespace stillkite
