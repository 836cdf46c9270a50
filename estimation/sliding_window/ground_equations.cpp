#include "estimation/sliding_window/ground_equations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>
#include <span>

namespace stillkite {
namespace {

// Common errors: noise of the keyframe's image, then its log height.
constexpr int kCommon = 7;
constexpr int kPose = InertialIndex::kPoseSize;
constexpr int kShared = PairEquations::kShared;
using Matrix7d = Eigen::Matrix<double, kCommon, kCommon>;
using Vector7d = Eigen::Matrix<double, kCommon, 1>;
using Matrix67d = Eigen::Matrix<double, 6, kCommon>;

double relief_ratio(const Window& window, double height_m) {
  return window.start ? window.start->relief.sigma_m() / height_m : 0;
}

// Sums over the alignments to one keyframe.
class CommonErrors {
 public:
  CommonErrors(std::span<const std::size_t> alignments, const Window& window, double height_m) {
    constexpr double kMinRelief_ratio = 1e-6;
    Matrix6d sum = Matrix6d::Zero();
    for (const std::size_t i : alignments) {
      sum += half_information(window.alignments[i]);
      const GroundAlignment& alignment = window.alignments[i];
      if (tilt_ && alignment.tilt_information.trace() <=
                       window.alignments[*tilt_].tilt_information.trace()) {
        continue;
      }
      tilt_ = i;
    }
    V_.topLeftCorner<6, 6>() = sum / static_cast<double>(alignments.size());
    const double relief = std::max(kMinRelief_ratio, relief_ratio(window, height_m));
    V_(6, 6) = 1 / (relief * relief);
  }

  // The normal counts once, by the alignment that determines it best: lens and relief displace all.
  [[nodiscard]] bool counts_tilt(std::size_t alignment) const { return tilt_ == alignment; }

  // Independent of the keyframe's image.
  [[nodiscard]] static Matrix6d half_information(const GroundAlignment& alignment) {
    return 2 * alignment.information;
  }

  [[nodiscard]] static Matrix67d by_common(const GroundAlignmentResidual& residual) {
    Matrix67d B;
    B << Matrix6d::Identity(), residual.by_log_height;
    return B;
  }

  void add(const Matrix67d& B, const Matrix6d& information, const Vector6d& residual) {
    const Eigen::Matrix<double, kCommon, 6> weighted = B.transpose() * information;
    V_ += weighted * B;
    g_ += weighted * residual;
  }

  // By which the cost and the gradient decrease.
  [[nodiscard]] double cost() const { return 0.5 * g_.dot(V_.ldlt().solve(g_)); }
  [[nodiscard]] Matrix7d inverse() const { return V_.ldlt().solve(Matrix7d::Identity()); }
  [[nodiscard]] const Vector7d& gradient() const { return g_; }

 private:
  Matrix7d V_ = Matrix7d::Zero();
  Vector7d g_ = Vector7d::Zero();
  std::optional<std::size_t> tilt_;
};

// Calls visit(alignments to one keyframe, its frame).
void for_each_keyframe(const Window& window, std::span<const std::size_t> alignments,
                       const auto& visit) {
  while (!alignments.empty()) {
    const std::int64_t id = window.alignments[alignments.front()].keyframe_id;
    std::size_t count = 1;
    while (count < alignments.size() && window.alignments[alignments[count]].keyframe_id == id) {
      ++count;
    }
    visit(alignments.first(count), *window.find(id));
    alignments = alignments.subspan(count);
  }
}

double tilt_cost(const GroundAlignment& alignment, const Eigen::Vector2d& tilt_rad) {
  return 0.5 * tilt_rad.dot(alignment.tilt_information * tilt_rad) -
         tilt_rad.dot(alignment.tilt_information_rad);
}

// Alignment by the shared variables and the keyframe's pose, and by the frame's pose.
struct Jacobians {
  std::size_t target;
  Eigen::Matrix<double, 6, kShared> by_shared;
  Matrix6d by_target;
  Eigen::Matrix<double, 2, kShared> tilt_by_shared;
};

Jacobians jacobians(const Window& window, const GroundAlignment& alignment, std::size_t keyframe,
                    const PairEquations& ground, const WindowGeometry& geometry) {
  const std::size_t target = *window.find(alignment.frame_id);
  const CameraPair& first = geometry.first.at(keyframe, target);
  const GroundAlignmentJacobians by =
      ground_alignment_jacobians(alignment, geometry.first_ground.at(keyframe));
  const PairEquations pair = pair_equations(window, keyframe, target, first);
  const auto ground_by_shared = ground.by_shared.topRows<4>();
  return {.target = target,
          .by_shared = by.motion_by_pair * pair.by_shared + by.motion_by_ground * ground_by_shared,
          .by_target = by.motion_by_pair * pair.by_target,
          .tilt_by_shared = by.tilt_by_ground * ground_by_shared};
}

// Lower triangle of H += J_a^T M J_b and g += J_a^T v for the rows a of the variables.
class Rows {
 public:
  Rows(std::size_t host, WindowLinearization& out) : out_(out), host_(out.offsets[host]) {}

  void add_shared(const Eigen::Matrix<double, kShared, kShared>& H,
                  const Eigen::Matrix<double, kShared, 1>& g) {
    constexpr int kWindow = SharedIndex::kSize;
    out_.H.topLeftCorner<kWindow, kWindow>() += H.topLeftCorner<kWindow, kWindow>();
    out_.H.block<kPose, kWindow>(host_, 0) += H.bottomLeftCorner<kPose, kWindow>();
    out_.H.block<kPose, kPose>(host_, host_) += H.bottomRightCorner<kPose, kPose>();
    out_.g.head<kWindow>() += g.head<kWindow>();
    out_.g.segment<kPose>(host_) += g.tail<kPose>();
  }

  void add_target(std::size_t target, const Eigen::Matrix<double, kPose, kShared>& by_shared,
                  const Vector6d& g) {
    constexpr int kWindow = SharedIndex::kSize;
    const int t = out_.offsets[target];
    out_.H.block<kPose, kWindow>(t, 0) += by_shared.leftCols<kWindow>();
    out_.H.block<kPose, kPose>(t, host_) += by_shared.rightCols<kPose>();
    out_.g.segment<kPose>(t) += g;
  }

  void add_targets(std::size_t a, std::size_t b, const Matrix6d& H) {
    out_.H.block<kPose, kPose>(out_.offsets[a], out_.offsets[b]) += H;
  }

 private:
  WindowLinearization& out_;
  int host_;
};

void add_keyframe(const Window& window, std::span<const std::size_t> alignments,
                  std::size_t keyframe, const WindowGeometry& geometry, WindowLinearization& out) {
  const GroundView& view = geometry.present_ground.at(keyframe);
  const PairEquations ground = ground_pair_equations(window, keyframe);
  CommonErrors common(alignments, window, view.height_m);
  Rows rows(keyframe, out);
  // weighted Jacobians of the common errors: B^T L J
  struct Weighted {
    std::size_t target;
    Eigen::Matrix<double, kCommon, 6> by_target;
  };
  std::vector<Weighted> targets;
  Eigen::Matrix<double, kCommon, kShared> by_shared =
      Eigen::Matrix<double, kCommon, kShared>::Zero();
  for (const std::size_t i : alignments) {
    const GroundAlignment& alignment = window.alignments[i];
    const Jacobians J = jacobians(window, alignment, keyframe, ground, geometry);
    const GroundAlignmentResidual residual =
        ground_alignment_residual(alignment, geometry.present.at(keyframe, J.target), view);
    const Matrix6d L = CommonErrors::half_information(alignment);
    const Matrix67d B = CommonErrors::by_common(residual);
    common.add(B, L, residual.motion);
    const Eigen::Matrix<double, kShared, 6> shared_weighted = J.by_shared.transpose() * L;
    const Matrix6d target_weighted = J.by_target.transpose() * L;
    Eigen::Matrix<double, kShared, kShared> H = shared_weighted * J.by_shared;
    Eigen::Matrix<double, kShared, 1> g = shared_weighted * residual.motion;
    if (common.counts_tilt(i)) {
      const Eigen::Matrix<double, kShared, 2> weighted =
          J.tilt_by_shared.transpose() * alignment.tilt_information;
      H += weighted * J.tilt_by_shared;
      g += J.tilt_by_shared.transpose() * alignment.tilt_information_rad -
           weighted * residual.tilt_rad;
    }
    rows.add_shared(H, g);
    rows.add_target(J.target, target_weighted * J.by_shared, target_weighted * residual.motion);
    rows.add_targets(J.target, J.target, target_weighted * J.by_target);
    by_shared += B.transpose() * shared_weighted.transpose();
    targets.push_back({J.target, B.transpose() * target_weighted.transpose()});
  }
  const Matrix7d inverse = common.inverse();
  const Eigen::Matrix<double, kCommon, kShared> shared_inverse = inverse * by_shared;
  const Vector7d g = inverse * common.gradient();
  rows.add_shared(-by_shared.transpose() * shared_inverse, -by_shared.transpose() * g);
  for (std::size_t a = 0; a < targets.size(); ++a) {
    const Eigen::Matrix<double, 6, kCommon> weighted = targets[a].by_target.transpose();
    rows.add_target(targets[a].target, -weighted * shared_inverse, -weighted * g);
    for (std::size_t b = 0; b <= a; ++b) {
      rows.add_targets(targets[a].target, targets[b].target,
                       -weighted * inverse * targets[b].by_target);
    }
  }
}

}  // namespace

void add_ground_alignments(const Window& window, const std::vector<std::size_t>& alignments,
                           const WindowGeometry& geometry, WindowLinearization& out) {
  for_each_keyframe(window, alignments, [&](auto group, std::size_t keyframe) {
    add_keyframe(window, group, keyframe, geometry, out);
  });
}

double ground_alignments_cost(const Window& window, const std::vector<std::size_t>& alignments,
                              CameraPairs& pairs, GroundViews& ground) {
  double cost = 0;
  for_each_keyframe(window, alignments, [&](auto group, std::size_t keyframe) {
    const GroundView& view = ground.at(keyframe);
    CommonErrors common(group, window, view.height_m);
    for (const std::size_t i : group) {
      const GroundAlignment& alignment = window.alignments[i];
      const GroundAlignmentResidual residual = ground_alignment_residual(
          alignment, pairs.at(keyframe, *window.find(alignment.frame_id)), view);
      const Matrix6d L = CommonErrors::half_information(alignment);
      common.add(CommonErrors::by_common(residual), L, residual.motion);
      cost += 0.5 * residual.motion.dot(L * residual.motion);
      if (common.counts_tilt(i)) cost += tilt_cost(alignment, residual.tilt_rad);
    }
    cost -= common.cost();
  });
  return cost;
}

double squared_error(const Window& window, const GroundAlignment& alignment) {
  const std::size_t keyframe = *window.find(alignment.keyframe_id);
  CameraPairs pairs(window, false);
  GroundViews ground(window, false);
  const GroundView& view = ground.at(keyframe);
  const GroundAlignmentResidual residual = ground_alignment_residual(
      alignment, pairs.at(keyframe, *window.find(alignment.frame_id)), view);
  const double relief = relief_ratio(window, view.height_m);
  const Vector6d d = relief * residual.by_log_height;
  // (C + d d^T)^-1 (Sherman, Morrison)
  const Vector6d weighted = alignment.information * d;
  const double along = weighted.dot(residual.motion);
  return residual.motion.dot(alignment.information * residual.motion) -
         along * along / (1 + d.dot(weighted));
}

}  // namespace stillkite
