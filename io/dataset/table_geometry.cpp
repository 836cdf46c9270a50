#include "io/dataset/table_geometry.hpp"

#include <fmt/core.h>

#include <cmath>

namespace stillkite {

Eigen::Vector3d vector_at(const TableReader& table, std::size_t column, const Range& range) {
  return {table.number(column, range), table.number(column + 1, range),
          table.number(column + 2, range)};
}

Eigen::Quaterniond quaternion_at(const TableReader& table, std::size_t w, std::size_t xyz) {
  const Eigen::Vector3d v = vector_at(table, xyz);
  const Eigen::Quaterniond q(table.number(w), v.x(), v.y(), v.z());
  // a norm error above 1 % means another column, not rounding
  if (!(std::abs(q.norm() - 1.0) < 0.01)) {
    table.reject(fmt::format("the quaternion norm is {:.4g}, must be 1", q.norm()));
  }
  return q.normalized();
}

}  // namespace stillkite
