#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"

namespace stillkite {

enum class OperatorAction {
  engage,     ///< start sending the controller's commands
  release,    ///< stop sending them; engage is possible again
  hold_here,  ///< hold the current pose from now on
  mark,       ///< note in the record
  stop,       ///< no commands for the rest of the flight
};
template <>
struct EnumNames<OperatorAction> {
  static constexpr auto value = std::to_array<std::pair<OperatorAction, std::string_view>>(
      {{OperatorAction::engage, "engage"},
       {OperatorAction::release, "release"},
       {OperatorAction::hold_here, "hold_here"},
       {OperatorAction::mark, "mark"},
       {OperatorAction::stop, "stop"}});
};

/// Command of an operator, from any front end.
struct OperatorCommand {
  OperatorAction action = OperatorAction::mark;
  std::string note;   ///< text of a mark
  Timestamp arrival;  ///< local clock
};

/// Reads {"command": "engage"}, with "note" for a mark. nullopt unless the text is such a JSON
/// object of at most 1000 bytes.
[[nodiscard]] std::optional<OperatorCommand> parse_operator_command(std::string_view json,
                                                                    Timestamp arrival);
/// JSON line of a command, without its end; inverse of `parse_operator_command`.
[[nodiscard]] std::string operator_line(const OperatorCommand& command);

/// Commands of all front ends in the order of arrival. Thread-safe.
class OperatorQueue {
 public:
  /// Adds a command; dropped if 100 are waiting, unless it is `stop` or `release`.
  void push(OperatorCommand command);
  [[nodiscard]] std::vector<OperatorCommand> take();

 private:
  std::mutex mutex_;
  std::vector<OperatorCommand> waiting_;
};

}  // namespace stillkite
