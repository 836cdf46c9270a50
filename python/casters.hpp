#pragma once

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Geometry>
#include <cmath>
#include <concepts>
#include <string>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"

namespace pybind11::detail {

/// An enum with EnumNames is its name in Python. Another name raises InputError with the known
/// ones.
template <typename Enum>
requires std::is_enum_v<Enum> && requires {
  stillkite::EnumNames<Enum>::value;
}
class type_caster<Enum> {
 public:
  PYBIND11_TYPE_CASTER(Enum, const_name("str"));

  bool load(handle source, bool) {
    if (!isinstance<str>(source)) return false;
    const auto text = source.cast<std::string>();
    std::string known;
    for (const auto& [known_value, known_name] : stillkite::EnumNames<Enum>::value) {
      if (known_name == text) {
        value = known_value;
        return true;
      }
      known.append(known.empty() ? "" : ", ").append(known_name);
    }
    throw stillkite::InputError(fmt::format("'{}' is not one of: {}", text, known));
  }

  static handle cast(Enum enumerator, return_value_policy, handle) {
    const std::string_view text = stillkite::name_of(enumerator);
    return str(text.data(), text.size()).release();
  }
};

/// A Timestamp is an int in Python, ns.
template <>
class type_caster<stillkite::Timestamp> {
 public:
  PYBIND11_TYPE_CASTER(stillkite::Timestamp, const_name("int"));

  bool load(handle source, bool convert) {
    make_caster<std::int64_t> ns;
    if (!ns.load(source, convert)) return false;
    value.ns = cast_op<std::int64_t>(ns);
    return true;
  }

  static handle cast(stillkite::Timestamp stamp, return_value_policy, handle) {
    return int_(stamp.ns).release();
  }
};

/// A unit quaternion is an array (w, x, y, z) in Python. Another norm raises InputError.
template <>
class type_caster<Eigen::Quaterniond> {
 public:
  PYBIND11_TYPE_CASTER(Eigen::Quaterniond, const_name("numpy.ndarray"));

  bool load(handle source, bool convert) {
    make_caster<Eigen::Vector4d> wxyz;
    if (!wxyz.load(source, convert)) return false;
    const Eigen::Vector4d& q = cast_op<const Eigen::Vector4d&>(wxyz);
    if (!(std::abs(q.norm() - 1) < 0.01)) {
      throw stillkite::InputError(
          fmt::format("quaternion ({}, {}, {}, {}): norm {:.4g}; pass a unit quaternion in the "
                      "order w, x, y, z",
                      q[0], q[1], q[2], q[3], q.norm()));
    }
    value = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    // an exact one keeps its last digits
    if (std::abs(q.squaredNorm() - 1) > 1e-12) value.normalize();
    return true;
  }

  static handle cast(const Eigen::Quaterniond& q, return_value_policy, handle) {
    return make_caster<Eigen::Vector4d>::cast(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()),
                                              return_value_policy::move, {});
  }
};

}  // namespace pybind11::detail
