#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Axes as the hold paper names them: y is up, x and z are level.
enum class PaperAxis { x, y, z };

template <>
struct EnumNames<PaperAxis> {
  static constexpr auto value = std::to_array<std::pair<PaperAxis, std::string_view>>(
      {{PaperAxis::x, "x"}, {PaperAxis::y, "y"}, {PaperAxis::z, "z"}});
};

/// Unit vector of the paper's axis in our world (z up): x, z and -y, so that both are right-handed.
[[nodiscard]] Eigen::Vector3d paper_axis_in_world(PaperAxis axis);

/// Of the ground station's way in a trial.
struct StationPathConfig {
  double level_reach_m = 2;
  double upright_reach_m = 0.87;  // the paper gives none: this one fits Table I's 43 cm
  double speed_m_s = 0.2;
  double acceleration_m_s2 = 0.2;
  double height_m = 1;

  static void fields(auto& self, auto&& field) {
    field("level_reach_m", self.level_reach_m, kPositive, "way out from the start along x or z");
    field("upright_reach_m", self.upright_reach_m, kPositive, "way out from the start along y");
    field("speed_m_s", self.speed_m_s, kPositive, "between the turns");
    field("acceleration_m_s2", self.acceleration_m_s2, kPositive, "at the start, turns and end");
    field("height_m", self.height_m, kNotNegative, "of the station over the floor at the start");
  }
};

struct StationState {
  RigidTransform world_from_station;
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
};

/// The way of the ground station in a trial (hold paper, section V): out along an axis, back
/// through the start, as far the other way, and back to the start.
class StationPath {
 public:
  StationPath(const StationPathConfig& config, PaperAxis moved);

  /// Over the world's origin at time 0 and before, and again from the end on. The station's x
  /// points along the moved axis (along the world's x where that is up).
  [[nodiscard]] StationState at(double t_s) const;

  [[nodiscard]] double duration_s() const;

 private:
  // From rest to rest: up to speed, steady, down to rest.
  struct Leg {
    double way_m = 0;  // signed
    double ramp_s = 0;
    double steady_s = 0;

    [[nodiscard]] double duration_s() const { return 2 * ramp_s + steady_s; }
  };
  struct PlaceOnLine {
    double position_m = 0;
    double velocity_m_s = 0;
  };

  [[nodiscard]] Leg leg_over(double way_m) const;
  [[nodiscard]] PlaceOnLine place_on(const Leg& leg, double t_s) const;
  [[nodiscard]] PlaceOnLine place_at(double t_s) const;

  StationPathConfig config_;
  PaperAxis moved_;
  std::array<Leg, 3> legs_;
};

}  // namespace stillkite
