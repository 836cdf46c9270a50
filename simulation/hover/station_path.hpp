#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Axes as in the hold paper: y is up, x and z are horizontal.
enum class PaperAxis { x, y, z };

template <>
struct EnumNames<PaperAxis> {
  static constexpr auto value = std::to_array<std::pair<PaperAxis, std::string_view>>(
      {{PaperAxis::x, "x"}, {PaperAxis::y, "y"}, {PaperAxis::z, "z"}});
};

/// Unit vector of the paper's axis in the world frame (z up): x, z, -y; both are right-handed.
[[nodiscard]] Eigen::Vector3d paper_axis_in_world(PaperAxis axis);

struct StationPathConfig {
  double level_reach_m = 2;
  double vertical_reach_m = 0.87;  // not in the paper; fits the 43 cm of Table I
  double speed_m_s = 0.2;
  double acceleration_m_s2 = 0.2;
  double height_m = 1;

  static void fields(auto& self, auto&& field) {
    field("level_reach_m", self.level_reach_m, kPositive,
          "maximum displacement along a horizontal axis, x or z");
    field("vertical_reach_m", self.vertical_reach_m, kPositive,
          "maximum displacement along the vertical axis, y");
    field("speed_m_s", self.speed_m_s, kPositive, "cruise speed");
    field("acceleration_m_s2", self.acceleration_m_s2, kPositive,
          "acceleration at the start, the reversals and the end");
    field("height_m", self.height_m, kNonNegative, "initial height of the station over the floor");
  }
};

struct StationState {
  RigidTransform world_from_station;
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
};

/// Path of the ground station in a trial (hold paper, section V): from the initial position to
/// +reach along an axis, to -reach, and back.
class StationPath {
 public:
  StationPath(const StationPathConfig& config, PaperAxis moved);

  /// State at `t_s`; at rest over the world origin before time 0 and after the end. The station's x
  /// axis is the moved axis, or the world's x axis if the moved axis is up.
  [[nodiscard]] StationState at(double t_s) const;

  [[nodiscard]] double duration_s() const;

 private:
  // Rest-to-rest motion with a trapezoidal speed profile.
  struct Leg {
    double displacement_m = 0;  // signed
    double ramp_s = 0;
    double steady_s = 0;

    [[nodiscard]] double duration_s() const { return 2 * ramp_s + steady_s; }
  };
  struct LineState {
    double position_m = 0;
    double velocity_m_s = 0;
  };

  [[nodiscard]] Leg leg_over(double displacement_m) const;
  [[nodiscard]] LineState state_on_leg(const Leg& leg, double t_s) const;
  [[nodiscard]] LineState state_on_line(double t_s) const;

  StationPathConfig config_;
  PaperAxis moved_;
  std::array<Leg, 3> legs_;
};

}  // namespace stillkite
