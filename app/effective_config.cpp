#include "app/effective_config.hpp"

#include <iterator>

#include "app/hover_setup.hpp"
#include "app/simulate_config.hpp"
#include "app/variants.hpp"
#include "io/config/config_printing.hpp"
#include "io/dataset/euroc_dataset.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

/// Visitor for `Config::fields` that collects the paths.
class PathCollector {
 public:
  explicit PathCollector(std::vector<fs::path>& paths) : paths_(paths) {}

  template <typename T, typename... Description>
  void operator()(std::string_view /*name*/, const T& value, const Description&... /*text*/) {
    if constexpr (ListsFields<T>) {
      T::fields(value, *this);
    } else if constexpr (kIsOptional<T>) {
      if (value) (*this)("", *value);
    } else if constexpr (std::same_as<T, fs::path>) {
      if (!value.empty()) paths_.push_back(value);
    }
  }

 private:
  std::vector<fs::path>& paths_;
};

template <ListsFields Config>
EffectiveConfig printed(const Config& config) {
  EffectiveConfig effective{.yaml = print_config(config), .inputs = {}};
  Config::fields(config, PathCollector(effective.inputs));
  return effective;
}

// With the files of a data set that are outside of its image folder.
EffectiveConfig printed_run(const RunConfig& config) {
  EffectiveConfig effective = printed(config);
  if (const auto dataset = find_euroc_dataset(config.source.path)) {
    for (const auto& file : {dataset->calibration, dataset->truth, dataset->camera_twists}) {
      if (file) effective.inputs.push_back(*file);
    }
  }
  return effective;
}

EffectiveConfig printed_comparison(const ConfigNode& root, const std::string& estimators) {
  EffectiveConfig effective = printed_run(bind_config<RunConfig>(root));
  const auto list = estimators.empty() ? std::nullopt : std::optional(estimators);
  for (const Variant& variant : variants_of(root, parse_variants(list))) {
    const EffectiveConfig own = printed_run(variant.config);
    std::copy(own.inputs.begin(), own.inputs.end(), std::back_inserter(effective.inputs));
  }
  return effective;
}

}  // namespace

EffectiveConfig effective_config(StudyCommand command, const ConfigNode& root,
                                 const std::string& estimators) {
  switch (command) {
    case StudyCommand::run:
      return printed_run(bind_config<RunConfig>(root));
    case StudyCommand::compare:
      return printed_comparison(root, estimators);
    case StudyCommand::hover: {
      HoverConfig config = bind_hover_config(root);
      config.plant_file.reset();  // its keys are in `plant`
      return printed(config);
    }
    case StudyCommand::simulate:
      return printed(bind_config<SimulateConfig>(root));
  }
  return {};
}

}  // namespace stillkite
