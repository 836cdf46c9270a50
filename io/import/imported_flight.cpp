#include "io/import/imported_flight.hpp"

namespace stillkite {

void add_note(std::vector<ImportNote>& notes, ImportNote::Kind kind, std::string text) {
  ImportNote note{.kind = kind};
  note.text = std::move(text);
  notes.push_back(std::move(note));
}

}  // namespace stillkite
