#pragma once

namespace stillkite {

/// From here on the first SIGINT, SIGTERM or SIGHUP only raises a flag and ends a call that waits
/// for a file; a second one ends the process.
void catch_interrupts();

[[nodiscard]] bool interrupted();

}  // namespace stillkite
