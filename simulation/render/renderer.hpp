#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "simulation/render/lens_error.hpp"
#include "simulation/scene/ground_texture.hpp"
#include "simulation/scene/relief.hpp"

namespace stillkite {

struct RenderView;

/// Textured ground, optionally with relief and a vehicle, under a uniform sky.
struct Scene {
  std::shared_ptr<const GroundTexture> ground;
  std::shared_ptr<const Relief> relief;          ///< null: flat ground
  std::shared_ptr<const GroundTexture> vehicle;  ///< texture, rear at the left; null: no vehicle
  double sky_grey = 200;
};

/// Rectangle on the ground surface.
struct VehiclePlacement {
  Eigen::Vector2d centre_in_world_m;
  double heading_rad = 0;  ///< azimuth of its length, from +x towards +y
  double length_m = 0;
  double width_m = 0;
};

/// Elliptic shadow on the ground, cast by the sun; its edge is a linear ramp.
struct ShadowPlacement {
  Eigen::Vector2d centre_in_world_m;  ///< on z = 0
  double sun_azimuth_rad = 0;         ///< direction to the sun, from +x towards +y
  double sun_elevation_rad = 0;
  double inner_radius_m = 0;  ///< of the full shadow, across the azimuth
  double outer_radius_m = 0;
  double darkening_ratio = 0;
};

struct GroundObjects {
  std::optional<VehiclePlacement> vehicle{};
  std::optional<ShadowPlacement> shadow{};
};

/// Ground renderer of one camera; the bearings of all samples are computed once.
class Renderer {
 public:
  /// `supersampling`: samples per pixel and direction, 1 to 4. Throws InputError for an invalid
  /// camera or supersampling.
  Renderer(const Camera& camera, int supersampling, const LensError& lens_error = {});

  /// Noise-free image of one instant, CV_32FC1 in grey values; a pixel is the mean of its samples.
  /// At or below z = 0 the image is sky. Rays intersect a relief by fixed-point iteration, which
  /// converges where slope x tan(angle from nadir) < 1.
  [[nodiscard]] cv::Mat render(const Scene& scene, const RigidTransform& world_from_camera,
                               const GroundObjects& objects = {}) const;

  /// Renders only `rows` into `image`.
  void render_rows(const Scene& scene, const RigidTransform& world_from_camera,
                   const GroundObjects& objects, const cv::Range& rows, cv::Mat& image) const;

 private:
  void tabulate_pinhole();
  void tabulate_lens(const LensError& lens_error);
  void render_strip(const RenderView& frame_view, int first_column, int count,
                    const cv::Range& rows, cv::Mat& image) const;

  Camera camera_;
  int supersampling_;
  int padded_width_;
  bool pinhole_;  ///< no distortion and no lens error
  // Rows of padded_width_ bearings. Pinhole: x depends on the column only, y on the row only.
  std::vector<float> x_;
  std::vector<float> y_;
};

}  // namespace stillkite
