#pragma once

#include <cstdint>
#include <vector>

#include "estimation/fusion/landmark_filter.hpp"
#include "simulation/flight/trajectory.hpp"
#include "simulation/random.hpp"

namespace stillkite {

/// A patrol at the level of measurements: round and round over landmarks of a map, with a flow that
/// is off as the last-frame flow of docs/benchmarks.md is.
struct PatrolScene {
  double seconds = 3600;
  double height_m = 400;
  double speed_m_s = 10;
  double turn_rate_deg_s = 2.25;  ///< a round of 1.6 km in 160 s
  double tilt_sway_deg = 1.2;     ///< RMS of roll and pitch

  double landmarks_per_km2 = 150;
  double landmark_sigma_m = 1;  ///< an axis, of the map
  double relief_m = 5;          ///< 1 sigma of the landmarks' height
  double pixel_sigma_px = 1;
  double false_ratio = 0.15;    ///< half by a wrong number, half beside the landmark
  double false_within_px = 50;  ///< of those beside it
  int frames_per_sighting = 8;  ///< of 25 a second

  // white, a frame; a camera that looks down takes a turn for a shift of the ground
  double velocity_noise_m_s = 0.088;
  double rate_noise_rad_s = 0.00022;
  double confusion = 0.98;
  // slow, Gauss-Markov
  double velocity_bias_m_s = 0.009;
  double rate_bias_rad_s = 2e-5;
  double bias_correlation_s = 50;

  double start_position_sigma_m = 0.1;
  double start_rotation_sigma_rad = 0.017;
};

class LandmarkFlight {
 public:
  LandmarkFlight(const PatrolScene& scene, std::uint64_t seed);

  /// To the next frame, 1/25 s on.
  void step();

  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] const LandmarkFilter& filter() const { return filter_; }
  [[nodiscard]] const RigidTransform& dead_reckoned() const { return dead_reckoned_; }
  [[nodiscard]] const RigidTransform& truth() const { return truth_; }
  /// (translation, rotation vector) of the true pose from an estimate, world axes.
  [[nodiscard]] Vector6d error_of(const RigidTransform& estimate) const;
  /// NEES of the filter's pose, six degrees of freedom.
  [[nodiscard]] double nees() const;

  struct Sightings {
    int all = 0;
    int used = 0;
    int falsehoods = 0;
    int used_falsehoods = 0;
  };
  [[nodiscard]] const Sightings& sightings() const { return sightings_; }

 private:
  [[nodiscard]] RigidTransform truth_at(double t_s) const;
  [[nodiscard]] std::vector<KnownLandmark> make_map();
  [[nodiscard]] Matrix6d start_covariance() const;
  [[nodiscard]] RigidTransform believed_start();
  void update_from_landmarks();
  [[nodiscard]] Eigen::Vector3d normal3();

  PatrolScene scene_;
  Random random_;
  Trajectory trajectory_;
  Matrix6d flow_covariance_;
  Matrix6d flow_root_;
  Vector6d bias_;
  Vector6d bias_sigma_;
  double time_s_ = 0;
  int frame_ = 0;
  RigidTransform truth_;
  std::vector<Eigen::Vector3d> places_;
  LandmarkFilter filter_;
  RigidTransform dead_reckoned_;
  Sightings sightings_;
};

}  // namespace stillkite
