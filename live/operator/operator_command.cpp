#include "live/operator/operator_command.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace stillkite {

std::optional<OperatorCommand> parse_operator_command(std::string_view json, Timestamp arrival) {
  constexpr std::size_t kMaxCommand_bytes = 1000;
  if (json.size() > kMaxCommand_bytes) return std::nullopt;
  const nlohmann::json object = nlohmann::json::parse(json, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  const auto name = object.find("command");
  if (name == object.end() || !name->is_string()) return std::nullopt;
  const auto& names = EnumNames<OperatorAction>::value;
  const auto* const found =
      std::ranges::find(names, std::string_view(name->get_ref<const std::string&>()),
                        [](const auto& pair) { return pair.second; });
  if (found == names.end()) return std::nullopt;
  OperatorCommand out{.action = found->first, .note = {}, .arrival = arrival};
  if (const auto note = object.find("note"); note != object.end()) {
    if (!note->is_string()) return std::nullopt;
    out.note = note->get<std::string>();
  }
  return out;
}

std::string operator_line(const OperatorCommand& command) {
  nlohmann::json object{{"command", name_of(command.action)}};
  if (!command.note.empty()) object["note"] = command.note;
  return object.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

void OperatorQueue::push(OperatorCommand command) {
  constexpr std::size_t kMaxWaiting = 100;
  const bool is_safe =
      command.action == OperatorAction::stop || command.action == OperatorAction::release;
  const std::lock_guard lock(mutex_);
  if (waiting_.size() < kMaxWaiting || is_safe) waiting_.push_back(std::move(command));
}

std::vector<OperatorCommand> OperatorQueue::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

}  // namespace stillkite
