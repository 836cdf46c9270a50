#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/dataset/unit_name.hpp"

namespace stillkite {

/// Physical quantity of a table column.
enum class Quantity : std::uint8_t {
  time,
  counter,
  position,
  latitude_longitude,
  height,
  velocity,
  acceleration,
  angular_rate,
  angular_acceleration,
  quaternion,
  euler_angle,
  magnetic_field,
};

/// Quantity and axis of a column, as expected by a table or as named in a header.
struct Column {
  std::optional<Quantity> quantity;
  char axis = 0;  ///< x, y, z, w of a quaternion, d for down; 0: none
};

/// Quantity and axis by the words of a column name: `angular_velocity_x`, `w_RS_S_x [rad s^-1]`,
/// `AccX`, `qw`, `pos_east`. East, north, up are x, y, z. Unknown parts are left empty.
[[nodiscard]] Column column_named(std::string_view name);

/// False if both columns have a quantity and these differ, or both an axis and these differ.
[[nodiscard]] bool is_compatible(const Column& named, const Column& expected);

/// For messages: "angular rate x".
[[nodiscard]] std::string_view name_of(Quantity quantity);
[[nodiscard]] std::string description_of(const Column& column);
/// For messages: "angular rate x, y, z, acceleration x, y, z".
[[nodiscard]] std::string description_of(std::span<const Column> columns);

/// Unit of a table's column; nullopt without one.
[[nodiscard]] std::optional<Unit> unit_of(const Column& column);

/// Columns x, y, z of each quantity.
[[nodiscard]] std::vector<Column> vector_columns(std::initializer_list<Quantity> quantities);

}  // namespace stillkite
