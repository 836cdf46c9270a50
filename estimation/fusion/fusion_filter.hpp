#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "estimation/fusion/error_state.hpp"
#include "estimation/fusion/fusion_config.hpp"
#include "estimation/fusion/fusion_state.hpp"
#include "estimation/fusion/joint_correction.hpp"
#include "estimation/fusion/landmark_view.hpp"
#include "estimation/fusion/start_smoother.hpp"
#include "estimation/plane/keyframe_view.hpp"

namespace stillkite {

/// What carries the camera on over a short time. Camera axes; the accelerometer is taken to be at
/// the camera.
struct InertialStep {
  double dt_s = 0;
  std::optional<Eigen::Vector3d> angular_rate_rad_s;
  bool is_gyro = true;  ///< the rate has a bias that lasts; else it is another estimator's
  std::optional<Eigen::Vector3d> specific_force_m_s2;
};

/// State and covariance of the errors that are no copies and no landmarks.
struct FusionPrediction {
  static constexpr int kOwn = FusionIndex::kAnchorRotation;
  using OwnMatrix = Eigen::Matrix<double, kOwn, kOwn>;
  FusionState state;
  OwnMatrix covariance;
  OwnMatrix transition;  ///< d(errors) / d(what they were at `FusionFilter::begin_step`)
};

/// Error-state Kalman filter on SO(3) of the camera's pose from the first frame, its velocity, the
/// map's scale, the sensors' biases and landmarks of the reference frame; see docs/fusion.md.
/// Its files: fusion_prediction.cpp (inertia), fusion_keyframe.cpp (the flow's views),
/// fusion_landmarks.cpp and fusion_windows.cpp (a frame's features), fusion_ground.cpp (heights and
/// the scale they tell), fusion_unit.cpp (the map's unit), fusion_anchor.cpp (new and old
/// references), fusion_start.cpp (the start gone through again).
class FusionFilter {
  static constexpr int kOwn = FusionPrediction::kOwn;

 public:
  using OwnMatrix = FusionPrediction::OwnMatrix;

  /// At rest as far as `start.velocity_sigma` says; map units begin as the start's units.
  FusionFilter(const FusionConfig& config, const FusionStart& start);

  /// The camera, here, is where the way of the next frame begins (`step_m`).
  void begin_step();
  void predict(const InertialStep& step);
  /// Errors of the view are alike in so many frames. False: refused.
  bool update_keyframe_view(const KeyframeView& view, double correlated_frames);
  /// The camera, here, is the keyframe of the views to come.
  void take_keyframe();
  /// The ground's, a unit vector down.
  [[nodiscard]] Eigen::Vector3d normal_in_keyframe() const;
  /// The camera's turn since the anchor as another estimator has it; covariance of the rotation
  /// vector, the anchor's axes. False: refused.
  bool update_turn(const Eigen::Quaterniond& anchor_from_camera, const Eigen::Matrix3d& covariance);
  /// The vertical as another sensor has it, any length, in the camera.
  bool update_up(const Eigen::Vector3d& up_in_camera, double sigma_rad);
  /// The camera's height over the ground as another sensor has it, > 0. Where no height was given
  /// at the start the first one lifts the start to where it was. False: refused.
  bool update_height(double height_m, double sigma_m);
  /// The height given at the start, and all metres with it, may be wrong by that share more.
  void doubt_height(double sigma_ratio);

  /// The camera, here, is the anchor of landmarks to come. Of those at hand that are seen from here
  /// the depth is kept; until they are numbered nothing is taken for them.
  void take_anchor();
  /// Landmarks without a number are those features of the new reference that lie nearest, within
  /// `most_beside` on z = 1; what finds none is dropped.
  void number_landmarks(std::span<const FeatureView> reference, double most_beside);
  [[nodiscard]] FusionMap map() const;
  /// That map's anchor and landmarks instead of those at hand. What the camera has seen since it
  /// was left is taken to tell nothing of them.
  void restore(const FusionMap& map);
  /// A feature of the reference frame, as the anchor sees it, and where it is seen now: from far
  /// enough that tells its depth. Beyond `FusionConfig::landmarks` it is a spare one.
  void add_landmark(const FeatureView& reference, const std::optional<Eigen::Vector2d>& seen = {});
  /// A feature of the first reference that may take the place of a landmark once the start is gone
  /// through again.
  void offer_landmark(const FeatureView& reference);
  /// What was told of it may be wrong: it is not gone through again.
  void forget_start() { start_.forget(); }
  /// No landmark of this anchor any more.
  void give_up(int feature);
  /// A frame's features. Those that are no landmarks, behind the camera or refused are left out;
  /// gives how many were not. A landmark that is refused too often in a row goes, and the unit is
  /// settled. From the 16th and the 32nd frame under the first reference on, and from the 64th and
  /// 128th where these did not suffice, some take several times as long: all that was told is gone
  /// through again (`FusionConfig::relinearize_start`).
  int update_landmarks(std::span<const FeatureView> seen);
  /// The same, but linearised about these landmarks and these poses. Views that are off from there
  /// by more than the gate are left out.
  void update_landmarks_about(const StartLandmarks& about, const RigidTransform& world_from_anchor,
                              const RigidTransform& world_from_camera,
                              std::span<const FeatureView> seen);
  /// Landmarks that lie on the ground, whose height is known: they tell the scale, each once. All
  /// that lie below the camera do where the ground `is_flat`; else those of the lowest level whose
  /// depth has shown. Gives how many are new.
  int update_ground(bool is_flat);
  /// Of the landmarks below the camera whose heights are known, ten or more, a fourth lie off their
  /// median's by a tenth and three sigma.
  [[nodiscard]] bool shows_relief() const;
  /// The map unit becomes the one in which the depths as a whole have no error: what they are all
  /// wrong by is the scale's error from now on, which no view touches. Metres are as before.
  void settle_unit();
  /// Those that 15 frames in a row have not shown; the spare ones alone where the others are to
  /// be met again.
  void drop_unseen(bool keep_first);

  /// Whether half of what is seen of a map's landmarks, or more, is within so many standard
  /// deviations of where a camera there, in metres, with that covariance (translation, rotation
  /// vector; world axes) would see them; also where none of them is seen.
  [[nodiscard]] bool may_be_seen(const FusionMap& map, std::span<const FeatureView> seen,
                                 const RigidTransform& world_from_camera_m,
                                 const Matrix6d& covariance, double sigmas) const;

  [[nodiscard]] const FusionState& state() const { return state_; }
  [[nodiscard]] const std::vector<Landmark>& landmarks() const { return landmarks_; }
  /// Features of the anchor that are to be no landmarks: the gate refused them too often, or they
  /// strayed in the start.
  [[nodiscard]] const std::vector<int>& dropped() const { return dropped_; }
  /// Metres.
  [[nodiscard]] RigidTransform world_from_camera_m() const;
  [[nodiscard]] const Eigen::Vector3d& start_m() const { return start_m_; }
  /// Of the camera over the ground; of its logarithm the variance.
  [[nodiscard]] double height_m() const;
  [[nodiscard]] double log_height_variance() const;
  [[nodiscard]] Eigen::Vector3d velocity_in_world_m_s() const;
  /// The way since `begin_step`, metres, world axes; its covariance as the camera sees it, with the
  /// error of its attitude.
  [[nodiscard]] Eigen::Vector3d step_m() const;
  [[nodiscard]] Eigen::Matrix3d step_covariance() const;
  /// Of (translation in m, rotation vector), world axes, from the first frame.
  [[nodiscard]] Matrix6d pose_covariance() const;
  /// By the least turn about the first frame's place to where the vertical is z; metres.
  [[nodiscard]] RigidTransform aligned_from_world() const;
  /// The same of the pose in that upright world, in its axes, with the vertical's error.
  [[nodiscard]] Matrix6d upright_pose_covariance() const;
  /// (m/s)^2, world axes.
  [[nodiscard]] Eigen::Matrix3d velocity_covariance() const;
  /// Metres; the covariance of (translation, rotation vector) in the anchor's axes.
  [[nodiscard]] RigidTransform anchor_from_camera_m() const;
  [[nodiscard]] Matrix6d anchored_covariance() const;
  /// Since `begin_step`: the camera is not where its speed has carried it, and `step_m` is no way.
  [[nodiscard]] bool has_leapt() const { return has_leapt_; }
  /// (rad/s)^2, camera axes.
  [[nodiscard]] Eigen::Matrix3d gyro_bias_covariance() const {
    return P_.block<3, 3>(FusionIndex::kGyroBias, FusionIndex::kGyroBias);
  }
  /// Of the logarithm of the scale: a share of every length.
  [[nodiscard]] double scale_sigma() const;
  /// Of the vertical, about the axis of which less is known.
  [[nodiscard]] double up_sigma_rad() const;
  /// Of the errors before the anchor's (FusionIndex).
  [[nodiscard]] OwnMatrix own_covariance() const { return P_.topLeftCorner<kOwn, kOwn>(); }
  /// Of the last step, before anything corrected it.
  [[nodiscard]] const FusionPrediction& prediction() const { return prediction_; }

 private:
  // d(rotation, position, velocity) by the errors before, and what noise adds to them
  using Transition = Eigen::Matrix<double, 9, FusionIndex::kAnchorRotation>;
  using Matrix9d = Eigen::Matrix<double, 9, 9>;
  using PoseRows = Eigen::Matrix<double, 6, FusionIndex::kLandmarks>;
  // 1. State and covariance.
  [[nodiscard]] int size() const;
  Eigen::Vector3d counted_gain(const Eigen::Vector3d& gain_m_s, double dt_s);
  void propagate(const Transition& F, const Matrix9d& noise, double dt_s);
  template <int kRows>
  bool correct(const Innovation<kRows>& innovation);
  void inject(const Eigen::VectorXd& error);
  void clone(int original, int count, int copy);
  void change_unit(double ratio);
  [[nodiscard]] Eigen::VectorXd ways() const;
  void add_scale_error(const Eigen::VectorXd& times);
  [[nodiscard]] Eigen::Matrix3d displacement_covariance() const;
  [[nodiscard]] PoseRows pose_rows() const;
  // 2. Which landmarks there are.
  [[nodiscard]] int most_landmarks() const { return config_.landmarks * 3 / 2; }
  [[nodiscard]] bool needs_guesses() const;
  [[nodiscard]] std::optional<std::size_t> landmark_of(int feature) const;
  void drop_refused();
  void remove_landmark(std::size_t i);
  // 3. A frame's views of them.
  [[nodiscard]] std::vector<LandmarkView> landmark_views(std::span<const FeatureView> seen) const;
  void age_windows(std::span<const FeatureView> seen);
  void blame_strays(const std::vector<LandmarkView>& views);
  [[nodiscard]] bool is_within_gate(const LandmarkView& view) const;
  void doubt_gyro(int sign);
  void inflate_position_covariance(int sign);
  bool correct_by(std::vector<LandmarkView>& views);
  [[nodiscard]] std::optional<JointCorrection> agreeing(std::vector<LandmarkView>& views) const;
  void count_refusals(const std::vector<LandmarkView>& all,
                      const std::vector<LandmarkView>& agreed);
  // 4. Ground and start.
  [[nodiscard]] double height(const Eigen::Vector3d& position) const;
  [[nodiscard]] SparseRows<1> log_height_row() const;
  void add_height_variance(double variance);
  [[nodiscard]] std::optional<Innovation<1>> ground_innovation(const Landmark& landmark,
                                                               int column) const;
  [[nodiscard]] bool has_outgrown_its_scale() const;
  void forget_scale();
  void update_keyframe_tilt(const KeyframeView& view, double correlated_frames);
  void adopt(const FusionFilter& again);

  FusionConfig config_;
  StartSmoother start_;
  FusionState state_;
  Eigen::Vector3d start_in_world_;  // map units
  Eigen::Vector3d start_m_;
  bool is_height_given_;
  bool is_height_read_ = false;             // by another sensor, since
  std::optional<double> told_scale_sigma_;  // just after the ground had told it for the first time
  bool is_first_map_ = true;                // its lengths are what the scale is of
  std::vector<Landmark> landmarks_;
  std::vector<int> dropped_;
  FusionPrediction prediction_;
  // since `begin_step`
  double step_s_ = 0;
  double gyro_s_ = 0;  // of it, carried by the gyroscope
  bool has_accel_ = false;
  bool has_leapt_ = false;
  Eigen::MatrixXd P_;  // its leading size() rows and columns are in use
};

}  // namespace stillkite
