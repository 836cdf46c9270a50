#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/study.hpp"

namespace stillkite {

/// Configuration of a subcommand with all defaults, paths absolute, and the files that it names.
struct EffectiveConfig {
  std::string yaml;
  std::vector<std::filesystem::path> inputs;
};

/// `estimators`: list of `compare`, whose configurations name inputs, too. Throws InputError as the
/// subcommand does.
[[nodiscard]] EffectiveConfig effective_config(StudyCommand command, const ConfigNode& root,
                                               const std::string& estimators);

}  // namespace stillkite
