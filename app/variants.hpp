#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/config/run_config.hpp"

namespace stillkite {

/// One of several configurations that are compared on the same input.
struct VariantName {
  std::string name;                    ///< letters, digits, '-' and '_'; no two are equal
  std::vector<std::string> overrides;  ///< key=value, its policy's among them
};

/// Reads a list such as
///
///     flow,reference,last:estimator.policy=flow,navigator.keyframes.enabled=false
///
/// A name is a policy, or followed by a colon and its own keys; what has an equals sign belongs to
/// the name before it. A comma within brackets divides nothing. A name that is a policy sets
/// estimator.policy, any other keeps the configuration's. Nothing: every policy that there is.
/// Throws InputError on a name that is unknown, given twice or cannot be a folder's, and on an
/// empty list.
[[nodiscard]] std::vector<VariantName> parse_variants(const std::optional<std::string>& list);

/// Throws InputError where a variant sets a key of these sections, which must not differ.
void require_shared(const std::vector<VariantName>& variants,
                    std::span<const std::string_view> sections);

/// Throws InputError where a variant's name is a policy's, but the policy set by its keys another.
void check_policy(const std::string& name, Policy policy);

/// A name with its configuration.
template <typename Config>
struct VariantOf {
  std::string name;
  std::vector<std::string> overrides;
  Config config;
};
using Variant = VariantOf<RunConfig>;

/// For each name what `load` makes of all keys, its own last. Throws InputError as `load`, with the
/// name where the fault is that variant's.
template <typename Config, typename Load>
[[nodiscard]] std::vector<VariantOf<Config>> load_each(const std::vector<VariantName>& names,
                                                       const std::vector<std::string>& overrides,
                                                       Load&& load) {
  (void)load(overrides);  // what is wrong for all is not one variant's fault
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

/// The configuration of a file under the command line's key=value's, once for each name, its own
/// keys last. Images, truth and output are the same for all. Throws InputError as
/// load_run_config.
[[nodiscard]] std::vector<Variant> load_variants(const std::filesystem::path& file,
                                                 const std::vector<std::string>& overrides,
                                                 const std::vector<VariantName>& names);

}  // namespace stillkite
