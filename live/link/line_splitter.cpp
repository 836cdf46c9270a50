#include "live/link/line_splitter.hpp"

#include <utility>

namespace stillkite {

std::optional<std::string> LineSplitter::next() {
  while (true) {
    const std::size_t end = waiting_.find_first_of("\r\n");
    if (end == std::string::npos) {
      if (waiting_.size() > max_line_bytes_) {
        waiting_.clear();
        if (!std::exchange(is_overlong_, true)) ++dropped_;
      }
      return std::nullopt;
    }
    std::string line = waiting_.substr(0, end);
    waiting_.erase(0, end + 1);
    const bool is_rest = std::exchange(is_overlong_, false);
    if (line.empty() || is_rest) continue;
    if (line.size() <= max_line_bytes_) return line;
    ++dropped_;
  }
}

}  // namespace stillkite
