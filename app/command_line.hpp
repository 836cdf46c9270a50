#pragma once

#include <string>

namespace stillkite {

/// Parses the command line, runs its subcommand and returns the exit status: 0 done, 1 failure,
/// 2 wrong use or input, 130 interrupted. Messages go to stderr.
[[nodiscard]] int run_command_line(int argc, char** argv, const std::string& version);

}  // namespace stillkite
