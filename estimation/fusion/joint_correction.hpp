#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/fusion/landmark_view.hpp"

namespace stillkite {

/// What all views of a frame together correct of a prediction: with their residual r, of the
/// covariance S = H P H^T + N = U^T U, and A = U^-T H P.
struct JointCorrection {
  Eigen::VectorXd error;  ///< to be added, A^T U^-T r
  Eigen::MatrixXd A_t;    ///< A; A^T A is to be taken off P
  Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> S;
  Eigen::VectorXd residual;
};

/// Of the prediction that `offset` (errors) leads from to the state, about which it is linearised;
/// the errors' covariance is the leading part of P. Nothing where a landmark cannot be seen.
[[nodiscard]] std::optional<JointCorrection> joint_correction(
    const FusionState& state, const std::vector<Landmark>& landmarks, const Eigen::MatrixXd& P,
    const std::vector<LandmarkView>& views, const Eigen::VectorXd& offset);

/// The same of the state itself, linearised about the rotation that the views themselves tell, as
/// without a gyroscope the predicted one is a guess (Bell, Cathey 1993); but about the predicted
/// way and depths: of their product, where both are vague, a step of Gauss-Newton believes too
/// much.
[[nodiscard]] std::optional<JointCorrection> joint_correction(
    FusionState state, const std::vector<Landmark>& landmarks, const Eigen::MatrixXd& P,
    const std::vector<LandmarkView>& views);

/// The view that is furthest from what all others and the prediction say of it, if that is beyond
/// the gate. What is near enough to a vague prediction may be far from what the others leave open
/// (Baarda's data snooping).
[[nodiscard]] std::optional<std::size_t> outlier_among(const JointCorrection& views,
                                                       double gate_sigma);

}  // namespace stillkite
