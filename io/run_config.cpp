#include "io/run_config.hpp"

#include "io/config_binding.hpp"

namespace stillkite {

RunConfig load_run_config(const std::optional<std::filesystem::path>& file,
                          const std::vector<std::string>& overrides) {
  ConfigNode root{.kind = ConfigNode::Kind::map};
  if (file) root = read_yaml(*file);
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  return bind_config<RunConfig>(root);
}

}  // namespace stillkite
