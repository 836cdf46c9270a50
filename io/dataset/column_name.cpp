#include "io/dataset/column_name.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <span>
#include <utility>

namespace stillkite {
namespace {

using Words = std::vector<std::string>;

// Words of letters, in lower case, without a unit in brackets; AngVelX and angvelx are one word.
Words words_of(std::string_view name) {
  const std::size_t bracket = name.find_first_of("[(");
  const bool has_index = bracket != std::string_view::npos && bracket + 1 < name.size() &&
                         std::isdigit(static_cast<unsigned char>(name[bracket + 1])) != 0;
  Words words(1);
  for (const char c : has_index ? name : name.substr(0, bracket)) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

bool is_one_of(const std::string& word, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, word) != list.end();
}

bool has(const Words& words, std::initializer_list<std::string_view> list) {
  return std::ranges::any_of(words, [&](const std::string& word) { return is_one_of(word, list); });
}

char axis_named(const std::string& word) {
  constexpr auto kNames = std::to_array<std::pair<std::string_view, char>>(
      {{"east", 'x'}, {"north", 'y'}, {"up", 'z'}, {"down", 'd'}});
  for (const auto& [name, axis] : kNames) {
    if (word == name) return axis;
  }
  return word.size() == 1 && std::string_view("xyzw").find(word[0]) != std::string_view::npos
             ? word[0]
             : '\0';
}

// Splits the axis off a last word such as accx, wx, posx; not off max or index.
char split_axis(Words& words) {
  std::string& last = words.back();
  const bool is_velocity = words.front().starts_with('v');  // vn, vel_n
  const bool is_direction = last == "vn" || last == "ve" || last == "vd" ||
                            (words.size() > 1 && (last == "n" || last == "e" || last == "d"));
  if (is_velocity && is_direction) {
    const char direction = last.back();
    words = {"velocity"};
    return direction == 'n' ? 'y' : direction == 'e' ? 'x' : 'd';
  }
  if (const char axis = axis_named(last); axis != 0) {
    if (words.size() > 1) words.pop_back();
    return axis;
  }
  const char axis = last.back();
  if (std::string_view("xyzw").find(axis) == std::string_view::npos) return 0;
  const std::string stem = last.substr(0, last.size() - 1);
  const bool is_known =
      is_one_of(stem, {"a",   "w",      "v",    "p",     "q",      "t",        "acc",
                       "gyr", "accel",  "gyro", "omega", "vel",    "velocity", "pos",
                       "mag", "magnet", "quat", "force", "angvel", "position"});
  if (!is_known) return 0;
  last = stem == "t" ? "translation" : stem;
  words.erase(words.begin(), words.end() - 1);
  return axis;
}

std::optional<Quantity> quantity_named(const Words& words) {
  const bool is_angular = has(words, {"angular", "ang", "rotational"});
  if (has(words, {"lat", "lon", "lng", "latitude", "longitude"})) {
    return Quantity::latitude_longitude;
  }
  if (has(words, {"magnetic", "magnetometer", "mag", "magnet", "magfield"})) {
    return Quantity::magnetic_field;
  }
  if (has(words, {"acceleration", "accelerometer", "accel", "acc", "force"})) {
    return is_angular ? Quantity::angular_acceleration : Quantity::acceleration;
  }
  if (has(words, {"gyro", "gyr", "gyroscope", "omega", "angvel"}) ||
      (is_angular && has(words, {"velocity", "vel", "rate", "speed"}))) {
    return Quantity::angular_rate;
  }
  if (has(words, {"velocity", "vel", "speed"})) return Quantity::velocity;
  if (has(words, {"quaternion", "quat", "orientation"})) return Quantity::quaternion;
  if (has(words, {"position", "pos", "translation"})) return Quantity::position;
  if (has(words, {"roll", "pitch", "yaw", "heading"}) && words.size() == 1) {
    return Quantity::euler_angle;
  }
  if (words.size() == 1 && is_one_of(words[0], {"id", "seq", "index", "idx", "count"})) {
    return Quantity::counter;
  }
  if (has(words, {"time", "timestamp", "timestamps", "stamp"})) return Quantity::time;
  return std::nullopt;
}

// First letter of EuRoC's names: p_RS_R, v_RS_R, w_RS_S, a_RS_S, q_RS.
std::optional<Quantity> quantity_of_symbol(const std::string& symbol) {
  constexpr auto kSymbols =
      std::to_array<std::pair<std::string_view, Quantity>>({{"p", Quantity::position},
                                                            {"v", Quantity::velocity},
                                                            {"a", Quantity::acceleration},
                                                            {"w", Quantity::angular_rate},
                                                            {"q", Quantity::quaternion}});
  for (const auto& [name, quantity] : kSymbols) {
    if (symbol == name) return quantity;
  }
  return std::nullopt;
}

}  // namespace

Column column_named(std::string_view name) {
  Words words = words_of(name);
  if (words.empty()) return {};
  const bool is_axis_alone = words.size() == 1 && axis_named(words[0]) != 0;
  Column column{.quantity = std::nullopt, .axis = split_axis(words)};
  if (is_axis_alone) return column.axis == 'w' ? Column{} : column;
  column.quantity = quantity_named(words);
  if (!column.quantity && column.axis != 0) column.quantity = quantity_of_symbol(words[0]);
  if (!column.quantity) return {};
  return column;
}

bool is_compatible(const Column& named, const Column& expected) {
  const bool same_quantity =
      !named.quantity || !expected.quantity || *named.quantity == *expected.quantity ||
      (*expected.quantity == Quantity::height && *named.quantity == Quantity::position);
  const char expected_axis = expected.quantity == Quantity::height ? 'z' : expected.axis;
  return same_quantity && (named.axis == 0 || expected_axis == 0 || named.axis == expected_axis);
}

std::string_view name_of(Quantity quantity) {
  constexpr std::array<std::string_view, 12> kNames{
      "time stamp",  "counter",       "position",     "latitude or longitude", "height",
      "velocity",    "acceleration",  "angular rate", "angular acceleration",  "quaternion",
      "Euler angle", "magnetic field"};
  return kNames.at(static_cast<std::size_t>(quantity));
}

std::string description_of(const Column& column) {
  const std::string_view name = column.quantity ? name_of(*column.quantity) : "component";
  if (column.axis == 0) return std::string(name);
  return fmt::format("{} {}", name,
                     column.axis == 'd' ? "down" : std::string_view(&column.axis, 1));
}

std::string description_of(std::span<const Column> columns) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const bool is_new = i == 0 || columns[i].quantity != columns[i - 1].quantity;
    text += is_new ? description_of(columns[i]) : std::string(1, columns[i].axis);
    if (i + 1 < columns.size()) text += ", ";
  }
  return text;
}

std::optional<Unit> unit_of(const Column& column) {
  if (!column.quantity) return std::nullopt;
  switch (*column.quantity) {
    case Quantity::position:
    case Quantity::height:
      return Unit::metre;
    case Quantity::velocity:
      return Unit::metre_per_s;
    case Quantity::acceleration:
      return Unit::metre_per_s2;
    case Quantity::angular_rate:
      return Unit::radian_per_s;
    case Quantity::angular_acceleration:
      return Unit::radian_per_s2;
    default:
      return std::nullopt;
  }
}

std::vector<Column> vector_columns(std::initializer_list<Quantity> quantities) {
  std::vector<Column> columns;
  for (const Quantity quantity : quantities) {
    for (const char axis : {'x', 'y', 'z'}) columns.push_back({quantity, axis});
  }
  return columns;
}

}  // namespace stillkite
