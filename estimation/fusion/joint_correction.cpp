#include "estimation/fusion/joint_correction.hpp"

#include <utility>

#include "estimation/fusion/dense_update.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {

std::optional<JointCorrection> joint_correction(const FusionState& state,
                                                const std::vector<Landmark>& landmarks,
                                                const Eigen::MatrixXd& P,
                                                const std::vector<LandmarkView>& views,
                                                const Eigen::VectorXd& offset) {
  const int n = FusionIndex::landmark(landmarks.size());
  const auto rows = 2 * static_cast<Eigen::Index>(views.size());
  Eigen::MatrixXd PHt(n, rows);
  Eigen::MatrixXd S(rows, rows);
  Eigen::VectorXd residual(rows);
  std::vector<Innovation<2>> innovations;
  innovations.reserve(views.size());
  for (const LandmarkView& view : views) {
    const auto row = 2 * static_cast<Eigen::Index>(innovations.size());
    const auto innovation =
        landmark_innovation(state, landmarks[view.landmark], FusionIndex::landmark(view.landmark),
                            view.bearing, view.covariance);
    if (!innovation) return std::nullopt;
    PHt.middleCols<2>(row) = innovation->H.times_transposed(P, n);
    residual.segment<2>(row) = innovation->residual + innovation->H.times(offset);
    innovations.push_back(*innovation);
  }
  Eigen::MatrixXd A_t = PHt.transpose();
  for (std::size_t i = 0; i < innovations.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    S.block(0, row, row + 2, 2) = innovations[i].H.times_transposed(A_t, static_cast<int>(row) + 2);
    S.block<2, 2>(row, row) += innovations[i].noise;
  }
  Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor(S);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd whitened = factor.matrixL().solve(residual);
  JointCorrection out{.error = {}, .A_t = std::move(A_t), .S = {}, .residual = std::move(residual)};
  solve_transposed(factor.matrixLLT(), out.A_t);
  out.S = std::move(factor);
  out.error = out.A_t.transpose() * whitened;
  if (!out.error.allFinite()) return std::nullopt;
  return out;
}

std::optional<JointCorrection> joint_correction(FusionState state,
                                                const std::vector<Landmark>& landmarks,
                                                const Eigen::MatrixXd& P,
                                                const std::vector<LandmarkView>& views) {
  constexpr int kMostSteps = 4;
  constexpr double kSettled_rad = 1e-3;
  const Eigen::Quaterniond predicted = state.world_from_camera.rotation;
  std::optional<JointCorrection> correction;
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(FusionIndex::landmark(landmarks.size()));
  Eigen::Ref<Eigen::Vector3d> turn = offset.segment<3>(FusionIndex::kRotation);
  for (int step = 0; step < kMostSteps; ++step) {
    state.world_from_camera.rotation = so3_exp(turn) * predicted;
    correction = joint_correction(state, landmarks, P, views, offset);
    if (!correction) break;
    const Eigen::Vector3d next = correction->error.segment<3>(FusionIndex::kRotation);
    if ((next - turn).norm() < kSettled_rad) break;
    turn = next;
  }
  return correction;
}

// With x = S^-1 r view i is off by e_i = (S^-1)_ii^-1 x_i, of covariance (S^-1)_ii^-1, which is no
// more than S_ii.
std::optional<std::size_t> outlier_among(const JointCorrection& views, double gate_sigma) {
  double most = 2 * square(gate_sigma);
  const Eigen::MatrixXd& U = views.S.matrixLLT();
  const Eigen::VectorXd x = views.S.solve(views.residual);
  std::optional<std::size_t> outlier;
  for (Eigen::Index row = 0; row < x.size(); row += 2) {
    const Eigen::Vector2d own = x.segment<2>(row);
    const Eigen::Vector2d by_own = U.block<2, 2>(row, row).triangularView<Eigen::Upper>() * own;
    if ((U.block(0, row, row, 2) * own).squaredNorm() + by_own.squaredNorm() <= most) continue;
    const Eigen::Index left = x.size() - row;
    Eigen::MatrixX2d column = Eigen::MatrixX2d::Identity(left, 2);
    U.bottomRightCorner(left, left).triangularView<Eigen::Upper>().transpose().solveInPlace(column);
    const Eigen::Matrix2d of_inverse = column.transpose() * column;
    const double off = own.dot(of_inverse.llt().solve(own));
    if (off <= most) continue;
    most = off;
    outlier = static_cast<std::size_t>(row / 2);
  }
  return outlier;
}

}  // namespace stillkite
