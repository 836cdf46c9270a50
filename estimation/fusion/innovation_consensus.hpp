#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillkite {

/// Whether off^T C^-1 off <= sigmas^2; false for what is not finite.
[[nodiscard]] bool is_within_sigmas(const Eigen::Vector2d& off, const Eigen::Matrix2d& C,
                                    double sigmas);

/// Which of a frame's points belong together: RANSAC of one point with the filter's prediction
/// (Civera, Grasa, Davison, Montiel 2010), with every point in turn instead of draws. `residual`
/// are their innovations, two rows a point, S their joint covariance. Given point i, j is expected
/// at S_ji S_ii^-1 r_i with S_jj - S_ji S_ii^-1 S_ij: what puts all off alike, as a vague pose
/// does, drops out. Gives the largest set that one point explains; none is beyond its own S_jj.
[[nodiscard]] std::vector<bool> largest_consensus(const Eigen::VectorXd& residual,
                                                  const Eigen::MatrixXd& S, double sigmas);

}  // namespace stillkite
