#include "io/import/decompression.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace stillkite {
namespace {

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

// Returns the number of bytes written to `out`; 0 on damaged data.
std::size_t decompress_lz4(Bytes bytes, std::vector<std::uint8_t>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) return 0;
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(raw);
  std::size_t written = 0;
  while (!bytes.empty() && written < out.size()) {
    std::size_t room = out.size() - written, used = bytes.size();
    const std::size_t hint =
        LZ4F_decompress(context.get(), out.data() + written, &room, bytes.data(), &used, nullptr);
    if (LZ4F_isError(hint) != 0 || (room == 0 && used == 0)) return 0;
    written += room;
    bytes = bytes.subspan(used);
  }
  return written;
}

std::size_t decompress_zstd(Bytes bytes, std::vector<std::uint8_t>& out) {
  const std::size_t written = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  return ZSTD_isError(written) != 0 ? 0 : written;
}

std::size_t decompress_bz2(Bytes bytes, std::vector<std::uint8_t>& out) {
  auto written = static_cast<unsigned>(out.size());
  std::vector<char> input(bytes.begin(), bytes.end());
  const int status =
      BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out.data()), &written, input.data(),
                                 static_cast<unsigned>(input.size()), 0, 0);
  return status == BZ_OK ? written : 0;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> decompress(Bytes bytes, std::string_view compression,
                                                    std::uint64_t size) {
  constexpr std::uint64_t kMaxRatio = 10'000;  // of zstd and bz2 on repetitive data
  if (compression.empty() || compression == "none") {
    return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
  }
  if (size > kMaxChunkBytes || size > kMaxRatio * (bytes.size() + 1)) return std::nullopt;
  std::vector<std::uint8_t> out(static_cast<std::size_t>(size));
  std::size_t written = 0;
  if (compression == "lz4") {
    written = decompress_lz4(bytes, out);
  } else if (compression == "zstd") {
    written = decompress_zstd(bytes, out);
  } else if (compression == "bz2") {
    written = decompress_bz2(bytes, out);
  }
  return written == size ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace stillkite
