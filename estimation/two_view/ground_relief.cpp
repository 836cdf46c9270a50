#include "estimation/two_view/ground_relief.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kFewestSeen = 20;
constexpr double kLeastParallax_sigmas = 5;

// A feature's parallax r = s / Z and that of flat ground at h = s, both times the length by which
// the image shows them: their noise is then that of a coordinate.
struct SeenDepth {
  double shift;
  double flat;
};

// b ~ R a + r t: b x R a + r b x t = 0.
std::vector<SeenDepth> seen_depths(const std::vector<BearingPair>& pairs,
                                   const std::vector<unsigned char>& inliers,
                                   const RelativePose& pose, const Eigen::Vector3d& normal) {
  std::vector<SeenDepth> seen;
  seen.reserve(pairs.size());
  for (std::size_t i = 0; i < std::min(pairs.size(), inliers.size()); ++i) {
    if (inliers[i] == 0) continue;
    const Eigen::Vector3d a = pairs[i].reference.homogeneous();
    const Eigen::Vector3d b = pairs[i].current.homogeneous();
    const Eigen::Vector3d across = b.cross(pose.direction);
    const double length = across.norm();
    if (!(length > 1e-6)) continue;  // the epipole shows no depth
    const double shift = -b.cross(pose.current_from_reference * a).dot(across) / length;
    seen.push_back({shift, length * std::max(0.0, normal.dot(a))});
  }
  return seen;
}

// s / h, of the features that may lie on the ground.
std::optional<double> way_over_height(const std::vector<SeenDepth>& seen) {
  std::vector<double> ratios;
  ratios.reserve(seen.size());
  for (const SeenDepth& depth : seen) {
    if (depth.flat > 1e-3) ratios.push_back(depth.shift / depth.flat);
  }
  if (ratios.size() < kFewestSeen) return std::nullopt;
  return upper_median(ratios);
}

// Without a point in front of the camera: as far as can be.
double miss(const Eigen::Vector2d& seen, const Eigen::Vector3d& expected) {
  return expected.z() > 1e-6 ? (seen - expected.hnormalized()).norm() : 1e3;
}

}  // namespace

std::optional<double> ground_relief(const std::vector<BearingPair>& pairs,
                                    const std::vector<unsigned char>& inliers,
                                    const RelativePose& pose,
                                    const Eigen::Vector3d& normal_in_reference, double sigma) {
  if (pose.direction.isZero()) return std::nullopt;
  const std::vector<SeenDepth> seen = seen_depths(pairs, inliers, pose, normal_in_reference);
  if (seen.size() < kFewestSeen) return std::nullopt;
  const double way = way_over_height(seen).value_or(0);  // no ground in view: it explains nothing
  std::vector<double> shifts;
  std::vector<double> unexplained;
  shifts.reserve(seen.size());
  unexplained.reserve(seen.size());
  for (const SeenDepth& depth : seen) {
    shifts.push_back(std::abs(depth.shift));
    unexplained.push_back(std::abs(depth.shift - way * depth.flat));
  }
  const double shift = upper_median(shifts);
  if (!(shift > kLeastParallax_sigmas * sigma)) return std::nullopt;
  return upper_median(unexplained) / shift;
}

std::optional<double> ground_misfit(const std::vector<BearingPair>& pairs,
                                    const RigidTransform& current_from_reference,
                                    const Eigen::Vector3d& normal_in_reference, double height,
                                    double sigma) {
  if (pairs.size() < kFewestSeen || !(height > 0)) return std::nullopt;
  std::vector<double> by_rotation;
  std::vector<double> by_motion;
  by_rotation.reserve(pairs.size());
  by_motion.reserve(pairs.size());
  for (const BearingPair& pair : pairs) {
    const Eigen::Vector3d a = pair.reference.homogeneous();
    const double inverse_depth = std::max(0.0, normal_in_reference.dot(a)) / height;
    const Eigen::Vector3d turned_a = current_from_reference.rotation * a;
    by_rotation.push_back(miss(pair.current, turned_a));
    by_motion.push_back(
        miss(pair.current, turned_a + inverse_depth * current_from_reference.translation));
  }
  const double shift = upper_median(by_rotation);
  if (!(shift > kLeastParallax_sigmas * sigma)) return std::nullopt;
  return upper_median(by_motion) / shift;
}

}  // namespace stillkite
