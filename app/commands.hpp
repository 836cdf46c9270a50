#pragma once

namespace CLI {
class App;
}

namespace stillkite {

// One subcommand per file. Each function adds its subcommand; the callback does the work and throws
// InputError on wrong use or input (exit status 2), Interrupted (130), or another std::exception on
// failure (1). Results go to stdout, messages to stderr.

void add_run(CLI::App& app);
void add_fly(CLI::App& app);
void add_replay(CLI::App& app);
void add_simulate(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_compare(CLI::App& app);
void add_hover(CLI::App& app);
void add_batch(CLI::App& app);
void add_import(CLI::App& app);
void add_check(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_config(CLI::App& app);

/// Thrown by `check` after its output: exit status 2 if something is wrong, 1 if doubtful.
struct CheckFailed {
  bool is_wrong = false;
};

}  // namespace stillkite
