#pragma once

namespace CLI {
class App;
}

namespace stillkite {

// One subcommand, one file. Each function adds its subcommand, whose callback does the work and
// speaks by exception: InputError is wrong use or input (2), Interrupted ends with 130, any other
// std::exception is a failure (1). Results go to stdout, messages to stderr.

void add_run(CLI::App& app);
void add_simulate(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_compare(CLI::App& app);
void add_hover(CLI::App& app);
void add_config(CLI::App& app);

}  // namespace stillkite
