#include "app/variants.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "io/config/config_binding.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMaxNameLength = 40;
constexpr std::array<std::string_view, 3> kSharedSections{"source", "truth", "output"};

std::string trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t");
  if (from == std::string_view::npos) return "";
  return std::string(text.substr(from, text.find_last_not_of(" \t") - from + 1));
}

// Splits at commas outside brackets.
std::vector<std::string> split_list(std::string_view list) {
  std::vector<std::string> items;
  int depth = 0;
  std::size_t from = 0;
  for (std::size_t i = 0; i <= list.size(); ++i) {
    if (i < list.size()) {
      if (list[i] == '[' || list[i] == '{') ++depth;
      if (list[i] == ']' || list[i] == '}') --depth;
      if (list[i] != ',' || depth > 0) continue;
    }
    items.push_back(trimmed(list.substr(from, i - from)));
    from = i + 1;
  }
  return items;
}

bool is_policy(std::string_view name) {
  constexpr auto kPolicies = enum_names<Policy>();
  return std::find(kPolicies.begin(), kPolicies.end(), name) != kPolicies.end();
}

[[noreturn]] void reject_name(const std::string& name, const std::string& problem) {
  throw InputError(fmt::format("--estimators: '{}' {}", name, problem));
}

void check_name(const std::string& name, bool has_keys) {
  constexpr auto kPolicies = enum_names<Policy>();
  const bool is_word = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  });
  if (name.empty() || !is_word || name.size() > kMaxNameLength) {
    reject_name(name, fmt::format("is not a valid name (it also names a folder); use 1 to {} "
                                  "letters, digits, '-' and '_'",
                                  kMaxNameLength));
  }
  if (has_keys || is_policy(name)) return;
  const std::string_view near = nearest_name(name, kPolicies);
  const std::string suggestion = near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near);
  reject_name(name, fmt::format("is not a policy{}; use {}, or NAME:key=value,... for a custom "
                                "configuration",
                                suggestion, fmt::join(kPolicies, ", ")));
}

void add_variant_name(std::vector<VariantName>& variants, const std::string& name, bool has_keys) {
  check_name(name, has_keys);
  const bool is_taken = std::any_of(variants.begin(), variants.end(),
                                    [&](const VariantName& v) { return v.name == name; });
  if (is_taken) {
    reject_name(name, fmt::format("is a duplicate name; rename one: NAME:{}key=value",
                                  is_policy(name) ? "estimator.policy=" + name + "," : ""));
  }
  variants.push_back({.name = name, .overrides = {}});
  if (is_policy(name)) variants.back().overrides.push_back("estimator.policy=" + name);
}

}  // namespace

std::vector<VariantName> parse_variants(const std::optional<std::string>& list) {
  std::vector<VariantName> variants;
  if (!list) {
    for (const std::string_view policy : enum_names<Policy>()) {
      add_variant_name(variants, std::string(policy), false);
    }
    return variants;
  }
  for (const std::string& item : split_list(*list)) {
    const std::size_t equals = item.find('=');
    const std::size_t colon = item.substr(0, equals).find(':');
    const bool is_name = equals == std::string::npos || colon != std::string::npos;
    std::string assignment = item;
    if (is_name) {
      add_variant_name(variants, trimmed(item.substr(0, colon)), colon != std::string::npos);
      if (colon == std::string::npos) continue;
      assignment = trimmed(item.substr(colon + 1));
    } else if (variants.empty()) {
      reject_name(item, "precedes any name; write NAME:key=value");
    }
    if (equals == std::string::npos) {
      reject_name(item, "has no key=value after its colon; write NAME:key=value");
    }
    variants.back().overrides.push_back(assignment);
  }
  return variants;
}

void require_shared(const std::vector<VariantName>& variants,
                    std::span<const std::string_view> sections) {
  for (const VariantName& variant : variants) {
    for (const std::string& key : variant.overrides) {
      const std::string section = trimmed(key.substr(0, key.find_first_of(".=")));
      if (std::find(sections.begin(), sections.end(), section) == sections.end()) continue;
      reject_name(variant.name,
                  fmt::format("sets {}, but {} must be common to all; use --set", key, section));
    }
  }
}

void check_policy(const std::string& name, Policy policy) {
  if (!is_policy(name) || name_of(policy) == name) return;
  reject_name(name, fmt::format("has estimator.policy={}; use another name", name_of(policy)));
}

std::vector<Variant> variants_of(const ConfigNode& root, const std::vector<VariantName>& names) {
  require_shared(names, kSharedSections);
  return load_each<RunConfig>(names, {}, [&](const std::vector<std::string>& keys) {
    ConfigNode document = root;
    for (const std::string& key : keys) apply_override(document, key);
    return bind_config<RunConfig>(document);
  });
}

std::vector<Variant> load_variants(const std::filesystem::path& file,
                                   const std::vector<std::string>& overrides,
                                   const std::vector<VariantName>& names) {
  return variants_of(read_config(file, overrides), names);
}

}  // namespace stillkite
