#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace stillkite {

// Options that several subcommands share; what they fill must outlive the command's callback.

void add_overrides(CLI::App& command, std::vector<std::string>& overrides);
void add_results_folder(CLI::App& command, std::filesystem::path& out);

}  // namespace stillkite
