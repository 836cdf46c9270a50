#include "estimation/fusion/innovation_consensus.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

namespace stillkite {

bool is_within_sigmas(const Eigen::Vector2d& off, const Eigen::Matrix2d& C, double sigmas) {
  return off.dot(C.llt().solve(off)) <= sigmas * sigmas;
}

std::vector<bool> largest_consensus(const Eigen::VectorXd& residual, const Eigen::MatrixXd& S,
                                    double sigmas) {
  const auto count = static_cast<std::size_t>(residual.size() / 2);
  const auto off = [&](std::size_t i) -> Eigen::Vector2d {
    return residual.segment<2>(2 * static_cast<Eigen::Index>(i));
  };
  const auto cross = [&](std::size_t i, std::size_t j) -> Eigen::Matrix2d {
    return S.block<2, 2>(2 * static_cast<Eigen::Index>(i), 2 * static_cast<Eigen::Index>(j));
  };
  std::vector<bool> near(count);
  for (std::size_t i = 0; i < count; ++i) near[i] = is_within_sigmas(off(i), cross(i, i), sigmas);

  std::vector<bool> best(count, false);
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!near[i]) continue;
    const Eigen::LLT<Eigen::Matrix2d> factor(cross(i, i));
    std::vector<bool> agree(count, false);
    for (std::size_t j = 0; j < count; ++j) {
      const Eigen::Matrix2d gain_t = factor.solve(cross(i, j));
      agree[j] =
          j == i || (near[j] && is_within_sigmas(off(j) - gain_t.transpose() * off(i),
                                                 cross(j, j) - cross(j, i) * gain_t, sigmas));
    }
    const std::ptrdiff_t votes = std::count(agree.begin(), agree.end(), true);
    if (votes <= most) continue;
    most = votes;
    best = std::move(agree);
  }
  return best;
}

}  // namespace stillkite
