#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "io/dataset/table_reader.hpp"

namespace stillkite {

/// Vector in three adjacent cells of the row; throws InputError if a value is out of range.
[[nodiscard]] Eigen::Vector3d vector_at(const TableReader& table, std::size_t column,
                                        const Range& range = kAny);

/// Normalized quaternion of four cells; throws InputError if the norm differs from 1 by over 1 %.
[[nodiscard]] Eigen::Quaterniond quaternion_at(const TableReader& table, std::size_t w,
                                               std::size_t xyz);

}  // namespace stillkite
