#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/time.hpp"
#include "simulation/hover/fault.hpp"
#include "simulation/hover/hover_config.hpp"
#include "simulation/hover/sea_motion.hpp"
#include "simulation/hover/tethered_drone.hpp"
#include "simulation/hover/wind.hpp"
#include "simulation/hover/yaw_kicks.hpp"

namespace stillkite {

/// One flight of the hold paper's section V.
struct Trial {
  PaperAxis axis = PaperAxis::x;
  bool stabilized = true;
  std::uint64_t seed = 1;
};

/// Duration of the station's motion.
[[nodiscard]] double trial_duration_s(const HoverConfig& config, const Trial& trial);

/// Plant of a trial and its clock: station, sea, wind, disturbances and drone.
class HoverPlant {
 public:
  HoverPlant(const HoverConfig& config, const Trial& trial);

  [[nodiscard]] Timestamp now() const;
  [[nodiscard]] bool is_over() const { return step_ > last_step_; }
  [[nodiscard]] const DroneTruth& truth() const { return drone_.truth(); }
  [[nodiscard]] RigidTransform world_from_station() const;
  [[nodiscard]] const std::vector<YawKick>& kicks() const { return kicks_; }
  /// Effect of the fault at the current time.
  [[nodiscard]] FaultEffect fault() const;

  /// Advances by 1/600 s.
  void step(const TetherCommand& command);

 private:
  [[nodiscard]] StationState station(double t_s) const;

  StationPath path_;
  std::optional<SeaConfig> sea_;
  std::vector<RegularWave> waves_;
  std::optional<FaultConfig> fault_;
  DrydenWind wind_;
  TetheredDrone drone_;
  std::vector<YawKick> kicks_;
  std::int64_t step_ = 0;
  std::int64_t last_step_ = 0;
};

}  // namespace stillkite
