#pragma once

#include <Eigen/Core>
#include <array>

namespace stillkite {

[[nodiscard]] inline double square(double x) {
  return x * x;
}

/// Rows of a measurement's Jacobian, of which only few columns are not 0: blocks of up to three.
template <int kRows>
class SparseRows {
 public:
  static constexpr int kOrder = kRows == 1 ? Eigen::RowMajor : Eigen::ColMajor;
  using Block = Eigen::Matrix<double, kRows, Eigen::Dynamic, kOrder, kRows, 3>;

  template <typename Derived>
  void add(int first_column, const Eigen::MatrixBase<Derived>& block) {
    columns_[count_] = first_column;
    blocks_[count_] = block;
    ++count_;
  }

  /// P H^T of the leading n x n of P.
  [[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, kRows> times_transposed(
      const Eigen::MatrixXd& P, int n) const {
    Eigen::Matrix<double, Eigen::Dynamic, kRows> out =
        Eigen::Matrix<double, Eigen::Dynamic, kRows>::Zero(n, kRows);
    // of fixed size: other products as thin as that are not vectorised along P's columns
    for (int i = 0; i < count_; ++i) {
      const auto of_block = P.middleCols(columns_[i], blocks_[i].cols()).topRows(n);
      if (blocks_[i].cols() == 3) {
        out.noalias() += of_block.template leftCols<3>().lazyProduct(
            blocks_[i].template leftCols<3>().transpose());
        continue;
      }
      for (Eigen::Index k = 0; k < blocks_[i].cols(); ++k) {
        out.noalias() += of_block.col(k) * blocks_[i].col(k).transpose();
      }
    }
    return out;
  }

  /// H P H^T, of the columns alone that are not 0.
  [[nodiscard]] Eigen::Matrix<double, kRows, kRows> covariance(const Eigen::MatrixXd& P) const {
    Eigen::Matrix<double, kRows, kRows> out = Eigen::Matrix<double, kRows, kRows>::Zero();
    for (int i = 0; i < count_; ++i) {
      Block row = Block::Zero(kRows, blocks_[i].cols());
      for (int j = 0; j < count_; ++j) {
        row.noalias() +=
            blocks_[j] * P.block(columns_[j], columns_[i], blocks_[j].cols(), blocks_[i].cols());
      }
      out.noalias() += row * blocks_[i].transpose();
    }
    return out;
  }

  /// H M of an n x k matrix M.
  template <typename Derived>
  [[nodiscard]] Eigen::Matrix<double, kRows, Derived::ColsAtCompileTime> times(
      const Eigen::MatrixBase<Derived>& M) const {
    Eigen::Matrix<double, kRows, Derived::ColsAtCompileTime> out =
        Eigen::Matrix<double, kRows, Derived::ColsAtCompileTime>::Zero(kRows, M.cols());
    for (int i = 0; i < count_; ++i) {
      out.noalias() += blocks_[i] * M.middleRows(columns_[i], blocks_[i].cols());
    }
    return out;
  }

 private:
  static constexpr int kMostBlocks = 8;
  std::array<int, kMostBlocks> columns_{};
  std::array<Block, kMostBlocks> blocks_{};
  int count_ = 0;
};

/// A measurement's difference from its prediction, z - h, with H = dh/d(error) and the covariance
/// of its noise.
template <int kRows>
struct Innovation {
  Eigen::Matrix<double, kRows, 1> residual;
  SparseRows<kRows> H;
  Eigen::Matrix<double, kRows, kRows> noise;
};

}  // namespace stillkite
