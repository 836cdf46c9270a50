#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "estimation/fusion/error_state.hpp"
#include "estimation/fusion/known_landmark.hpp"
#include "estimation/twist.hpp"
#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

struct LandmarkFilterConfig {
  double velocity_bias_sigma_m_s = 0.009;
  double rate_bias_sigma_rad_s = 2e-5;
  double bias_correlation_s = 50;
  double gate_sigma = 4;
  int most_landmarks = 200;

  static void fields(auto& self, auto&& field) {
    field("velocity_bias_sigma_m_s", self.velocity_bias_sigma_m_s, kNonNegative,
          "dead reckoning's slow error, 1 sigma an axis of the camera");
    field("rate_bias_sigma_rad_s", self.rate_bias_sigma_rad_s, kNonNegative,
          "the same of its angular rate");
    field("bias_correlation_s", self.bias_correlation_s, kPositive, "time for both to change");
    field("gate_sigma", self.gate_sigma, kPositive, "a sighting further off is refused");
    field("most_landmarks", self.most_landmarks, Range{3, 2000}, "that are estimated at a time");
  }
};

/// Corrects a dead-reckoned pose by bearings to landmarks of a map: error-state Kalman filter of
/// the camera's pose, the dead reckoning's bias (Gauss-Markov) and the landmarks seen so far, whose
/// map errors are thus never taken for noise; see docs/landmarks.md.
class LandmarkFilter {
 public:
  /// `covariance` of the start's (translation, rotation vector), world axes, true = exp(e) start.
  /// Throws InputError where a landmark's covariance is not positive definite.
  LandmarkFilter(const LandmarkFilterConfig& config, std::span<const KnownLandmark> map,
                 const RigidTransform& world_from_camera, const Matrix6d& covariance);

  /// Over a frame in which dead reckoning saw that twist: truth, bias and white noise of the given
  /// covariance (of the frame's mean velocity and rate).
  void predict(const Twist& seen_in_camera, const Matrix6d& covariance, double dt_s);
  /// A frame's sightings, all together; what came of each.
  [[nodiscard]] std::vector<SightingVerdict> update(std::span<const LandmarkSighting> sightings);

  [[nodiscard]] const RigidTransform& world_from_camera() const { return state_.camera; }
  /// Of (translation, rotation vector), world axes.
  [[nodiscard]] Matrix6d pose_covariance() const { return P_.topLeftCorner<6, 6>(); }
  /// As the sightings so far have it, where it was seen; else the map's.
  [[nodiscard]] KnownLandmark landmark(int number) const;
  /// How many are estimated now.
  [[nodiscard]] int landmarks() const { return static_cast<int>(members_.size()); }

 private:
  struct State {
    RigidTransform camera;
    Vector6d twist_bias = Vector6d::Zero();
    std::vector<Eigen::Vector3d> landmarks{};  // in the order of members_
  };
  struct Entry {
    KnownLandmark known;
    int slot = -1;          // in members_
    bool is_spent = false;  // left out once: its error is in the pose, but no longer known
    int last_frame = -1;
    std::optional<Innovation<2>> awaiting{};  // its last sighting, before it counts
  };
  struct Joint {  // a frame's innovations together
    Eigen::MatrixXd PHt, S;
    Eigen::VectorXd residual;
  };

  [[nodiscard]] int size() const { return kLandmarks + 3 * landmarks(); }
  [[nodiscard]] Entry& entry(int number) { return map_[static_cast<std::size_t>(number)]; }
  [[nodiscard]] const Entry& entry(int number) const {
    return map_[static_cast<std::size_t>(number)];
  }
  [[nodiscard]] std::optional<Innovation<2>> innovation(const State& at,
                                                        const LandmarkSighting& seen) const;
  [[nodiscard]] SightingVerdict take(const LandmarkSighting& seen);
  void admit(int number);
  void make_room();
  [[nodiscard]] Joint joint(const std::vector<Innovation<2>>& innovations) const;
  [[nodiscard]] State moved(const Eigen::VectorXd& error) const;
  [[nodiscard]] bool correct(const std::vector<LandmarkSighting>& sightings);

  static constexpr int kPosition = 0, kRotation = 3, kBias = 6, kLandmarks = 12;
  LandmarkFilterConfig config_;
  std::vector<Entry> map_;
  std::vector<int> members_;  // numbers of the landmarks that are in the state
  State state_;
  Eigen::MatrixXd P_;
  int frame_ = 0;
};

}  // namespace stillkite
