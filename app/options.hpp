#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace stillkite {

// Options shared by several subcommands. The referenced variables must outlive the callback.

void add_overrides(CLI::App& command, std::vector<std::string>& overrides);
void add_results_folder(CLI::App& command, std::filesystem::path& out);

}  // namespace stillkite
