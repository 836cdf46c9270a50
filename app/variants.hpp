#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/config/config_node.hpp"
#include "io/config/run_config.hpp"

namespace stillkite {

/// One of several configurations to compare on the same input.
struct VariantName {
  std::string name;                    ///< letters, digits, '-' and '_'; unique
  std::vector<std::string> overrides;  ///< key=value, including its policy
};

/// Parses a list such as
///
///     flow,reference,last:estimator.policy=flow,navigator.keyframes.enabled=false
///
/// A name is a policy, or is followed by a colon and its keys. An item with an equals sign belongs
/// to the name before it. Commas within brackets do not separate. A name that is a policy sets
/// estimator.policy; any other keeps the configuration's. nullopt: all policies. Throws InputError
/// on an unknown, duplicate or invalid name and on an empty list.
[[nodiscard]] std::vector<VariantName> parse_variants(const std::optional<std::string>& list);

/// Throws InputError if a variant sets a key of these sections, which must be common to all.
void require_shared(const std::vector<VariantName>& variants,
                    std::span<const std::string_view> sections);

/// Throws InputError if a variant is named after a policy but its keys set another one.
void check_policy(const std::string& name, Policy policy);

/// Named configuration.
template <typename Config>
struct VariantOf {
  std::string name;
  std::vector<std::string> overrides;
  Config config;
};
using Variant = VariantOf<RunConfig>;

/// Loads one configuration per name, from the common overrides and then its own. Throws InputError
/// as `load`, with the variant's name if its own keys cause the error.
template <typename Config, typename Load>
[[nodiscard]] std::vector<VariantOf<Config>> load_each(const std::vector<VariantName>& names,
                                                       const std::vector<std::string>& overrides,
                                                       Load&& load) {
  (void)load(overrides);  // reports errors of the common keys without a variant's name
  std::vector<VariantOf<Config>> variants;
  variants.reserve(names.size());
  for (const VariantName& name : names) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), name.overrides.begin(), name.overrides.end());
    try {
      variants.push_back({name.name, name.overrides, load(all)});
    } catch (const InputError& error) {
      throw InputError("--estimators " + name.name + ": " + error.what());
    }
    check_policy(name.name, variants.back().config.estimator.policy);
  }
  return variants;
}

/// Binds a document once per name, with the variant's keys. Source, truth and output are common to
/// all. Throws InputError as load_run_config.
[[nodiscard]] std::vector<Variant> variants_of(const ConfigNode& root,
                                               const std::vector<VariantName>& names);

/// Loads the run configuration of a file once per name: command-line overrides, then the variant's
/// keys, as variants_of.
[[nodiscard]] std::vector<Variant> load_variants(const std::filesystem::path& file,
                                                 const std::vector<std::string>& overrides,
                                                 const std::vector<VariantName>& names);

}  // namespace stillkite
