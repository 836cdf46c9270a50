#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "evaluation/association.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// Alignment of an estimate to the truth before the error is computed.
enum class Alignment {
  none,
  origin,  ///< pose of the first pair
  yaw,     ///< rotation about the vertical and translation, 4 degrees of freedom
  se3,     ///< rigid motion, 6 degrees of freedom
  sim3,    ///< rigid motion and scale, 7 degrees of freedom
};

template <>
struct EnumNames<Alignment> {
  static constexpr auto value =
      std::to_array<std::pair<Alignment, std::string_view>>({{Alignment::none, "none"},
                                                             {Alignment::origin, "origin"},
                                                             {Alignment::yaw, "yaw"},
                                                             {Alignment::se3, "se3"},
                                                             {Alignment::sim3, "sim3"}});
};

/// Maps the estimate's world to the truth's: x' = scale * rotation * x + translation.
struct Similarity {
  double scale = 1;
  RigidTransform rigid;
};

/// Least squares on the positions (Umeyama, PAMI 13(4), 1991). std::nullopt if underdetermined: no
/// pair; yaw without horizontal extent; se3 and sim3 with collinear positions.
[[nodiscard]] std::optional<Similarity> best_alignment(std::span<const PosePair> pairs,
                                                       Alignment alignment);

[[nodiscard]] RigidTransform apply(const Similarity& similarity,
                                   const RigidTransform& world_from_body);

/// Pairs with the similarity applied to the estimates.
[[nodiscard]] std::vector<PosePair> aligned(std::span<const PosePair> pairs,
                                            const Similarity& similarity);

}  // namespace stillkite
