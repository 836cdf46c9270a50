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

  /// Station, kicks and faults begin now instead of at time 0, and the trial ends that much later.
  /// Until the first call after `wait` the station is at rest.
  void begin();
  void wait() { begin_step_ = std::nullopt; }

  [[nodiscard]] Timestamp now() const;
  /// Time since the beginning of the trial; 0 before it.
  [[nodiscard]] double trial_s() const;
  [[nodiscard]] bool is_over() const { return begin_step_ && step_ - *begin_step_ > last_step_; }
  [[nodiscard]] const DroneTruth& truth() const { return drone_.truth(); }
  [[nodiscard]] RigidTransform world_from_station() const;
  [[nodiscard]] const std::vector<YawKick>& kicks() const { return kicks_; }
  /// Effect of the fault at the current time.
  [[nodiscard]] FaultEffect fault() const;

  /// Advances by 1/600 s.
  void step(const TetherCommand& command);

 private:
  [[nodiscard]] StationState station(double trial_s) const;

  StationPath path_;
  std::optional<SeaConfig> sea_;
  std::vector<RegularWave> waves_;
  std::optional<FaultConfig> fault_;
  DrydenWind wind_;
  TetheredDrone drone_;
  std::vector<YawKick> kicks_;
  std::int64_t step_ = 0;
  std::optional<std::int64_t> begin_step_ = 0;  // nullopt: waits
  std::int64_t last_step_ = 0;
};

}  // namespace stillkite
