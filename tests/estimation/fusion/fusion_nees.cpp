#include "tests/estimation/fusion/fusion_nees.hpp"

#include <algorithm>
#include <cstdio>

namespace stillkite {

double nees_of(const FusionSimulation& flight) {
  const Vector6d error = flight.pose_error();
  return error.dot(flight.filter().pose_covariance().ldlt().solve(error));
}

std::array<double, 10> nees_by_second(const FusionScene& scene, const FusionConfig& config,
                                      int seeds) {
  std::array<double, 10> mean{};
  for (int seed = 0; seed < seeds; ++seed) {
    FusionSimulation flight(scene, config, static_cast<std::uint64_t>(seed) + 100);
    for (double& second : mean) {
      for (int i = 0; i < 30; ++i) flight.step();
      second += nees_of(flight) / seeds;
    }
  }
  std::printf("NEES, s 1 to 10:");
  for (const double second : mean) std::printf(" %.2f", second);
  std::printf("\n");
  return mean;
}

double most(const std::array<double, 10>& nees) {
  return *std::max_element(nees.begin(), nees.end());
}

}  // namespace stillkite
