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
    field("start_length_m", self.start_length_m, kPositive, "drone over its station at the start");
    field("shortest_m", self.shortest_m, kPositive, "tether that is never reeled in");
    field("longest_m", self.longest_m, kPositive, "tether there is");
    field("length_rate_limit_m_s", self.length_rate_limit_m_s, kPositive, "of the reel");
    field("elevation_rate_limit_rad_s", self.elevation_rate_limit_rad_s, kPositive, "of the drone");
    field("azimuth_rate_limit_rad_s", self.azimuth_rate_limit_rad_s, kPositive, "of the drone");
    field("yaw_rate_limit_rad_s", self.yaw_rate_limit_rad_s, kPositive, "of the drone");
    field("lag_s", self.lag_s, kPositive, "time constant from a commanded rate to the real one");
    field("shift_per_wind_s", self.shift_per_wind_s, kNotNegative,
          "metres by which 1 m/s of wind across the tether moves the drone");
    field("wind_lag_s", self.wind_lag_s, kPositive, "time constant of that shift");
    field("taut_up_to_wind_m_s", self.taut_up_to_wind_m_s, kNotNegative,
          "wind towards the station against which the drone keeps the tether taut");
  }
};

/// What acts on the drone during a step beside its commands.
struct Disturbance {
  Eigen::Vector3d wind_in_world_m_s = Eigen::Vector3d::Zero();
  double yaw_kick_rad = 0;    ///< by which the step turns the drone, left is +
  double loose_tether_m = 0;  ///< a fault of the reel: so much more is paid out than is stretched
};

enum class TetherStatus { taut, slack_by_wind, slack_by_fault };

/// Truth. The velocity is that of now, by the means over the last two internal steps; the yaw rate
/// is a mean over the last one.
struct DroneTruth {
  RigidTransform world_from_body;    ///< level: Rz(yaw)
  RigidTransform world_from_camera;  ///< gimbal: tilt and roll of the camera do not change
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  double yaw_rate_rad_s = 0;
  TetherState tether;  ///< direction to the drone; the length is what is paid out, taut or not
  TetherStatus tether_status = TetherStatus::taut;
};

/// The plant: a drone that keeps length, elevation and azimuth of its tether in the station's
/// frame, so that it follows the station, and its yaw in the world (its compass is the IMU).
///
/// Each commanded rate, limited, is followed with a first-order lag; both are integrated in closed
/// form over steps of at most 5 ms. Wind shifts the drone across the tether to where thrust and
/// wind balance: a steady wind shifts it for good, until commands move the tether's own direction
/// so far against it. A taut tether does not stretch. A wind towards the station that is stronger
/// than the drone's pull leaves the tether slack, and the drone nearer than the length says.
class TetheredDrone {
 public:
  /// Straight above the station, at rest. `body_from_camera`: the mount on a level body.
  /// Throws InputError where the limits of the length exclude each other or the start.
  TetheredDrone(const TetheredDroneConfig& config, const RigidTransform& body_from_camera,
                const StationState& station, double yaw_rad);

  /// To `duration_s` later, when the station is at `station`; between it moves evenly.
  /// A rate that is no number is none.
  void step(const TetherCommand& command, const Disturbance& disturbance,
            const StationState& station, double duration_s);

  [[nodiscard]] const DroneTruth& truth() const { return truth_; }

 private:
  // What the drone holds, and the rate at which it moves, behind the lag.
  struct Axis {
    double value = 0;
    double rate = 0;
  };
  [[nodiscard]] static Axis follow(const Axis& axis, double command, double lag_s,
                                   double duration_s);
  [[nodiscard]] static Axis stopped_at_ends(const Axis& axis, double low, double high);
  void advance(const TetherCommand& limited, const Eigen::Vector3d& wind, double duration_s);
  void place(double loose_tether_m);
  struct MeanVelocity {
    Eigen::Vector3d in_world_m_s;
    double step_s;
  };
  void remember_mean_velocity(const Eigen::Vector3d& mean_m_s, double step_s);

  TetheredDroneConfig config_;
  RigidTransform body_from_camera_;
  RigidTransform world_from_station_;
  Axis length_;
  Axis elevation_;
  Axis azimuth_;
  Axis yaw_;
  Eigen::Vector3d felt_wind_in_world_m_s_ = Eigen::Vector3d::Zero();
  std::optional<MeanVelocity> mean_velocity_;  // over the last step
  DroneTruth truth_;
};

}  // namespace stillkite
