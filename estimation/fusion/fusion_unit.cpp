#include <utility>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;

// Of the relative errors of many inverse depths the one that they share, as weights of each
// (generalized least squares).
Eigen::VectorXd weights_of_common(Eigen::MatrixXd covariance) {
  constexpr double kOwn = 1e-3;  // no two depths err quite alike
  covariance.diagonal().array() += square(kOwn);
  const Eigen::VectorXd weights = covariance.ldlt().solve(Eigen::VectorXd::Ones(covariance.rows()));
  return weights / weights.sum();
}

// d(logarithm of the unit) / d(error).
std::optional<Eigen::VectorXd> unit_of_depths(const std::vector<Landmark>& landmarks,
                                              const Eigen::MatrixXd& P) {
  constexpr double kKnown = 0.25;  // a depth to that share
  constexpr std::size_t kFewest = 5;
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const int column = Index::landmark(i) + 2;
    const double inverse_depth = landmarks[i].inverse_depth;
    const bool is_known = P(column, column) < square(kKnown * inverse_depth);
    if (inverse_depth > 0 && is_known) known.push_back(i);
  }
  if (known.size() < kFewest) return std::nullopt;
  const auto depth = [&](std::size_t i) { return 1 / landmarks[i].inverse_depth; };
  Eigen::MatrixXd covariance(known.size(), known.size());
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    for (Eigen::Index col = 0; col < covariance.cols(); ++col) {
      const std::size_t i = known[static_cast<std::size_t>(row)];
      const std::size_t j = known[static_cast<std::size_t>(col)];
      covariance(row, col) =
          depth(i) * P(Index::landmark(i) + 2, Index::landmark(j) + 2) * depth(j);
    }
  }
  const Eigen::VectorXd weights = weights_of_common(std::move(covariance));
  if (!weights.allFinite()) return std::nullopt;
  Eigen::VectorXd by_error = Eigen::VectorXd::Zero(Index::landmark(landmarks.size()));
  for (std::size_t k = 0; k < known.size(); ++k) {
    by_error(Index::landmark(known[k]) + 2) =
        weights(static_cast<Eigen::Index>(k)) * depth(known[k]);
  }
  return by_error;
}

}  // namespace

void FusionFilter::settle_unit() {
  const std::optional<Eigen::VectorXd> unit = unit_of_depths(landmarks_, P_);
  if (!unit) return;
  // lengths grow with the logarithm of their number of units
  const int n = size();
  Eigen::VectorXd by_unit = ways();
  by_unit(Index::kScale) = -1;
  by_unit.segment<3>(Index::kAnchorPosition) =
      state_.world_from_anchor.translation - start_in_world_;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    by_unit(Index::landmark(i) + 2) = -landmarks_[i].inverse_depth;
  }
  auto P = P_.topLeftCorner(n, n);
  const Eigen::VectorXd shared = P * *unit;
  P += by_unit * shared.transpose() + shared * by_unit.transpose() +
       unit->dot(shared) * by_unit * by_unit.transpose();
}

}  // namespace stillkite
