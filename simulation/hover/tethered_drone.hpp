#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"
#include "simulation/hover/station_path.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

struct TetheredDroneConfig {
  double start_length_m = 2;
  double shortest_m = 0.3;
  double longest_m = 20;
  double length_rate_limit_m_s = 0.3;
  double elevation_rate_limit_rad_s = 0.25;
  double azimuth_rate_limit_rad_s = 0.2;
  double yaw_rate_limit_rad_s = 0.4;
  double lag_s = 0.5;
  double shift_per_wind_s = 0.05;
  double wind_lag_s = 1;
  double taut_up_to_wind_m_s = 6;

  static void fields(auto& self, auto&& field) {
    field("start_length_m", self.start_length_m, kPositive, "initial tether length");
    field("shortest_m", self.shortest_m, kPositive, "minimum tether length");
    field("longest_m", self.longest_m, kPositive, "maximum tether length");
    field("length_rate_limit_m_s", self.length_rate_limit_m_s, kPositive, "maximum reel speed");
    field("elevation_rate_limit_rad_s", self.elevation_rate_limit_rad_s, kPositive,
          "maximum elevation rate");
    field("azimuth_rate_limit_rad_s", self.azimuth_rate_limit_rad_s, kPositive,
          "maximum azimuth rate");
    field("yaw_rate_limit_rad_s", self.yaw_rate_limit_rad_s, kPositive, "maximum yaw rate");
    field("lag_s", self.lag_s, kPositive, "time constant from commanded to actual rate");
    field("shift_per_wind_s", self.shift_per_wind_s, kNonNegative,
          "displacement in metres per 1 m/s of wind across the tether");
    field("wind_lag_s", self.wind_lag_s, kPositive, "time constant of the wind response");
    field("taut_up_to_wind_m_s", self.taut_up_to_wind_m_s, kNonNegative,
          "maximum wind towards the station with a taut tether");
  }
};

/// Disturbances during a step.
struct Disturbance {
  Eigen::Vector3d wind_in_world_m_s = Eigen::Vector3d::Zero();
  double yaw_kick_rad = 0;    ///< yaw change over the step, left is +
  double loose_tether_m = 0;  ///< slack from a reel fault: length minus distance
};

enum class TetherStatus { taut, slack_by_wind, slack_by_fault };

/// Ground truth of the drone. Velocity: extrapolated to the current time from the means of the last
/// two internal steps. Yaw rate: mean of the last internal step.
struct DroneTruth {
  RigidTransform world_from_body;    ///< horizontal body: Rz(yaw)
  RigidTransform world_from_camera;  ///< gimbal: constant tilt and roll of the camera
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  double yaw_rate_rad_s = 0;
  TetherState tether;  ///< direction to the drone; paid-out length, taut or slack
  TetherStatus tether_status = TetherStatus::taut;
};

/// Plant model of a drone that holds length, elevation and azimuth of its tether in the station
/// frame, and its yaw in the world frame. It therefore follows the station.
///
/// Each limited rate command passes a first-order lag. Both are integrated in closed form over
/// steps of at most 5 ms. Wind across the tether displaces the drone to the equilibrium of thrust
/// and wind; commands can compensate the displacement. A taut tether is inextensible. Wind towards
/// the station above `taut_up_to_wind_m_s` makes the tether slack, and the drone nearer than its
/// length.
class TetheredDrone {
 public:
  /// Initial state: at rest above the station. `body_from_camera`: mount on a horizontal body.
  /// Throws InputError unless shortest_m <= start_length_m <= longest_m.
  TetheredDrone(const TetheredDroneConfig& config, const RigidTransform& body_from_camera,
                const StationState& station, double yaw_rad);

  /// Advances by `duration_s`. `station`: state at the end; interpolated from the previous one.
  /// A non-finite rate command is 0.
  void step(const TetherCommand& command, const Disturbance& disturbance,
            const StationState& station, double duration_s);

  [[nodiscard]] const DroneTruth& truth() const { return truth_; }

 private:
  // Controlled coordinate and its rate after the lag.
  struct Axis {
    double value = 0;
    double rate = 0;
  };
  [[nodiscard]] static Axis follow(const Axis& axis, double command, double lag_s,
                                   double duration_s);
  [[nodiscard]] static Axis clamped(const Axis& axis, double low, double high);
  void advance(const TetherCommand& limited, const Eigen::Vector3d& wind, double duration_s);
  void update_pose(double loose_tether_m);
  struct MeanVelocity {
    Eigen::Vector3d in_world_m_s;
    double step_s;
  };
  void update_velocity(const Eigen::Vector3d& mean_m_s, double step_s);

  TetheredDroneConfig config_;
  RigidTransform body_from_camera_;
  RigidTransform world_from_station_;
  Axis length_;
  Axis elevation_;
  Axis azimuth_;
  Axis yaw_;
  Eigen::Vector3d lagged_wind_in_world_m_s_ = Eigen::Vector3d::Zero();
  std::optional<MeanVelocity> mean_velocity_;  // of the last internal step
  DroneTruth truth_;
};

}  // namespace stillkite
