#pragma once

#include <string>

#include "recording.hpp"

namespace stillkite::bench {

/// Encoded by a libavcodec encoder (libx264, libx265) at a constant mean bit rate, and decoded. The
/// stamps are kept. An odd last row or column is repeated for the encoder. Throws
/// InputError without this encoder.
[[nodiscard]] Recording with_codec(const Recording& recording, const std::string& encoder,
                                   double bits_per_pixel);

}  // namespace stillkite::bench
