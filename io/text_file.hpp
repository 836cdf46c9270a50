#pragma once

#include <filesystem>
#include <string>

namespace stillkite {

/// Content of a file. Throws InputError if it is missing, a folder, a pipe or device, unreadable,
/// empty, or larger than 1 GiB.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& file);

/// As read_bytes; also throws InputError on UTF-16, on zero bytes and on a recording that has to be
/// imported first (recording_format.hpp).
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// True for a pipe, socket or device, which could block on opening. False for /dev/stdin and
/// /dev/fd/*, which a shell provides.
[[nodiscard]] bool is_special_file(const std::filesystem::path& file);

/// Replaces ${NAME} by the environment variable's value. Throws InputError "where: problem" on an
/// unset variable and an unclosed brace.
[[nodiscard]] std::string expand_environment(const std::string& text, const std::string& where);

/// Path with environment variables expanded, relative to `base` unless absolute.
[[nodiscard]] std::filesystem::path resolve_path(const std::string& text,
                                                 const std::filesystem::path& base,
                                                 const std::string& where);

}  // namespace stillkite
