#include "io/import/imported_flight.hpp"

#include <algorithm>
#include <cctype>

namespace stillkite {

void add_note(std::vector<ImportNote>& notes, ImportNote::Kind kind, std::string text) {
  // names in a recording may contain control characters
  std::ranges::replace_if(
      text, [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; }, '?');
  notes.push_back({.kind = kind, .text = std::move(text)});
}

}  // namespace stillkite
