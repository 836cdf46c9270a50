#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <variant>

#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/render/renderer.hpp"

namespace stillkite {

/// Relief of the ground; null if it is flat.
[[nodiscard]] std::shared_ptr<const Relief> make_relief(const SimulationConfig& config);

/// Sum of several noise-free images of one exposure, CV_32FC1 in grey values.
struct IrradianceSum {
  cv::Mat sum;
  int images = 1;
};

/// Camera of a flight in its scene; renders exposures with motion blur and rolling shutter.
class FlightCamera {
 public:
  /// `config` must outlive it. `photograph`: as for `render_flight`.
  FlightCamera(const SimulationConfig& config, const cv::Mat& photograph);

  /// `t_s`: middle of the exposure of the middle row.
  [[nodiscard]] IrradianceSum expose(double t_s) const;

 private:
  struct Ground {
    Scene scene;
    Renderer renderer;
  };
  struct Patches {
    PatchScene scene;
    PatchRenderer renderer;
  };

  [[nodiscard]] IrradianceSum expose(const Ground& ground, double t_s) const;
  [[nodiscard]] IrradianceSum expose(const Patches& patches, double t_s) const;
  void render(const Ground& ground, double t_s, cv::Mat& image) const;
  [[nodiscard]] RigidTransform world_from_camera(double t_s) const;

  const SimulationConfig& config_;
  Trajectory trajectory_;
  RigidTransform body_from_camera_;
  std::variant<Ground, Patches> world_;
};

}  // namespace stillkite
