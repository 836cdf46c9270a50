#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "live/operator/operator_command.hpp"

namespace stillkite {

/// Operator commands as JSON lines: on standard input, or as datagrams to a Unix socket that only
/// this user can write.
class OperatorInput {
 public:
  /// `source`: - or unix:PATH. Throws InputError that names live.operator for any other, and if
  /// the path exists or cannot be created; the socket of a killed process is replaced.
  explicit OperatorInput(const std::string& source);
  /// Removes the socket.
  ~OperatorInput();
  OperatorInput(const OperatorInput&) = delete;
  OperatorInput& operator=(const OperatorInput&) = delete;

  /// Adds the commands that have arrived, without waiting. Returns the number of lines that are
  /// no command.
  [[nodiscard]] int read_into(OperatorQueue& queue);

  /// True once standard input has ended.
  [[nodiscard]] bool has_ended() const { return has_ended_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;  // of the socket
  std::string waiting_;         // incomplete line
  bool has_ended_ = false;
};

}  // namespace stillkite
