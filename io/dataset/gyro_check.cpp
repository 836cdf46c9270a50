#include "io/dataset/gyro_check.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Where the gyroscope has turned to, as the sum of what it told.
class GyroSum {
 public:
  explicit GyroSum(const TimeSeries<Vector3d>& gyro)
      : stamps_(gyro.stamps), sums_rad_(stamps_.size(), Vector3d::Zero()) {
    for (std::size_t i = 1; i < stamps_.size(); ++i) {
      sums_rad_[i] =
          sums_rad_[i - 1] + seconds_between(stamps_[i - 1], stamps_[i]) * gyro.values[i];
    }
  }

  // Nothing outside the log.
  [[nodiscard]] std::optional<Vector3d> at(Timestamp stamp) const {
    const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
    if (after == stamps_.end() || after == stamps_.begin()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - stamps_.begin());
    const double share =
        seconds_between(stamps_[i - 1], stamp) / seconds_between(stamps_[i - 1], stamps_[i]);
    return Vector3d(sums_rad_[i - 1] + share * (sums_rad_[i] - sums_rad_[i - 1]));
  }

 private:
  const std::vector<Timestamp>& stamps_;
  std::vector<Vector3d> sums_rad_;
};

// Sums over images of their turns p and the gyroscope's g.
struct Turns {
  Matrix3d pg = Matrix3d::Zero();
  double pp = 0;
  double gg = 0;
  double time_s = 0;
  int count = 0;

  // Share of p that M g explains, M a rotation or reflection times a scale.
  [[nodiscard]] double explained_by(const Matrix3d& M, double scale = 1) const {
    return (2 * scale * (M.transpose() * pg).trace() - scale * scale * gg) / pp;
  }
};

Turns turns_of(const GyroSum& gyro, std::span<const SeenTurn> seen, double clock_s) {
  constexpr double kFastest_rad_s = 5;  // beyond it the images have erred
  const std::int64_t ahead_ns = std::llround(1e9 * clock_s);
  Turns out;
  for (const SeenTurn& turn : seen) {
    const double dt_s = seconds_between(turn.from, turn.to);
    const auto from = gyro.at({turn.from.ns + ahead_ns}), to = gyro.at({turn.to.ns + ahead_ns});
    if (!from || !to || !(turn.in_body_rad.norm() < kFastest_rad_s * dt_s)) continue;
    const Vector3d told_rad = *to - *from;
    out.pg += turn.in_body_rad * told_rad.transpose();
    out.pp += turn.in_body_rad.squaredNorm();
    out.gg += told_rad.squaredNorm();
    out.time_s += dt_s;
    ++out.count;
  }
  return out;
}

// What of rotations and reflections brings g nearest to p (Schönemann 1966).
Matrix3d nearest_axes(const Turns& turns) {
  const Eigen::JacobiSVD<Matrix3d> svd(turns.pg, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

std::string name_of_axes(const Matrix3d& axes) {
  if (axes.determinant() < 0) return "with the signs of one or of all of its axes changed";
  const Eigen::AngleAxisd turn(axes);
  return fmt::format("with its axes turned by {:.0f} deg about ({:.1f}, {:.1f}, {:.1f})",
                     turn.angle() / kDegree, turn.axis().x(), turn.axis().y(), turn.axis().z());
}

struct Explanation {
  double share = 0;
  std::string how;
};

Explanation by_clock(const GyroSum& gyro, std::span<const SeenTurn> seen, int fewest) {
  constexpr double kMost_s = 5, kStep_s = 0.02;
  Explanation best;
  for (double clock_s = -kMost_s; clock_s <= kMost_s; clock_s += kStep_s) {
    const Turns turns = turns_of(gyro, seen, clock_s);
    if (turns.count < fewest) continue;
    const double share = turns.explained_by(Matrix3d::Identity());
    if (share > best.share) {
      best = {share, fmt::format("with its clock {:.2f} s {}", std::abs(clock_s),
                                 clock_s > 0 ? "ahead of the images'" : "behind the images'")};
    }
  }
  return best;
}

}  // namespace

std::optional<std::string> doubt_of_gyro(const TimeSeries<Vector3d>& gyro,
                                         std::span<const SeenTurn> seen) {
  constexpr int kFewest = 50;
  constexpr double kLeast_rad_s = 1 * kDegree;
  constexpr double kAgrees = 0.5, kExplains = 0.6, kNothing = 0.01;
  const GyroSum sum(gyro);
  const Turns as_told = turns_of(sum, seen, 0);
  if (as_told.count < kFewest) return std::nullopt;
  const double mean_dt_s = as_told.time_s / as_told.count;
  const double rate_rad_s = std::sqrt(as_told.pp / as_told.count) / mean_dt_s;
  const double share = as_told.explained_by(Matrix3d::Identity());
  if (rate_rad_s < kLeast_rad_s || share > kAgrees) return std::nullopt;
  if (as_told.gg < kNothing * as_told.pp) {
    return fmt::format("the images turn by {:.1f} deg/s, of which the gyroscope tells nothing",
                       rate_rad_s / kDegree);
  }
  const Matrix3d axes = nearest_axes(as_told);
  const Explanation degrees{as_told.explained_by(Matrix3d::Identity(), kDegree),
                            "taken for deg/s instead of rad/s"};
  const Explanation turned{as_told.explained_by(axes), name_of_axes(axes)};
  const Explanation late = by_clock(sum, seen, kFewest);
  const Explanation& best = std::max(
      {degrees, turned, late}, [](const auto& a, const auto& b) { return a.share < b.share; });
  if (best.share < kExplains) return std::nullopt;
  return fmt::format(
      "the gyroscope does not turn as the images do; {} it would explain {:.0f} % of their turns",
      best.how, 100 * best.share);
}

}  // namespace stillkite
