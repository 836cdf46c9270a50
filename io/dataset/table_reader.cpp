#include "io/dataset/table_reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "io/text_file.hpp"

namespace stillkite {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\f\v";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// A number, or a word for a missing one; a header cell is neither.
bool looks_like_data(std::string_view cell) {
  if (cell.empty()) return true;
  const auto c = static_cast<unsigned char>(cell[0]);
  if (std::isdigit(c) != 0 || c == '-' || c == '+' || c == '.') return true;
  std::string lower(cell);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char x) { return static_cast<char>(std::tolower(x)); });
  return lower == "nan" || lower == "inf" || lower == "null" || lower == "none";
}

std::string abbreviated(std::string_view cell) {
  constexpr std::size_t kMax = 40;
  return cell.size() <= kMax ? std::string(cell) : std::string(cell.substr(0, kMax)) + "...";
}

// Unit of a stamp since 1970 by its digits: seconds have 10.
std::string_view unit_of_large_stamp(std::string_view cell) {
  switch (cell.substr(0, cell.find('.')).size()) {
    case 13:
      return "milliseconds";
    case 16:
      return "microseconds";
    case 19:
      return "nanoseconds";
    default:
      return "milliseconds, microseconds or nanoseconds";
  }
}

bool is_geographic(std::string_view column_name) {
  std::string name(column_name);
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::size_t end = name.find_first_of(" _[(");
  const std::string word = name.substr(0, end);
  return word == "lat" || word == "lon" || word == "lng" || word == "latitude" ||
         word == "longitude";
}

}  // namespace

TableReader::TableReader(const std::filesystem::path& file, Separator separator,
                         std::size_t min_columns, std::vector<Unit> units)
    : file_(file.string()),
      content_(read_text_file(file)),
      separator_(separator),
      min_columns_(min_columns),
      units_(std::move(units)),
      unit_exponent_(separator == Separator::blank ? 9 : 0) {}

bool TableReader::next() {
  while (at_ < content_.size()) {
    const std::size_t end = std::min(content_.find('\n', at_), content_.size());
    std::string_view line = trimmed(std::string_view(content_).substr(at_, end - at_));
    at_ = end + 1;
    if (++line_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    if (line.empty()) continue;
    if (line[0] == '#') {
      if (!in_rows_) parse_names(line.substr(1));
      continue;
    }
    split(line);
    if (!in_rows_ && !looks_like_data(cells_[0])) {
      parse_names(line);
      in_rows_ = true;
      continue;
    }
    in_rows_ = true;
    if (!std::exchange(units_are_checked_, true)) check_units();
    if (cells_.size() < min_columns_) {
      reject(fmt::format("{} columns, expected at least {} separated by {}", cells_.size(),
                         min_columns_, separator_ == Separator::comma ? "commas" : "blanks"));
    }
    // a comment with few names is not a header; a trailing comma adds no cell
    const std::size_t filled = cells_.size() - (cells_.back().empty() ? 1 : 0);
    if (names_.size() >= min_columns_ && filled > names_.size()) {
      reject(fmt::format("{} columns, but the header names {}; do not use decimal commas", filled,
                         names_.size()));
    }
    return true;
  }
  return false;
}

Timestamp TableReader::stamp() {
  const std::optional<Timestamp> stamp = parse_stamp(cells_[0], unit_exponent_);
  if (!stamp) reject(stamp_problem());
  const std::size_t point = cells_[0].find('.');
  if (unit_exponent_ == 0 && point != std::string_view::npos &&
      cells_[0].find_first_not_of('0', point + 1) != std::string_view::npos) {
    reject(
        fmt::format("time stamp '{}' is not an integer of nanoseconds; for seconds name the column "
                    "'timestamp [s]' in the header",
                    abbreviated(cells_[0])));
  }
  if (last_stamp_ && *stamp <= *last_stamp_) {
    reject(fmt::format(
        "time stamp {} {} line {}; sort the file and remove duplicates", abbreviated(cells_[0]),
        *stamp == *last_stamp_ ? "repeats that of" : "is earlier than that of", last_stamp_line_));
  }
  last_stamp_ = stamp;
  last_stamp_line_ = line_;
  return *stamp;
}

double TableReader::number(std::size_t column, const Range& range) const {
  std::string_view cell = cells_[column];
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    reject(fmt::format("{}: '{}' is not a finite number", column_name(column), abbreviated(cell)));
  }
  if (!range.contains(value)) {
    reject(fmt::format("{}: {} is out of range, allowed: {}{}, {}]", column_name(column),
                       abbreviated(cell), range.open_min ? '(' : '[', range.min, range.max));
  }
  return value;
}

void TableReader::reject(const std::string& problem) const {
  throw InputError(fmt::format("{}:{}: {}", file_, line_, problem));
}

void TableReader::parse_names(std::string_view line) {
  split(trimmed(line));
  names_line_ = line_;
  names_.assign(cells_.begin(), cells_.end());
  if (separator_ == Separator::blank) return;
  switch (unit_in_brackets(names_[0]).value_or(Unit::nanosecond)) {
    case Unit::second:
      unit_exponent_ = 9;
      break;
    case Unit::millisecond:
      unit_exponent_ = 6;
      break;
    case Unit::microsecond:
      unit_exponent_ = 3;
      break;
    default:
      unit_exponent_ = 0;
      break;
  }
}

void TableReader::check_units() const {
  if (separator_ == Separator::blank || names_.empty()) return;
  const std::string line = fmt::format("{}:{}", file_, names_line_);
  const Unit stamps = unit_in(names_[0]).value_or(Unit::nanosecond);
  const bool is_converted = unit_in_brackets(names_[0]) && stamps <= Unit::second;
  if (stamps != Unit::nanosecond && !is_converted) {
    throw InputError(
        fmt::format("{}: column '{}': time stamps must be nanoseconds, or have the unit [s], [ms] "
                    "or [us] in the name",
                    line, names_[0]));
  }
  for (std::size_t i = 0; i < units_.size() && i + 1 < names_.size(); ++i) {
    if (units_[i] == Unit::metre && is_geographic(names_[i + 1])) {
      throw InputError(fmt::format(
          "{}: column '{}': positions must be in metres, x, y, z in one local frame (for "
          "example east, north, up); convert latitude and longitude",
          line, names_[i + 1]));
    }
    if (unit_in(names_[i + 1]).value_or(units_[i]) == units_[i]) continue;
    throw InputError(fmt::format("{}: column '{}' must be in {}; convert it or reorder the columns",
                                 line, names_[i + 1], symbol_of(units_[i])));
  }
}

void TableReader::split(std::string_view line) {
  cells_.clear();
  if (separator_ == Separator::comma) {
    for (std::size_t comma; (comma = line.find(',')) != std::string_view::npos;) {
      cells_.push_back(trimmed(line.substr(0, comma)));
      line.remove_prefix(comma + 1);
    }
    cells_.push_back(trimmed(line));
    return;
  }
  while (!(line = trimmed(line)).empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    cells_.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  if (cells_.empty()) cells_.emplace_back();
}

std::string TableReader::stamp_problem() const {
  const std::string cell = abbreviated(cells_[0]);
  constexpr int kNanosecond = 0, kSecond = 9;
  if (unit_exponent_ != kSecond || !parse_stamp(cells_[0], kNanosecond)) {
    return fmt::format("'{}' is not a time stamp", cell);
  }
  return fmt::format("time stamp '{}' is too large for seconds, but plausible as {}; {}", cell,
                     unit_of_large_stamp(cells_[0]),
                     separator_ == Separator::blank
                         ? "a file separated by blanks (TUM) has seconds: convert the stamps"
                         : "name their unit in the header: [ms], [us] or [ns]");
}

std::string TableReader::column_name(std::size_t column) const {
  return column < names_.size() ? fmt::format("column '{}'", names_[column])
                                : fmt::format("column {}", column + 1);
}

}  // namespace stillkite
