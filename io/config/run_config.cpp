#include "io/config/run_config.hpp"

#include "io/config/config_binding.hpp"

namespace stillkite {

RunConfig load_run_config(const std::optional<std::filesystem::path>& file,
                          const std::vector<std::string>& overrides) {
  return bind_config<RunConfig>(read_config(file, overrides));
}

}  // namespace stillkite
