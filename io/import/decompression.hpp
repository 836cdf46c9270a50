#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "io/import/byte_source.hpp"

namespace stillkite {

/// Largest chunk of a recording that is decompressed.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{512} << 20;

/// Content of a chunk: `compression` is "" or "none", "lz4" (frame format), "zstd" or "bz2".
/// Nullopt if the compression is unknown, the data is damaged, or the size differs from `size`.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> decompress(Bytes bytes,
                                                                  std::string_view compression,
                                                                  std::uint64_t size);

}  // namespace stillkite
