#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace stillkite {

/// 64-bit FNV-1a digest (Fowler, Noll & Vo) of a text, 16 hexadecimal digits. Detects changes, not
/// forgery.
[[nodiscard]] std::string text_digest(std::string_view text);

/// Digest that changes with a file or a folder. Of a file up to 64 MiB: its bytes; of a larger one,
/// such as a long video: size and modification time. Of a folder, which can hold thousands of
/// images: name, size and modification time of each file in it. "missing" without a file.
[[nodiscard]] std::string file_digest(const std::filesystem::path& file);

}  // namespace stillkite
