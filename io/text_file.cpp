#include "io/text_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "geometry/fields.hpp"
#include "io/recording_format.hpp"

namespace stillkite {
namespace fs = std::filesystem;

std::string read_bytes(const fs::path& file) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;
  const std::string name = file.string();
  std::error_code failure;
  const fs::file_status status = fs::status(file, failure);
  if (!fs::exists(status)) throw InputError(name + ": no such file; check the path");
  if (fs::is_directory(status)) throw InputError(name + ": is a folder, expected a file");
  if (is_special_file(file)) throw InputError(name + ": is a pipe or a device, expected a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: cannot be read: {}", name, std::strerror(errno)));
  std::string text;
  std::string block(1 << 16, '\0');
  while (stream.read(block.data(), std::ssize(block)) || stream.gcount() > 0) {
    text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaxBytes)
      throw InputError(name + ": larger than 1 GiB, not a text file of this program");
  }
  if (text.empty()) throw InputError(name + ": the file is empty");
  return text;
}

std::string read_text_file(const fs::path& file) {
  reject_recording(file);
  std::string text = read_bytes(file);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    throw InputError(file.string() + ": the text is in UTF-16; save it as UTF-8");
  }
  const std::size_t zero = text.find('\0');
  if (zero == std::string::npos) return text;
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(zero);
  throw InputError(
      fmt::format("{}:{}: zero bytes; the file is no text, or damaged there (interrupted "
                  "recording): remove the damaged lines",
                  file.string(), std::count(text.begin(), end, '\n') + 1));
}

bool is_special_file(const fs::path& file) {
  std::error_code failure;
  const fs::file_status status = fs::status(file, failure);
  if (!fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status)) return false;
  return !file.string().starts_with("/dev/fd/") && file != "/dev/stdin";
}

std::string expand_environment(const std::string& text, const std::string& where) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t open; (open = text.find("${", at)) != std::string::npos;) {
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) {
      throw InputError(fmt::format("{}: '{}' has ${{ without closing }}", where, text));
    }
    const std::string name = text.substr(open + 2, close - open - 2);
    const char* value = std::getenv(name.c_str());
    if (value == nullptr) {
      throw InputError(
          fmt::format("{}: environment variable {} in '{}' is not set; "
                      "export it or write the full path",
                      where, name, text));
    }
    out.append(text, at, open - at).append(value);
    at = close + 1;
  }
  return out.append(text, at);
}

fs::path resolve_path(const std::string& text, const fs::path& base, const std::string& where) {
  return (base / expand_environment(text, where)).lexically_normal();
}

}  // namespace stillkite
