#pragma once

#include <Eigen/Geometry>
#include <random>

namespace stillkite {

/// Vector with components uniform in [-limit, limit].
[[nodiscard]] inline Eigen::Vector3d random_vector(std::mt19937& random, double limit) {
  std::uniform_real_distribution<double> component(-limit, limit);
  return {component(random), component(random), component(random)};
}

/// Rotation uniform over SO(3).
[[nodiscard]] inline Eigen::Quaterniond random_rotation(std::mt19937& random) {
  std::normal_distribution<double> component;
  return Eigen::Quaterniond(component(random), component(random), component(random),
                            component(random))
      .normalized();
}

}  // namespace stillkite
