#pragma once

#include <array>

#include "estimation/ego_motion/motion_filter.hpp"

namespace stillkite {

/// Interacting multiple models of a camera's motion (Blom and Bar-Shalom 1988; Bar-Shalom et al.
/// 2001, section 11.6.6): MotionFilters of different acceleration density and measurement noise,
/// weighted by the likelihood of their innovations. An alignment's covariance lacks errors that are
/// common to its image, such as those of video coding: they appear as a larger measurement noise.
///
/// The weights consider the measured position given the measured rotation: an image measures the
/// rotation far better than the motion model predicts it, so its innovation shows the angular
/// acceleration only.
class MultipleModelFilter {
 public:
  explicit MultipleModelFilter(const MotionFilterConfig& config);

  /// As the functions of MotionFilter, for each model.
  void initialize(const RigidTransform& pose, double velocity_sigma_m_s, double rate_sigma_rad_s);
  void predict(double dt_s);
  void update(const RigidTransform& measured_pose, const Matrix6d& covariance,
              const Twist& assumed_twist, const Matrix6d& pose_by_twist);
  void update_rate(const Eigen::Vector3d& measured_rate_rad_s, const Eigen::Matrix3d& covariance);
  void set_pose_as_origin();
  void inflate_position_covariance(double sigma_m);
  void reset_twist(double velocity_sigma_m_s, double rate_sigma_rad_s);
  void transform_world(const RigidTransform& change);
  void rescale_world(double factor);

  /// Mean and covariance over the models.
  [[nodiscard]] const RigidTransform& pose() const { return mixture_.pose; }
  [[nodiscard]] Matrix6d pose_covariance() const {
    return mixture_.covariance.topLeftCorner<6, 6>();
  }
  [[nodiscard]] Twist twist_in_camera() const;
  [[nodiscard]] Matrix6d twist_covariance() const;
  [[nodiscard]] Twist mean_twist_in_camera() const;
  [[nodiscard]] Matrix6d mean_twist_covariance() const;

  /// Estimated ratio of the measurements' variance to the given covariance, 1 or more.
  [[nodiscard]] double noise_variance_ratio() const;

  /// The motion may have changed: the largest acceleration density gets at least the probability
  /// that it has after a change of the model.
  void allow_acceleration();

  /// Log-likelihood of a measured position, without its constant. The covariance of a discontinuity
  /// is not subject to the noise ratio.
  [[nodiscard]] double position_log_likelihood(const Eigen::Vector3d& position,
                                               const Eigen::Matrix3d& covariance,
                                               double discontinuity_sigma_m) const;

 private:
  struct Model {
    MotionFilter filter{MotionFilterConfig{}};
    double noise_variance_ratio = 1;
    double probability = 0;
  };
  static constexpr std::size_t kModels = 9;
  using Weights = std::array<double, kModels>;

  [[nodiscard]] Weights probabilities() const;
  [[nodiscard]] MotionFilter::State mix(const Weights& weights) const;
  void weight(const Weights& log_likelihoods);
  void for_each_filter(auto&& apply);

  std::array<Model, kModels> models_;
  MotionFilter::State mixture_;
};

}  // namespace stillkite
