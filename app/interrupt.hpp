#pragma once

namespace stillkite {

/// Installs handlers: the first SIGINT, SIGTERM or SIGHUP sets a flag and interrupts blocking file
/// calls; the second terminates the process.
void catch_interrupts();

[[nodiscard]] bool interrupted();

/// Thrown by a subcommand after Ctrl-C, once its results so far are written.
struct Interrupted {};

}  // namespace stillkite
