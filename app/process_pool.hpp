#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stillkite {

/// Call of this program.
struct ProcessCommand {
  std::vector<std::string> arguments;
  std::filesystem::path messages;  ///< file that receives its stderr
};

struct ProcessEnd {
  std::optional<std::string> failure;  ///< last message, or signal; nullopt: exit status 0
  double wall_s = 0;
};

/// Runs the commands as child processes, at most `processes` at once; a crash ends one of them
/// only. Each has one OpenCV thread. `before_start` is called with the index of a command,
/// `after_end` with its result. After Ctrl-C the children are interrupted; only complete ones are
/// reported. They do not outlive this process, even if it is killed. Throws what the callbacks
/// throw, after killing all children.
void run_processes(std::span<const ProcessCommand> commands, int processes,
                   const std::function<void(std::size_t)>& before_start,
                   const std::function<void(std::size_t, const ProcessEnd&)>& after_end);

}  // namespace stillkite
