#pragma once

namespace stillkite {

/// Exit status of the command.
enum class ExitCode { done = 0, failed = 1, wrong_input = 2, interrupted = 130 };

/// Thrown by a subcommand after Ctrl-C, once its results so far are written.
struct Interrupted {};

}  // namespace stillkite
