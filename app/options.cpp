#include "app/options.hpp"

#include <CLI/CLI.hpp>

namespace stillkite {

void add_overrides(CLI::App& command, std::vector<std::string>& overrides) {
  command.add_option("--set", overrides,
                     "Override a key of the configuration; may be repeated")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false)  // otherwise it consumes the positional argument after it
      ->type_name("KEY=VALUE");
}

void add_results_folder(CLI::App& command, std::filesystem::path& out) {
  command.add_option("--out", out, "Folder for the results (default: out/CONFIG)")
      ->type_name("DIR");
}

}  // namespace stillkite
