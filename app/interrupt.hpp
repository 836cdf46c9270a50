#pragma once

namespace stillkite {

/// From here on the first SIGINT, SIGTERM or SIGHUP only raises a flag; a second one ends the
/// process.
void catch_interrupts();

[[nodiscard]] bool interrupted();

}  // namespace stillkite
