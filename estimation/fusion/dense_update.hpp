#pragma once

#include <Eigen/Core>

namespace stillkite {

// What takes the time of a Kalman filter whose state has hundreds of errors, corrected by hundreds
// of rows at once, on the widest vectors of the processor.

/// B <- U^-T B; only the upper triangle of U is read. With the innovation's covariance S = U^T U
/// and B = H P this is the A of K S K^T = A^T A.
void solve_transposed(const Eigen::MatrixXd& U, Eigen::MatrixXd& B);

/// P <- P - A^T A of the leading rows and columns of a symmetric P, as many as A has columns. It
/// stays symmetric to the last bit.
void subtract_gram(const Eigen::MatrixXd& A, Eigen::MatrixXd& P);

}  // namespace stillkite
