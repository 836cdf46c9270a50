#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"
#include "simulation/hover/station_path.hpp"

namespace stillkite {

/// The defaults are a small boat between sea state 2 and 3 (WMO code 3700: 0.1 to 0.5 m, 0.5 to
/// 1.25 m).
struct SeaConfig {
  double significant_height_m = 0.5;
  double peak_period_s = 4;
  double towards_deg = 0;
  double boat_length_m = 6;
  double drift_m_s = 0.1;

  static void fields(auto& self, auto&& field) {
    field("significant_height_m", self.significant_height_m, Range{0, 10},
          "of the waves, four deviations of the surface");
    field("peak_period_s", self.peak_period_s, Range{1, 30}, "where the spectrum has its peak");
    field("towards_deg", self.towards_deg, kAny, "where the waves run to, from x towards y");
    field("boat_length_m", self.boat_length_m, kNotNegative, "three times its beam");
    field("drift_m_s", self.drift_m_s, kNotNegative, "of the boat, where the waves run to");
  }
};

/// Small and regular, in deep water: elevation a cos(k . x - w t + phase), |k| = w^2 / g.
struct RegularWave {
  double amplitude_m = 0;
  double angular_frequency_rad_s = 0;
  Eigen::Vector2d wave_vector_rad_m = Eigen::Vector2d::Zero();  ///< k, where it runs to
  double phase_rad = 0;
};

/// 60 waves of the same energy, a^2 / 2 = H^2 / 16 / 60, whose frequencies cut the Bretschneider
/// spectrum (ITTC 1978) S = 5/16 H^2 wp^4 w^-5 exp(-5/4 (wp / w)^4) into equal parts: the share
/// below w is exp(-5/4 (wp / w)^4). Random are the phases and the directions, which spread by
/// 2/pi cos^2 to 90 degrees either side (St. Denis and Pierson, 1953).
[[nodiscard]] std::vector<RegularWave> make_waves(const SeaConfig& config, std::uint64_t seed);

/// The rectangle of water over which a boat averages the waves.
struct Waterplane {
  Eigen::Vector2d ahead_in_world = Eigen::Vector2d::UnitX();
  double length_m = 0;
  double beam_m = 0;
};

/// A boat's share in the water's motion, from its place in still water.
struct WaterMotion {
  Eigen::Vector3d displacement_in_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the surface along the world's x and y
};

/// At a place that itself moves with that velocity: surface, slope and the circles in which deep
/// water goes round (Airy's waves), averaged over the waterplane, of each wave
/// sinc(k_ahead length / 2) sinc(k_across beam / 2).
[[nodiscard]] WaterMotion water_motion(const std::vector<RegularWave>& waves,
                                       const Waterplane& waterplane,
                                       const Eigen::Vector2d& place_in_world_m,
                                       const Eigen::Vector2d& place_velocity_in_world_m_s,
                                       double t_s);

/// The station on a boat: it goes its way over the water, which carries it along. The boat has no
/// mass and no keel: it rides the averaged water, upright on its slope, and keeps its heading; it
/// does not roll of its own. The sea rises over the first 5 s, so that the boat lies upright and at
/// rest at time 0, and drifts from then on.
[[nodiscard]] StationState afloat(const StationState& ashore, const SeaConfig& config,
                                  const std::vector<RegularWave>& waves, double t_s);

}  // namespace stillkite
