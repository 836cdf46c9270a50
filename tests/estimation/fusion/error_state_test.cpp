#include "estimation/fusion/error_state.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace stillkite {
namespace {

// Two blocks of a Jacobian with eight columns, beside the same matrix in full.
TEST(SparseRows, AgreeWithTheFullMatrix) {
  std::srand(1);
  const Eigen::Matrix<double, 2, 3> a = Eigen::Matrix<double, 2, 3>::Random();
  const Eigen::Matrix2d b = Eigen::Matrix2d::Random();
  SparseRows<2> sparse;
  sparse.add(5, a);
  sparse.add(1, b);
  Eigen::Matrix<double, 2, 8> H = Eigen::Matrix<double, 2, 8>::Zero();
  H.middleCols<3>(5) = a;
  H.middleCols<2>(1) = b;
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(8, 8);
  const Eigen::MatrixXd P = root * root.transpose();
  EXPECT_TRUE(sparse.times_transposed(P, 8).isApprox(P * H.transpose(), 1e-14));
  EXPECT_TRUE(sparse.times(P).isApprox(H * P, 1e-14));
  EXPECT_TRUE(sparse.covariance(P).isApprox(H * P * H.transpose(), 1e-14));
}

}  // namespace
}  // namespace stillkite
