#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "simulation/scene/ground_texture.hpp"
#include "simulation/scene/relief.hpp"

namespace stillkite {

struct RenderView;

/// What there is to see: a ground, flat unless it has a relief, under an even sky.
struct Scene {
  std::shared_ptr<const GroundTexture> ground;
  std::shared_ptr<const Relief> relief;          ///< null: flat
  std::shared_ptr<const GroundTexture> vehicle;  ///< its paint, rear at the left; null: none
  double sky_grey = 200;
};

/// A rectangle painted on the ground that follows it up and down.
struct VehiclePlacement {
  Eigen::Vector2d centre_in_world_m;
  double heading_rad = 0;  ///< of its length, from +x towards +y
  double length_m = 0;
  double width_m = 0;
};

/// One camera with the bearings of all its samples, computed once.
class Renderer {
 public:
  /// `supersampling`: samples a pixel and direction, 1 to 4. Throws InputError on a bad camera.
  Renderer(const Camera& camera, int supersampling);

  /// Noise-free image, CV_32FC1 in grey values, of a pinhole shutter at one instant: every pixel
  /// the mean of its samples. A camera at or below the ground sees sky only. On a relief the ray
  /// meets the ground by fixed-point steps, exact where slope x tan(angle from nadir) < 1.
  [[nodiscard]] cv::Mat render(const Scene& scene, const RigidTransform& world_from_camera,
                               const std::optional<VehiclePlacement>& vehicle = {}) const;

  /// These rows of it alone, written into `image`.
  void render_rows(const Scene& scene, const RigidTransform& world_from_camera,
                   const std::optional<VehiclePlacement>& vehicle, const cv::Range& rows,
                   cv::Mat& image) const;

 private:
  void tabulate_pinhole();
  void tabulate_lens();
  void render_strip(const RenderView& frame_view, int first_column, int count,
                    const cv::Range& rows, cv::Mat& image) const;

  Camera camera_;
  int supersampling_;
  int padded_width_;
  // Rows of padded_width_ bearings. A pinhole's x is the same in all rows, its y within one.
  std::vector<float> x_;
  std::vector<float> y_;
};

}  // namespace stillkite
