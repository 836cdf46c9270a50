#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"
#include "simulation/hover/station_path.hpp"

namespace stillkite {

/// Defaults: a small boat between sea states 2 and 3 (WMO code 3700: 0.1 to 0.5 m, 0.5 to 1.25 m).
struct SeaConfig {
  double significant_height_m = 0.5;
  double peak_period_s = 4;
  double towards_deg = 0;
  double boat_length_m = 6;
  double drift_m_s = 0.1;

  static void fields(auto& self, auto&& field) {
    field("significant_height_m", self.significant_height_m, Range{0, 10},
          "significant wave height, four standard deviations of the surface");
    field("peak_period_s", self.peak_period_s, Range{1, 30}, "period at the peak of the spectrum");
    field("towards_deg", self.towards_deg, kAny,
          "mean azimuth of wave propagation, from x towards y");
    field("boat_length_m", self.boat_length_m, kNonNegative, "length of the boat; beam: a third");
    field("drift_m_s", self.drift_m_s, kNonNegative,
          "drift speed of the boat in the direction of the waves");
  }
};

/// Airy wave in deep water: elevation a cos(k . x - w t + phase), |k| = w^2 / g.
struct RegularWave {
  double amplitude_m = 0;
  double angular_frequency_rad_s = 0;
  Eigen::Vector2d wave_vector_rad_m = Eigen::Vector2d::Zero();  ///< k, along the propagation
  double phase_rad = 0;
};

/// 60 waves of equal energy, a^2 / 2 = H^2 / 16 / 60. Their frequencies are equally spaced
/// quantiles of the Bretschneider spectrum (ITTC 1978) S = 5/16 H^2 wp^4 w^-5 exp(-5/4 (wp / w)^4),
/// whose cumulative distribution is exp(-5/4 (wp / w)^4). Phases are random. Directions are random
/// with density 2/pi cos^2 within 90 degrees of the mean (St. Denis and Pierson, 1953).
[[nodiscard]] std::vector<RegularWave> make_waves(const SeaConfig& config, std::uint64_t seed);

/// Rectangle over which a boat averages the waves.
struct Waterplane {
  Eigen::Vector2d ahead_in_world = Eigen::Vector2d::UnitX();
  double length_m = 0;
  double beam_m = 0;
};

/// Motion of the water averaged over a waterplane, relative to still water.
struct WaterMotion {
  Eigen::Vector3d displacement_in_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< surface gradient along world x and y
};

/// Water motion at a moving position: superposition of Airy waves in deep water with circular
/// particle orbits. Averaging over the waterplane scales each wave by
/// sinc(k_ahead length / 2) sinc(k_across beam / 2).
[[nodiscard]] WaterMotion water_motion(const std::vector<RegularWave>& waves,
                                       const Waterplane& waterplane,
                                       const Eigen::Vector2d& position_in_world_m,
                                       const Eigen::Vector2d& position_velocity_in_world_m_s,
                                       double t_s);

/// State of a station on a boat: its path over the water plus waves and drift. The massless boat
/// follows the averaged water surface and its slope, keeps its heading and has no roll dynamics.
/// The sea rises over the first 5 s: at time 0 the boat is level and at rest.
[[nodiscard]] StationState station_on_boat(const StationState& on_land, const SeaConfig& config,
                                           const std::vector<RegularWave>& waves, double t_s);

}  // namespace stillkite
