#include "io/config/config_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "io/text_file.hpp"

namespace stillkite {
namespace {

using Kind = ConfigNode::Kind;

void require_scalar(const ConfigNode& node, const std::string& key, const char* wanted) {
  if (node.kind == Kind::scalar) return;
  const char* found = node.kind == Kind::null   ? "null"
                      : node.kind == Kind::list ? "a list"
                                                : "a group of keys";
  reject_value(node, key, fmt::format("expected {}, found {}", wanted, found));
}

// std::from_chars, with an optional leading plus sign.
template <typename Number>
bool parse_all(std::string_view text, Number& value) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

void require_in_range(const ConfigNode& node, const std::string& key, const Range& range,
                      double value) {
  if (range.contains(value)) return;
  reject_value(node, key,
               fmt::format("{} is out of range, allowed: {}", node.text, print_range(range)));
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
    }
  }
  return row.back();
}

std::string suggestion(std::string_view word, std::span<const std::string_view> known) {
  const std::string_view near = nearest_name(word, known);
  return near.empty() ? std::string() : fmt::format(", did you mean '{}'?", near);
}

}  // namespace

void reject_value(const ConfigNode& node, const std::string& key, const std::string& problem) {
  throw InputError(fmt::format("{}: {}: {}", node.where(), key, problem));
}

bool read_flag(const ConfigNode& node, const std::string& key) {
  require_scalar(node, key, "true or false");
  if (node.text != "true" && node.text != "false") {
    reject_value(node, key, fmt::format("'{}' is neither true nor false", node.text));
  }
  return node.text == "true";
}

long long read_integer(const ConfigNode& node, const std::string& key, const Range& range) {
  require_scalar(node, key, "an integer");
  long long value = 0;
  if (node.quoted || !parse_all(node.text, value)) {
    reject_value(node, key, fmt::format("'{}' is not an integer", node.text));
  }
  require_in_range(node, key, range, static_cast<double>(value));
  return value;
}

double read_number(const ConfigNode& node, const std::string& key, const Range& range) {
  require_scalar(node, key, "a number");
  double value = 0;
  if (node.quoted || !parse_all(node.text, value) || !std::isfinite(value)) {
    reject_value(node, key, fmt::format("'{}' is not a finite number", node.text));
  }
  require_in_range(node, key, range, value);
  return value;
}

std::string read_string(const ConfigNode& node, const std::string& key) {
  require_scalar(node, key, "a string");
  return node.text;
}

std::filesystem::path read_path(const ConfigNode& node, const std::string& key) {
  require_scalar(node, key, "a path");
  if (node.text.empty()) return {};
  return resolve_path(node.text, node.base_folder, node.where() + ": " + key);
}

std::vector<double> read_numbers(const ConfigNode& node, const std::string& key, const Range& range,
                                 std::size_t size) {
  const std::string wanted =
      size == kAnySize ? "a list of numbers" : fmt::format("a list of {} numbers", size);
  if (node.kind != Kind::list)
    reject_value(node, key, "expected " + wanted + ", for example [1, 2]");
  if (size != kAnySize && node.items.size() != size) {
    reject_value(node, key, fmt::format("expected {}, found {}", wanted, node.items.size()));
  }
  std::vector<double> values;
  for (const ConfigNode& item : node.items) values.push_back(read_number(item, key, range));
  return values;
}

Eigen::Quaterniond unit_quaternion(const std::array<double, 4>& wxyz, const std::string& key) {
  const auto& [w, x, y, z] = wxyz;
  const Eigen::Quaterniond q(w, x, y, z);
  if (!(std::abs(q.norm() - 1.0) < 0.01)) {
    throw InputError(fmt::format("{}: the norm is {:.4g}, must be 1", key, q.norm()));
  }
  return q.normalized();
}

std::size_t read_choice(const ConfigNode& node, const std::string& key,
                        std::span<const std::string_view> names) {
  require_scalar(node, key, "one of its names");
  const auto at = std::find(names.begin(), names.end(), node.text);
  if (at == names.end()) {
    reject_value(node, key,
                 fmt::format("'{}' is not one of {}{}", node.text, fmt::join(names, ", "),
                             suggestion(node.text, names)));
  }
  return static_cast<std::size_t>(at - names.begin());
}

void reject_unknown_keys(const ConfigNode& map, const std::string& prefix,
                         std::span<const std::string_view> known) {
  if (map.kind == Kind::null) return;
  const std::string group = prefix.substr(0, prefix.size() - (prefix.empty() ? 0 : 1));
  if (map.kind != Kind::map) {
    reject_value(map, group.empty() ? "the document" : group,
                 fmt::format("expected a group of keys: {}", fmt::join(known, ", ")));
  }
  for (const auto& [key, value] : map.entries) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    reject_value(value, prefix + key,
                 fmt::format("unknown key{}; known keys{}: {}", suggestion(key, known),
                             group.empty() ? "" : " of " + group, fmt::join(known, ", ")));
  }
}

std::string_view nearest_name(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  // distance below a third of the word; the length limit bounds the cost of long input
  std::size_t least = std::min<std::size_t>(std::max<std::size_t>(2, word.size() / 3), 8) + 1;
  if (word.size() > 100) return best;
  for (const std::string_view name : known) {
    const std::size_t distance = edit_distance(word, name);
    if (distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

std::string print_number(double value) {
  return fmt::format("{}", value);
}

std::string print_text(std::string_view text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
           c == '_' || c == '.' || c == '-' || c == '+';
  };
  const bool begins_plain = !text.empty() && ((text[0] >= 'a' && text[0] <= 'z') ||
                                              (text[0] >= 'A' && text[0] <= 'Z') || text[0] == '/');
  if (begins_plain && text != "null" && text != "true" && text != "false" &&
      std::all_of(text.begin(), text.end(), is_plain)) {
    return std::string(text);
  }
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string print_range(const Range& range) {
  const bool unbounded_below = std::isinf(range.min);
  const bool unbounded_above = std::isinf(range.max);
  if (unbounded_below && unbounded_above) return "";
  return fmt::format("{}{}, {}{}", unbounded_below || range.open_min ? '(' : '[', range.min,
                     range.max, unbounded_above ? ')' : ']');
}

}  // namespace stillkite
