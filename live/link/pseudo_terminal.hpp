#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace stillkite {

/// Pseudo-terminal that another program opens as a serial device: the device's end.
class PseudoTerminal {
 public:
  /// `link`: path of a symbolic link to the other end; an existing link is replaced. Throws
  /// InputError if the link or the terminal cannot be created.
  explicit PseudoTerminal(const std::filesystem::path& link);
  /// Removes the link.
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Bytes that the other end has sent since the last call, without waiting.
  [[nodiscard]] std::string read();
  /// Sends bytes; those that the other end has no room for are dropped.
  void write(std::string_view bytes);

 private:
  std::filesystem::path link_;
  int device_ = -1;  // this end
  int other_ = -1;   // stays open, so that this end does not hang up between two programs
};

}  // namespace stillkite
