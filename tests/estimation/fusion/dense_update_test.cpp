#include "estimation/fusion/dense_update.hpp"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <Eigen/Cholesky>
#include <cstdint>

namespace stillkite {
namespace {

class DenseUpdate : public testing::Test {
 protected:
  void TearDown() override { allow(0); }
  static void allow(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

// Rows and columns that fill the vectors, and that leave any rest.
TEST_F(DenseUpdate, IsWhatItSaysOnEveryInstructionSet) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    allow(target);
    for (const int rows : {1, 2, 3, 8, 15, 34, 67}) {
      for (const int columns : {1, 2, 5, 16, 43, 90}) {
        const Eigen::MatrixXd root = Eigen::MatrixXd::Random(rows, rows + 3);
        const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor(root * root.transpose());
        const Eigen::MatrixXd B = Eigen::MatrixXd::Random(rows, columns);
        Eigen::MatrixXd A = B;
        solve_transposed(factor.matrixLLT(), A);
        EXPECT_LT((factor.matrixL() * A - B).norm(), 1e-9 * B.norm()) << hwy::TargetName(target);

        const Eigen::MatrixXd square = Eigen::MatrixXd::Random(columns + 3, columns + 3);
        const Eigen::MatrixXd before = square + square.transpose();
        Eigen::MatrixXd after = before;
        subtract_gram(A, after);
        EXPECT_EQ(after, after.transpose()) << hwy::TargetName(target);
        Eigen::MatrixXd expected = before;
        expected.topLeftCorner(columns, columns) -= A.transpose() * A;
        EXPECT_LT((after - expected).norm(), 1e-12 * expected.norm()) << hwy::TargetName(target);
      }
    }
  }
}

}  // namespace
}  // namespace stillkite
