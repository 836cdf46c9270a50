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

/// How an estimate is laid onto the truth before its error is taken.
enum class Alignment {
  none,
  origin,  ///< the first pair coincides
  yaw,     ///< best turn about the vertical and best translation, 4 degrees of freedom
  se3,     ///< best rigid motion
  sim3,    ///< best rigid motion and scale
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

/// x' = scale * rotation * x + translation, from the estimate's world to the truth's.
struct Similarity {
  double scale = 1;
  RigidTransform rigid;
};

/// Least squares on the positions (Umeyama, PAMI 13(4), 1991). Nothing when they leave the answer
/// open: no pair, for yaw no horizontal extent, for se3 and sim3 all on one line.
[[nodiscard]] std::optional<Similarity> best_alignment(std::span<const PosePair> pairs,
                                                       Alignment alignment);

[[nodiscard]] RigidTransform apply(const Similarity& similarity,
                                   const RigidTransform& world_from_body);

/// The pairs with their estimates laid onto the truth.
[[nodiscard]] std::vector<PosePair> aligned(std::span<const PosePair> pairs,
                                            const Similarity& similarity);

}  // namespace stillkite
