#pragma once

namespace stillkite {

inline constexpr double kGravity_m_s2 = 9.80665;  ///< standard gravity

}  // namespace stillkite
