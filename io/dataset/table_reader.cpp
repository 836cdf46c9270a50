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
  return fmt::format("{}{}", cell.substr(0, kMax), cell.size() > kMax ? "..." : "");
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

// Lines end with LF; without any, CR ends them.
std::string with_line_feeds(std::string text) {
  if (text.find('\n') == std::string::npos) std::ranges::replace(text, '\r', '\n');
  return text;
}

std::string_view first_row(std::string_view content) {
  while (!content.empty()) {
    const std::size_t end = std::min(content.find('\n'), content.size());
    const std::string_view line = trimmed(content.substr(0, end));
    if (!line.empty() && line[0] != '#') return line;
    content.remove_prefix(std::min(end + 1, content.size()));
  }
  return {};
}

// Semicolons are used with decimal commas, so they come first.
char delimiter_of(std::string_view row) {
  for (const char delimiter : {';', ',', '\t'}) {
    if (row.find(delimiter) != std::string_view::npos) return delimiter;
  }
  return ',';
}

std::string_view unquoted(std::string_view cell) {
  const bool is_quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return is_quoted ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

}  // namespace

TableReader::TableReader(const std::filesystem::path& file, Separator separator,
                         std::size_t min_columns, std::vector<Column> columns)
    : file_(file.string()),
      content_(with_line_feeds(read_text_file(file))),
      separator_(separator),
      delimiter_(delimiter_of(first_row(content_))),
      min_columns_(min_columns),
      columns_(std::move(columns)),
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
    if (!std::exchange(names_are_checked_, true)) {
      check_names();
      check_units();
    }
    if (cells_.size() < min_columns_) reject(column_count_problem());
    // a comment with few names is not a header; a trailing comma adds no cell
    const std::size_t filled = cells_.size() - (cells_.back().empty() ? 1 : 0);
    if (names_.size() >= min_columns_ && filled > names_.size()) {
      reject(fmt::format("{} columns, but the header names {}; do not use decimal commas", filled,
                         names_.size()));
    }
    ++rows_;
    return true;
  }
  check_interval();
  return false;
}

Timestamp TableReader::stamp(std::string_view remedy) {
  const std::optional<Timestamp> stamp = parse_stamp(cells_[0], unit_exponent_);
  if (!stamp) reject(stamp_problem());
  if (unit_exponent_ == 0 && has_fraction(cells_[0])) {
    reject(
        fmt::format("time stamp '{}' is not an integer of nanoseconds; for seconds name the column "
                    "'timestamp [s]' in the header",
                    abbreviated(cells_[0])));
  }
  if (last_stamp_ && *stamp <= *last_stamp_) {
    reject(fmt::format("{}{}", order_problem(*stamp), remedy));
  }
  if (!first_stamp_) first_stamp_ = stamp;
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
    const bool has_comma = cell.find(',') != std::string_view::npos;
    reject(fmt::format("{}: '{}' is not a finite number{}", column_name(column), abbreviated(cell),
                       has_comma ? "; use decimal points" : ""));
  }
  if (!range.contains(value)) {
    reject(fmt::format("{}: {} is out of range, allowed: {}{}, {}]", column_name(column),
                       abbreviated(cell), range.open_min ? '(' : '[', range.min, range.max));
  }
  return value;
}

void TableReader::reject(const std::string& problem) const {
  const bool is_cut = at_ > content_.size();  // no line end
  throw InputError(fmt::format(
      "{}:{}: {}{}", file_, line_, problem,
      is_cut && line_ > 1 ? "; the file ends within this line: remove it if it is incomplete"
                          : ""));
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
  for (std::size_t i = 0; i < columns_.size() && i + 1 < names_.size(); ++i) {
    const std::optional<Unit> expected = unit_of(columns_[i]);
    if (!expected || unit_in(names_[i + 1]).value_or(*expected) == *expected) continue;
    throw InputError(fmt::format("{}: column '{}' must be in {}; convert it or reorder the columns",
                                 line, names_[i + 1], symbol_of(*expected)));
  }
}

// A comment of few words is not a header.
void TableReader::check_names() const {
  if (names_.size() < std::min(min_columns_, cells_.size())) return;
  const auto reject_name = [&](const std::string& name, const std::string& problem) {
    throw InputError(fmt::format("{}:{}: column '{}': {}", file_, names_line_, name, problem));
  };
  const Column first = column_named(names_[0]);
  if (first.quantity && *first.quantity != Quantity::time) {
    reject_name(names_[0], fmt::format("{} by its name; the first column must be the time stamp",
                                       description_of(first)));
  }
  for (std::size_t i = 0; i < columns_.size() && i + 1 < names_.size(); ++i) {
    const Column named = column_named(names_[i + 1]);
    if (is_compatible(named, columns_[i])) continue;
    if (named.quantity == Quantity::latitude_longitude) {
      reject_name(names_[i + 1],
                  "positions must be in metres, x, y, z in one local frame (for example east, "
                  "north, up); convert latitude and longitude");
    }
    reject_name(
        names_[i + 1],
        fmt::format("{} by its name, expected {}; the column order is time stamp, {}",
                    description_of(named), description_of(columns_[i]), description_of(columns_)));
  }
}

void TableReader::split(std::string_view line) {
  cells_.clear();
  if (separator_ == Separator::comma) {
    for (std::size_t end; (end = line.find(delimiter_)) != std::string_view::npos;) {
      cells_.push_back(unquoted(trimmed(line.substr(0, end))));
      line.remove_prefix(end + 1);
    }
    cells_.push_back(unquoted(trimmed(line)));
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
    return fmt::format(
        "'{}' is not a time stamp; expected a number{}", cell,
        in_rows_ && !looks_like_data(cells_[0]) ? ", remove lines of text from the table" : "");
  }
  return fmt::format("time stamp '{}' is too large for seconds, but plausible as {}; {}", cell,
                     unit_of_large_stamp(cells_[0]),
                     separator_ == Separator::blank
                         ? "a file separated by blanks (TUM) has seconds: convert the stamps"
                         : "name their unit in the header: [ms], [us] or [ns]");
}

// Rows out of order are a few intervals early; a clock that restarts goes back further.
std::string TableReader::order_problem(Timestamp stamp) const {
  constexpr double kMinReset_s = 0.5;
  const double back_s = seconds_between(stamp, *last_stamp_);
  const std::string cell = abbreviated(cells_[0]);
  if (back_s == 0) {
    return fmt::format("time stamp {} repeats that of line {}; sort the file and remove duplicates",
                       cell, last_stamp_line_);
  }
  if (back_s < kMinReset_s) {
    return fmt::format(
        "time stamp {} is earlier than that of line {}; sort the file and remove duplicates", cell,
        last_stamp_line_);
  }
  return fmt::format(
      "time stamp {} is {:.3g} s earlier than that of line {}: the clock was reset, or a counter "
      "wrapped; correct the stamps from here, or remove one part",
      cell, back_s, last_stamp_line_);
}

// No sensor has 10 000 readings per second.
void TableReader::check_interval() const {
  constexpr double kMinInterval_s = 0.9e-4;
  constexpr int kMinRows = 10;
  const bool has_unit = !names_.empty() && unit_in_brackets(names_[0]);
  if (separator_ == Separator::blank || has_unit || rows_ < kMinRows || !first_stamp_) return;
  const double interval_s = seconds_between(*first_stamp_, *last_stamp_) / (rows_ - 1);
  if (interval_s >= kMinInterval_s || interval_s == 0) return;
  const bool is_micro = 1e3 * interval_s >= kMinInterval_s;
  throw InputError(fmt::format(
      "{}: the rows are {:.2g} s apart; their time stamps are probably {}: name the first column "
      "'timestamp [{}]'",
      file_, interval_s, is_micro ? "microseconds" : "milliseconds", is_micro ? "us" : "ms"));
}

std::string TableReader::column_count_problem() const {
  if (separator_ == Separator::blank) {
    return fmt::format("{} columns, expected at least {} separated by blanks", cells_.size(),
                       min_columns_);
  }
  const bool by_blanks = cells_.size() == 1 && cells_[0].find(' ') != std::string_view::npos;
  return fmt::format("{} columns, expected at least {} separated by commas{}", cells_.size(),
                     min_columns_,
                     by_blanks ? "; this line is separated by blanks: use commas" : "");
}

std::string TableReader::column_name(std::size_t column) const {
  return column < names_.size() ? fmt::format("column '{}'", names_[column])
                                : fmt::format("column {}", column + 1);
}

}  // namespace stillkite
