#pragma once

namespace stillkite {

/// What the command tells the shell.
enum class ExitCode { done = 0, failed = 1, wrong_input = 2, interrupted = 130 };

/// Thrown by a subcommand that was stopped by Ctrl-C and has written what it had.
struct Interrupted {};

}  // namespace stillkite
