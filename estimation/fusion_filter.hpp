#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "estimation/error_state.hpp"
#include "estimation/fusion_config.hpp"
#include "estimation/fusion_state.hpp"
#include "estimation/keyframe_view.hpp"

namespace stillkite {

/// What carries the camera on over a short time. Camera axes; the accelerometer is taken to be at
/// the camera.
struct InertialStep {
  double dt_s = 0;
  std::optional<Eigen::Vector3d> angular_rate_rad_s;
  bool is_gyro = true;  ///< the rate has a bias that lasts; else it is another estimator's
  std::optional<Eigen::Vector3d> specific_force_m_s2;
};

/// What is known of the first frame.
struct FusionStart {
  RigidTransform world_from_camera;  ///< z is the height over the ground
  double velocity_sigma = 0;         ///< units/s
  /// Of the logarithm of that pose's unit in metres. 0: it is metres.
  double log_unit_sigma = 0;
};

/// Where a feature is seen, on z = 1.
struct FeatureView {
  int feature = 0;  ///< its number in the reference
  Eigen::Vector2d bearing;
  Eigen::Matrix2d covariance;
};

/// Error-state Kalman filter on SO(3) of the camera's pose from the first frame, its velocity, the
/// map's scale, the sensors' biases and landmarks of the reference frame; see docs/fusion.md.
class FusionFilter {
 public:
  /// At rest as far as `start.velocity_sigma` says; map units begin as the start's units.
  FusionFilter(const FusionConfig& config, const FusionStart& start);

  /// The camera, here, is where the way of the next frame begins (`step_m`).
  void begin_step();
  void predict(const InertialStep& step);
  /// Errors of the view are alike in so many frames. False: refused.
  bool update_keyframe_view(const KeyframeView& view, double correlated_frames);
  /// The camera, here, is the keyframe of the views to come.
  void take_keyframe();
  /// The camera's turn since the anchor as another estimator has it; covariance of the rotation
  /// vector, the anchor's axes. False: refused.
  bool update_turn(const Eigen::Quaterniond& anchor_from_camera, const Eigen::Matrix3d& covariance);
  /// The vertical as another sensor has it, any length, in the camera.
  bool update_up(const Eigen::Vector3d& up_in_camera);
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
  /// A frame's features. Those that are no landmarks, behind the camera or refused are left out;
  /// gives how many were not. A landmark that is refused too often in a row goes, and the unit is
  /// settled. From the 20th and the 40th frame under the first reference on some take several
  /// times as long: all that was told is gone through again (`FusionConfig::relinearize_start`).
  int update_landmarks(std::span<const FeatureView> seen);
  /// Landmarks that lie on the ground, whose height is known: they tell the scale, each once. All
  /// that lie below the camera do where the ground `is_flat`; else those of the lowest level whose
  /// depth has shown. Gives how many are new.
  int update_ground(bool is_flat);
  /// The map unit becomes the one in which the depths as a whole have no error: what they are all
  /// wrong by is the scale's error from now on, which no view touches. Metres are as before.
  void settle_unit();
  /// Those that no frame has shown for half a second; the spare ones alone where the others are to
  /// be met again.
  void drop_unseen(bool keep_first);

  [[nodiscard]] const FusionState& state() const { return state_; }
  [[nodiscard]] const std::vector<Landmark>& landmarks() const { return landmarks_; }
  /// Features of the anchor that were landmarks until the gate refused them too often.
  [[nodiscard]] const std::vector<int>& dropped() const { return dropped_; }
  /// Metres.
  [[nodiscard]] RigidTransform world_from_camera_m() const;
  [[nodiscard]] Eigen::Vector3d velocity_in_world_m_s() const;
  /// The way since `begin_step`, world axes; its covariance as the camera sees it, with the error
  /// of its attitude.
  [[nodiscard]] Eigen::Vector3d step_m() const;
  [[nodiscard]] Eigen::Matrix3d step_covariance() const;
  /// Of (translation in m, rotation vector), world axes, from the first frame.
  [[nodiscard]] Matrix6d pose_covariance() const;
  [[nodiscard]] Eigen::Matrix3d velocity_covariance() const;
  /// Metres; the covariance of (translation, rotation vector) in the anchor's axes.
  [[nodiscard]] RigidTransform anchor_from_camera_m() const;
  [[nodiscard]] Matrix6d anchored_covariance() const;
  /// (rad/s)^2, camera axes.
  [[nodiscard]] Eigen::Matrix3d gyro_bias_covariance() const {
    return P_.block<3, 3>(FusionIndex::kGyroBias, FusionIndex::kGyroBias);
  }
  /// Of the logarithm of the scale: a share of every length.
  [[nodiscard]] double scale_sigma() const;

 private:
  // d(rotation, position, velocity) by the errors before, and what noise adds to them
  using Transition = Eigen::Matrix<double, 9, FusionIndex::kAnchorRotation>;
  using Matrix9d = Eigen::Matrix<double, 9, 9>;
  // of the errors that are no copies and no landmarks
  static constexpr int kOwn = FusionIndex::kAnchorRotation;
  using OwnMatrix = Eigen::Matrix<double, kOwn, kOwn>;
  using OwnVector = Eigen::Matrix<double, kOwn, 1>;
  struct LandmarkView {
    std::size_t landmark;
    Eigen::Vector2d bearing;
    Eigen::Matrix2d covariance;
    Eigen::Matrix2d usual_covariance;  // were it no stray
  };
  // what views are off by once corrected, per degree of freedom, and what is usual
  struct ViewErrors {
    std::vector<double> squared;
    double usual = 0;
  };
  // what is to be added, A with A A^T to be taken off P, and what the views were off by
  struct JointCorrection {
    Eigen::VectorXd error;
    Eigen::MatrixXd A_t;
    Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> S;
    Eigen::VectorXd residual;
    double squared = 0;  // the residual, by S
  };
  // below the anchor by its height, map units
  struct LowLandmark {
    std::size_t landmark = 0;
    double height = 0;
    double sigma_ratio = 0;  // against the one that is known best, as a share
    [[nodiscard]] bool is_known() const { return sigma_ratio <= 0.05; }
  };
  // what the filter was told up to a frame, and what it believed of that frame
  struct ToldFrame {
    std::vector<std::function<void(FusionFilter&)>> told;
    std::vector<FeatureView> seen;
  };
  // what a start is gone through again about
  struct StartLandmark {
    double inverse_depth = 0;
    RunningRatio stray;
  };
  using StartLandmarks = std::map<int, StartLandmark>;  // by features
  using StartWay = std::vector<RigidTransform>;         // world from camera, a frame each
  struct Retold;
  struct StartPasses;
  struct Resection {
    RigidTransform world_from_camera;
    Matrix6d information;  // of (rotation, position)
  };
  // of the ground's normal from that of a keyframe's view, about its tilt axes
  struct KeyframeTilt {
    Eigen::Vector2d tilt_rad;
    Eigen::Matrix<double, 2, 3> by_keyframe_rotation;
    Eigen::Matrix2d by_tilt;
  };
  // landmarks as they would be with the camera for their anchor, and their inverse depths'
  // covariances with the state and with each other
  struct InheritedDepths {
    std::vector<Landmark> landmarks;
    Eigen::MatrixXd with_state;
    Eigen::MatrixXd covariance;
  };
  [[nodiscard]] InheritedDepths depths_from_camera() const;
  void propagate(const Transition& F, const Matrix9d& noise, double dt_s);
  template <int kRows>
  bool correct(const Innovation<kRows>& innovation);
  [[nodiscard]] bool is_within_gate(const LandmarkView& view) const;
  [[nodiscard]] std::size_t count_refused(const std::vector<LandmarkView>& views) const;
  void doubt_gyro_where_it_is_contradicted(const std::vector<LandmarkView>& views);
  void doubt_gyro(double variance);
  void inject(const Eigen::VectorXd& error);
  [[nodiscard]] std::optional<std::size_t> landmark_of(int feature) const;
  [[nodiscard]] double window_growth(const Landmark& landmark) const;
  void age_windows(std::span<const FeatureView> seen);
  [[nodiscard]] std::vector<LandmarkView> landmark_views(std::span<const FeatureView> seen) const;
  void refuse_strays(std::vector<LandmarkView>& views);
  [[nodiscard]] double stray_growth(const Landmark& landmark) const;
  [[nodiscard]] ViewErrors view_errors(const std::vector<LandmarkView>& views) const;
  void blame_strays(const std::vector<LandmarkView>& views);
  [[nodiscard]] std::optional<JointCorrection> joint_correction(
      const std::vector<LandmarkView>& views, const Eigen::VectorXd& offset) const;
  [[nodiscard]] std::optional<JointCorrection> joint_correction(
      const std::vector<LandmarkView>& views);
  [[nodiscard]] std::optional<std::size_t> stray_among(const JointCorrection& views) const;
  bool correct_jointly(std::vector<LandmarkView>& views);
  void remember(std::function<void(FusionFilter&)> told);
  void close_frame(std::span<const FeatureView> seen, const std::vector<LandmarkView>& believed);
  void forget_start();
  void begin_passes(std::size_t frames);
  void relinearize_start();
  [[nodiscard]] StartPasses passes_about(const std::vector<Landmark>& landmarks,
                                         std::size_t frames) const;
  [[nodiscard]] bool retell(StartPasses& passes, std::size_t frames, std::size_t& left) const;
  void judge(StartPasses& passes) const;
  void retell_views(std::span<const FeatureView> seen, const RigidTransform* world_from_camera,
                    StartLandmarks& about, Retold& again);
  [[nodiscard]] StartWay smoothed_way(const std::vector<Landmark>& landmarks,
                                      std::size_t frames) const;
  bool correct_pose(const Resection& seen_from);
  [[nodiscard]] std::optional<Resection> resection(std::span<const FeatureView> seen,
                                                   const std::vector<Landmark>& landmarks) const;
  void adopt(const FusionFilter& again);
  [[nodiscard]] int size() const;
  [[nodiscard]] static int column_of(std::size_t landmark) {
    return FusionIndex::kLandmarks + 3 * static_cast<int>(landmark);
  }
  void drop_refused();
  void remove_landmark(std::size_t i);
  void change_unit(double ratio);
  [[nodiscard]] std::optional<Eigen::VectorXd> unit_of_depths() const;
  [[nodiscard]] std::vector<LowLandmark> landmarks_below() const;
  [[nodiscard]] static std::optional<double> ground_level(const std::vector<LowLandmark>& below);
  void doubt_level(const std::vector<LowLandmark>& on_level);
  [[nodiscard]] SparseRows<1> height_row(const Landmark& landmark, int column, double factor) const;
  [[nodiscard]] Innovation<1> ground_innovation(const Landmark& landmark, int column) const;
  [[nodiscard]] KeyframeTilt keyframe_tilt(const KeyframeView& view) const;
  void update_keyframe_tilt(const KeyframeView& view, double correlated_frames);
  void clone(int original, int count, int copy);
  [[nodiscard]] double height_below_anchor(const Landmark& landmark) const;
  [[nodiscard]] double height(const Eigen::Vector3d& position) const;
  [[nodiscard]] double guessed_inverse_depth(const Eigen::Vector2d& bearing) const;
  [[nodiscard]] std::optional<double> triangulated_inverse_depth(const FeatureView& reference,
                                                                 const Eigen::Vector2d& seen,
                                                                 double guess) const;
  [[nodiscard]] bool needs_guesses() const;
  [[nodiscard]] int most_landmarks() const { return config_.landmarks * 3 / 2; }
  [[nodiscard]] Eigen::Matrix3d way_covariance() const;
  [[nodiscard]] Eigen::Matrix3d metric_covariance(int first, const Eigen::Vector3d& value) const;

  FusionConfig config_;
  FusionStart start_;
  FusionState state_;
  Eigen::Vector3d start_in_world_;  // map units
  Eigen::Vector3d start_m_;
  bool is_height_given_;
  bool is_first_map_ = true;  // its lengths are what the scale is of
  std::vector<Landmark> landmarks_;
  std::vector<int> dropped_;
  // since the start, the last frame still open; empty: forgotten
  std::vector<ToldFrame> told_;
  std::vector<StartPasses> passes_;  // while the start is gone through again
  std::size_t passes_frames_ = 0;    // so much of it
  // d(own errors) by those after the frame before
  OwnMatrix since_frame_ = OwnMatrix::Identity();
  double gyro_s_ = 0;  // that the gyroscope has carried the camera since `begin_step`
  Eigen::MatrixXd P_;  // its leading size() rows and columns are in use
};

// told the same again, up to a frame
struct FusionFilter::Retold {
  FusionFilter filter;
  std::size_t frames = 0;
  double cost = 0;
  std::map<int, RunningRatio> strays = {};
};

struct FusionFilter::StartPasses {
  StartLandmarks about = {};
  StartWay way = {};  // that goes with these depths; empty: each frame's resection
  int weighings = 0;
  int done = 0;
  bool is_settled = false;
  bool is_last = false;              // then it takes the place of what is at hand
  std::optional<Retold> begun = {};  // the pass at hand, if there is one
  // what the last one told: of the views -2 log likelihood, but for what all starts share
  double cost = HUGE_VAL;
  std::vector<Landmark> landmarks = {};
  // among starts, without weights
  [[nodiscard]] bool is_search() const { return weighings == 0; }
};

}  // namespace stillkite
