#include "io/config/config_node.hpp"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "geometry/fields.hpp"
#include "io/config/renamed_keys.hpp"
#include "io/recording_format.hpp"
#include "io/text_file.hpp"

namespace stillkite {
namespace {

// Bounds the expansion of nested aliases ("billion laughs").
constexpr int kMaxNodes = 100'000;
constexpr int kMaxDepth = 32;

// The braces of ${NAME} while the text is parsed: private characters, since YAML reads { and } as a
// map in flow style, {path: ${DATA}/flight.mp4}.
constexpr std::string_view kOpen = "\uE000";
constexpr std::string_view kClose = "\uE001";

std::string replace_all(std::string_view text, std::string_view from, std::string_view to) {
  std::string out;
  for (std::size_t at; (at = text.find(from)) != std::string_view::npos;) {
    out.append(text.substr(0, at)).append(to);
    text.remove_prefix(at + from.size());
  }
  return out.append(text);
}

std::string hide_variables(std::string_view text) {
  std::string out;
  for (std::size_t open; (open = text.find("${")) != std::string_view::npos;) {
    out.append(text.substr(0, open + 1));
    text.remove_prefix(open + 2);
    const std::size_t close = text.find_first_of("{}\n");
    if (close == std::string_view::npos || text[close] != '}') {
      out += '{';
      continue;
    }
    out.append(kOpen).append(text.substr(0, close)).append(kClose);
    text.remove_prefix(close + 1);
  }
  return out.append(text);
}

std::string restore_variables(std::string_view text) {
  return replace_all(replace_all(text, kOpen, "{"), kClose, "}");
}

class Converter {
 public:
  Converter(std::string origin, std::filesystem::path base_folder)
      : origin_(std::move(origin)), base_folder_(std::move(base_folder)) {}

  ConfigNode convert(const YAML::Node& from, YAML::Mark mark, int depth) {
    ConfigNode to;
    to.origin = origin_;
    to.base_folder = base_folder_;
    to.line = std::max(0, mark.line + 1);
    to.column = std::max(0, mark.column + 1);
    if (++nodes_ > kMaxNodes || depth > kMaxDepth) {
      throw InputError(fmt::format("{}: more than {} values or {} levels; not a configuration file",
                                   to.where(), kMaxNodes, kMaxDepth));
    }
    if (from.IsScalar()) {
      to.text = restore_variables(from.Scalar());
      to.quoted = from.Tag() == "!";
      to.kind = ConfigNode::Kind::scalar;
    } else if (from.IsSequence()) {
      to.kind = ConfigNode::Kind::list;
      for (const YAML::Node& item : from) to.items.push_back(convert(item, item.Mark(), depth + 1));
    } else if (from.IsMap()) {
      to.kind = ConfigNode::Kind::map;
      for (const auto& entry : from) add_entry(to, entry.first, entry.second, depth);
    }
    return to;
  }

 private:
  void add_entry(ConfigNode& map, const YAML::Node& key, const YAML::Node& value, int depth) {
    ConfigNode node = convert(value, key.Mark(), depth + 1);
    if (!key.IsScalar()) throw InputError(node.where() + ": a key must be a scalar");
    if (map.find(key.Scalar()) != nullptr) {
      throw InputError(
          fmt::format("{}: key '{}' is given twice; keep one", node.where(), key.Scalar()));
    }
    map.entries.emplace_back(key.Scalar(), std::move(node));
  }

  std::string origin_;
  std::filesystem::path base_folder_;
  int nodes_ = 0;
};

// True if content follows "..." or precedes a "---" line. YAML::LoadAll hangs on some invalid
// documents, so the marks are searched in the text.
bool has_second_document(std::string_view text) {
  bool has_content = false;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::size_t first = line.find_first_not_of(" \t\r");
    const bool is_marker = line.size() == 3 || line.find_first_of(" \t\r") == 3;
    const bool is_start = line.starts_with("---") && is_marker;
    if (is_start && has_content) return true;
    if (line.starts_with("...") && is_marker) {
      return text.find_first_not_of(" \t\r\n") != std::string_view::npos;
    }
    const bool is_comment =
        first == std::string_view::npos || line[first] == '#' || line.starts_with('%') || is_start;
    if (!is_comment) has_content = true;
  }
  return false;
}

auto* find_in(auto& map, std::string_view key) {
  const auto at = std::find_if(map.entries.begin(), map.entries.end(),
                               [&](const auto& entry) { return entry.first == key; });
  return at == map.entries.end() ? nullptr : &at->second;
}

ConfigNode parse_override_value(const std::string& text, const std::string& origin) {
  const std::filesystem::path here = std::filesystem::current_path();
  ConfigNode node;
  if (text.starts_with('[') || text.starts_with('{')) {
    node = parse_yaml(text, origin, here);
  } else {
    const bool null = text.empty() || text == "null" || text == "~";
    node.kind = null ? ConfigNode::Kind::null : ConfigNode::Kind::scalar;
    node.text = text;
    node.origin = origin;
    node.base_folder = here;
  }
  node.line = 0;
  return node;
}

// Once each: a comparison reads one file for every estimator.
void print_notices(const std::vector<std::string>& notices) {
  static std::set<std::string> printed;
  for (const std::string& notice : notices) {
    if (printed.insert(notice).second) fmt::print(stderr, "stillkite: {}\n", notice);
  }
}

// Sets the value at a dotted path; creates missing groups of keys. Accepts renamed and removed
// keys.
void set_value(ConfigNode& root, std::string_view path, ConfigNode value) {
  ConfigNode* at = &root;
  while (!path.empty()) {
    if (at->kind != ConfigNode::Kind::map) {
      *at = {.kind = ConfigNode::Kind::map, .origin = value.origin};
    }
    const std::size_t dot = path.find('.');
    const std::string key(path.substr(0, dot));
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
    if (find_in(*at, key) == nullptr) at->entries.emplace_back(key, ConfigNode{});
    at = find_in(*at, key);
  }
  *at = std::move(value);
  print_notices(move_renamed_keys(root, "", true));
  print_notices(drop_removed_keys(root, ""));
}

void apply_group(ConfigNode& root, const std::string& prefix, const ConfigNode& group) {
  for (const auto& [key, value] : group.entries) {
    if (value.kind == ConfigNode::Kind::map && !value.entries.empty()) {
      apply_group(root, prefix + key + '.', value);
      continue;
    }
    set_value(root, prefix + key, value);
  }
}

}  // namespace

std::string ConfigNode::where() const {
  return line > 0 ? fmt::format("{}:{}:{}", origin, line, column) : origin;
}

const ConfigNode* ConfigNode::find(std::string_view key) const {
  return find_in(*this, key);
}

ConfigNode parse_yaml(const std::string& text, const std::string& origin,
                      const std::filesystem::path& base_folder) {
  try {
    if (has_second_document(text)) {
      throw InputError(origin + ": more than one YAML document (---); keep one");
    }
    const YAML::Node root = YAML::Load(hide_variables(text));
    return Converter(origin, base_folder).convert(root, root.Mark(), 0);
  } catch (const YAML::Exception& error) {
    const bool is_tab = text.find('\t') != std::string::npos;
    throw InputError(fmt::format(
        "{}:{}:{}: invalid YAML: {}{}", origin, error.mark.line + 1, error.mark.column + 1,
        error.msg, is_tab ? "; YAML indentation must be spaces, the text contains a tab" : ""));
  }
}

ConfigNode read_yaml(const std::filesystem::path& file) {
  reject_recording(file);
  const std::string text = read_bytes(file);
  if (text.find('\0') != std::string::npos) {
    throw InputError(file.string() +
                     ": not a UTF-8 text file; expected a YAML file. Give a video as "
                     "source: {path: VIDEO} in a YAML file");
  }
  return parse_yaml(text, file.string(), std::filesystem::absolute(file).parent_path());
}

void apply_override(ConfigNode& root, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string origin = "--set " + assignment;
  if (equals == 0 || equals == std::string::npos) {
    throw InputError(origin + ": expected key=value, for example source.start_s=2.5");
  }
  set_value(root, std::string_view(assignment).substr(0, equals),
            parse_override_value(assignment.substr(equals + 1), origin));
}

void apply_settings(ConfigNode& root, const ConfigNode& settings) {
  apply_group(root, "", settings);
}

ConfigNode read_config(const std::optional<std::filesystem::path>& file,
                       const std::vector<std::string>& overrides) {
  ConfigNode root{.kind = ConfigNode::Kind::map};
  if (file) root = read_config_section(*file, "");
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  return root;
}

ConfigNode read_config_section(const std::filesystem::path& file, std::string_view prefix) {
  ConfigNode root = read_yaml(file);
  print_notices(move_renamed_keys(root, prefix, false));
  print_notices(drop_removed_keys(root, prefix));
  return root;
}

}  // namespace stillkite
