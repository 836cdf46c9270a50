#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <type_traits>
#include <vector>

namespace stillkite {

using Bytes = std::span<const std::uint8_t>;

static_assert(std::endian::native == std::endian::little, "values are copied as they are");

/// Value with the least significant byte first; bytes after the end are zero, as in MAVLink 2.
template <typename T>
requires std::is_arithmetic_v<T>
[[nodiscard]] T little_endian(Bytes bytes, std::size_t at) {
  T value{};
  if (at < bytes.size()) {
    std::memcpy(&value, bytes.data() + at, std::min(sizeof(T), bytes.size() - at));
  }
  return value;
}

/// Value with the most significant byte first; zero if it does not fit.
template <typename T>
requires std::is_arithmetic_v<T>
[[nodiscard]] T big_endian(Bytes bytes, std::size_t at) {
  T value{};
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) return value;
  std::uint8_t reversed[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) reversed[i] = bytes[at + sizeof(T) - 1 - i];
  std::memcpy(&value, reversed, sizeof(T));
  return value;
}

/// Sequential reader of a file of any size, with a buffer of 64 KiB.
class ByteSource {
 public:
  /// Throws InputError if the file cannot be opened.
  explicit ByteSource(const std::filesystem::path& file);

  /// The next `count` bytes, at most 64 KiB, without consuming them; fewer at the end. Valid until
  /// the next call.
  [[nodiscard]] Bytes peek(std::size_t count);

  /// Consumes bytes, also beyond those peeked at.
  void skip(std::uint64_t count);

  /// Replaces `out` by the next `count` bytes and consumes them; false if there are fewer. Memory
  /// grows with the bytes read.
  [[nodiscard]] bool read(std::vector<std::uint8_t>& out, std::size_t count);

 private:
  std::ifstream stream_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread bytes of buffer_
};

}  // namespace stillkite
