#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "geometry/fields.hpp"
#include "simulation/random.hpp"

namespace stillkite {

struct WindConfig {
  double mean_m_s = 0;
  double towards_deg = 0;
  double height_m = 3;
  bool gusts = true;

  static void fields(auto& self, auto&& field) {
    field("mean_m_s", self.mean_m_s, Range{0, 30},
          "mean wind at 6 m over the ground; 0: still air");
    field("towards_deg", self.towards_deg, kAny, "azimuth of the wind vector, from x towards y");
    field("height_m", self.height_m, Range{3, 300}, "height over the ground for the gust scales");
    field("gusts", self.gusts, "add Dryden turbulence to the mean wind");
  }
};

/// Gust scales along the wind, across it, and upwards.
struct GustScales {
  Eigen::Vector3d deviation_m_s;  ///< standard deviations
  Eigen::Vector3d time_s;         ///< turbulence length / mean wind
};

/// MIL-F-8785C at low altitude, h and L in feet: L_w = h, L_u = L_v = h / (0.177 + 0.000823 h)^1.2,
/// sigma_w = 0.1 W, sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4, W the mean wind at 20
/// ft. A hovering drone meets the turbulence at the mean wind speed.
[[nodiscard]] GustScales dryden_scales(const WindConfig& config);

/// Mean wind with Dryden gusts: white noise through sigma sqrt(2 T) / (1 + T s) along the wind and
/// sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2 across it and upwards. Discretisation is exact:
/// correlations are exp(-t/T) and exp(-t/T) (1 - t/2T) for any step. The initial state is drawn
/// from the stationary distribution.
class DrydenWind {
 public:
  DrydenWind(const WindConfig& config, std::uint64_t seed);

  [[nodiscard]] Eigen::Vector3d in_world_m_s() const;
  /// Advances by `duration_s`.
  void step(double duration_s);

 private:
  Eigen::Vector3d mean_in_world_m_s_;
  Eigen::Matrix3d world_from_wind_;  // wind frame: x along the wind, y left, z up
  bool gusts_;
  GustScales scales_;
  Random random_;
  double along_m_s_ = 0;
  // across and upwards: x1' = -x1 / T + x2, x2' = -x2 / T + noise
  Eigen::Vector2d across_;
  Eigen::Vector2d upwards_;
};

}  // namespace stillkite
