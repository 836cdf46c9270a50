#pragma once

#include <filesystem>
#include <string>

namespace stillkite {

/// The whole file. Throws InputError if it is missing, a folder, unreadable, empty, or larger than
/// any text that this program reads.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Neither a file nor a folder: a pipe, a socket, a device, which may keep who opens it waiting.
/// What a shell hands over (/dev/stdin, /dev/fd/63) is none of these.
[[nodiscard]] bool is_special_file(const std::filesystem::path& file);

/// Replaces ${NAME} by the environment variable's value. Throws InputError beginning with `where`
/// for a variable that is not set and for a brace that is not closed.
[[nodiscard]] std::string expand_environment(const std::string& text, const std::string& where);

/// The path with its variables expanded, relative to `base` unless it is absolute.
[[nodiscard]] std::filesystem::path resolve_path(const std::string& text,
                                                 const std::filesystem::path& base,
                                                 const std::string& where);

}  // namespace stillkite
