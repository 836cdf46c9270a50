#include "io/file_digest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <vector>

namespace stillkite {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kMaxReadBytes = std::uintmax_t{64} << 20;

class Fnv1a {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) {
      state_ = (state_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
    }
  }
  [[nodiscard]] std::string text() const { return fmt::format("{:016x}", state_); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

// Size and modification time; differs from both for a file that cannot be read.
std::string state_of(const fs::path& file) {
  std::error_code size_error;
  std::error_code time_error;
  const std::uintmax_t size = fs::file_size(file, size_error);
  const auto changed = fs::last_write_time(file, time_error).time_since_epoch().count();
  if (size_error || time_error) return "unreadable";
  return fmt::format("{} {}", size, changed);
}

std::string bytes_digest(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string block(1 << 16, '\0');
  Fnv1a digest;
  while (stream.read(block.data(), std::ssize(block)) || stream.gcount() > 0) {
    digest.add(std::string_view(block.data(), static_cast<std::size_t>(stream.gcount())));
  }
  return stream.eof() ? digest.text() : "unreadable";
}

std::string folder_digest(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code failure;
  for (fs::recursive_directory_iterator at(folder, failure), end; !failure && at != end;
       at.increment(failure)) {
    if (at->is_directory(failure)) continue;
    files.push_back(at->path().lexically_relative(folder).string() + ' ' + state_of(at->path()));
  }
  std::sort(files.begin(), files.end());
  return text_digest(fmt::format("{}", fmt::join(files, "\n")));
}

}  // namespace

std::string text_digest(std::string_view text) {
  Fnv1a digest;
  digest.add(text);
  return digest.text();
}

std::string file_digest(const fs::path& file) {
  std::error_code failure;
  if (!fs::exists(file, failure)) return "missing";
  if (fs::is_directory(file, failure)) return folder_digest(file);
  const bool is_small = fs::file_size(file, failure) <= kMaxReadBytes && !failure;
  return is_small ? bytes_digest(file) : text_digest(state_of(file));
}

}  // namespace stillkite
