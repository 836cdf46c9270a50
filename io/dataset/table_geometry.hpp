#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "io/dataset/table_reader.hpp"

namespace stillkite {

/// Three neighbouring cells of the row, each in the range.
[[nodiscard]] Eigen::Vector3d vector_at(const TableReader& table, std::size_t column,
                                        const Range& range = kAny);

/// Of three columns each.
[[nodiscard]] std::vector<Unit> units_of_vectors(Unit first, Unit second);

/// Four cells of the row, w in its own column; throws InputError unless its length is 1.
[[nodiscard]] Eigen::Quaterniond quaternion_at(const TableReader& table, std::size_t w,
                                               std::size_t xyz);

}  // namespace stillkite
