#include "simulation/flight/vehicle_path.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

std::optional<VehiclePlacement> place_vehicle(const SimulationConfig& config,
                                              const Trajectory& trajectory, double t_s) {
  if (!config.vehicle) return std::nullopt;
  const SimulatedCameraConfig& camera = config.camera;
  const double half_s = 0.5 * config.vehicle->crossing_s;
  const double middle_s = (2 * std::floor(t_s / (2 * half_s)) + 1) * half_s;
  const MotionState middle = trajectory.at(middle_s);
  const double height_m = middle.world_from_body.translation.z();
  const double image_width_m = camera.width_px * height_m / camera.focal_x_px;
  const double image_height_m = camera.height_px * height_m / camera.focal_y_px;
  const double area_m2 = config.vehicle->image_share * image_width_m * image_height_m;
  const double length_m = std::sqrt(2 * area_m2);

  // image right = -y of the body; oblique, so that the motion has a forward component
  const Eigen::Vector3d right_and_up(0.35, -1, 0);
  const Eigen::Vector2d direction =
      (middle.world_from_body.rotation * right_and_up).head<2>().normalized();
  const double relative_speed_m_s = image_width_m / (2 * half_s);
  const Eigen::Vector2d velocity_m_s =
      middle.velocity_in_world_m_s.head<2>() + relative_speed_m_s * direction;
  return VehiclePlacement{.centre_in_world_m = middle.world_from_body.translation.head<2>() +
                                               (t_s - middle_s) * velocity_m_s,
                          .heading_rad = std::atan2(velocity_m_s.y(), velocity_m_s.x()),
                          .length_m = length_m,
                          .width_m = 0.5 * length_m};
}

}  // namespace stillkite
