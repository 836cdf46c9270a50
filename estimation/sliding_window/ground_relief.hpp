#pragma once

namespace stillkite {

/// Height of a point above the ground by images alone.
struct PointHeight {
  double height_m = 0;
  double variance_m2 = 0;
};

/// Distribution of the points' heights above the ground plane: normal for a share of them, those
/// that are on the ground, and with the camera's height as standard deviation for the others. Both
/// numbers are estimated by expectation maximization (Dempster, Laird, Rubin 1977), the variance by
/// Fisher scoring: points whose images do not show their height do not change it.
class GroundRelief {
 public:
  explicit GroundRelief(double camera_height_m);

  /// Standard deviation of the ground's points.
  [[nodiscard]] double sigma_m() const { return sigma_m_; }
  /// Part of the points that are on the ground.
  [[nodiscard]] double share() const { return share_; }
  /// Relief far below the camera's height.
  [[nodiscard]] bool is_plane() const;
  /// Relief above that of a plane by two standard deviations.
  [[nodiscard]] bool is_rough() const;
  /// Probability that a point is on the ground.
  [[nodiscard]] double probability(const PointHeight& point) const;

  /// A point that is measured; it counts until the next `begin_update`.
  void add(const PointHeight& point);
  void begin_update() { present_ = {}; }
  /// New sigma and share.
  void update();
  /// A point that leaves: counts from now on.
  void keep(const PointHeight& point);

 private:
  struct Sums {
    double probability = 0;
    double points = 0;
    double excess = 0;       // of squared heights above their variances, weighted
    double information = 0;  // of the variance
  };
  void add(const PointHeight& point, Sums& sums) const;

  double spread_m_;  // of the points that are not on the ground
  double sigma_m_;
  double share_;
  double variance_sigma_m2_;  // standard deviation of the variance
  Sums kept_;
  Sums present_;
};

}  // namespace stillkite
