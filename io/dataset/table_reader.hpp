#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"
#include "io/dataset/column_name.hpp"

namespace stillkite {

enum class Separator { comma, blank };

/// Text table with a time stamp in the first column: EuRoC and telemetry CSV (comma), TUM (blank).
/// - A comma table may be separated by semicolons or tabs instead. Cells may be in double quotes,
///   lines may end with CR, LF or both.
/// - Lines that begin with # are comments. A header line may come first, plain or as a comment.
/// - Stamps are nanoseconds, unless the first column's name has [s], [ms] or [us]. In tables
///   separated by blanks they are seconds.
/// - Columns are read by position and not converted: a quantity, an axis or a unit in a column name
///   must be the expected one.
/// - Ten rows or more that are less than 0.09 ms apart have stamps of another unit.
/// Errors are InputErrors "file:line: column: problem".
class TableReader {
 public:
  /// Reads the file into memory. `min_columns`: required cells of a row, checked by next().
  /// `columns`: expected columns after the stamp.
  TableReader(const std::filesystem::path& file, Separator separator, std::size_t min_columns,
              std::vector<Column> columns = {});

  /// Advances to the next row; false at the end.
  [[nodiscard]] bool next();

  /// Time stamp of the row; throws if it does not increase, with `remedy` at the end of the
  /// message.
  [[nodiscard]] Timestamp stamp(std::string_view remedy = {});

  [[nodiscard]] double number(std::size_t column, const Range& range = kAny) const;
  [[nodiscard]] std::string_view text(std::size_t column) const { return cells_[column]; }
  [[nodiscard]] std::size_t columns() const { return cells_.size(); }
  /// Column name in the header; empty without one.
  [[nodiscard]] std::string_view name(std::size_t column) const {
    return column < names_.size() ? std::string_view(names_[column]) : std::string_view();
  }
  /// For messages: column 'NAME', or its number.
  [[nodiscard]] std::string column_name(std::size_t column) const;

  /// Throws InputError at the current row.
  [[noreturn]] void reject(const std::string& problem) const;

 private:
  void parse_names(std::string_view line);
  void check_names() const;
  void check_units() const;
  void check_interval() const;
  void split(std::string_view line);
  [[nodiscard]] std::string stamp_problem() const;
  [[nodiscard]] std::string order_problem(Timestamp stamp) const;
  [[nodiscard]] std::string column_count_problem() const;

  std::string file_;
  std::string content_;
  Separator separator_;
  char delimiter_ = ',';  // of a comma table
  std::size_t min_columns_;
  std::size_t at_ = 0;  // read position in content_
  int line_ = 0;
  int names_line_ = 0;
  bool in_rows_ = false;
  bool names_are_checked_ = false;
  std::vector<Column> columns_;
  std::vector<std::string> names_;
  int unit_exponent_;  // stamp unit = 10^unit_exponent_ ns
  std::vector<std::string_view> cells_;
  std::optional<Timestamp> first_stamp_;
  std::optional<Timestamp> last_stamp_;
  int last_stamp_line_ = 0;
  int rows_ = 0;
};

/// Time stamp of a decimal number in units of 10^unit_exponent ns, exact up to rounding to 1 ns.
/// Nullopt if the text is not a number or out of range.
[[nodiscard]] std::optional<Timestamp> parse_stamp(std::string_view text, int unit_exponent);

/// True if the decimal number has digits other than 0 after the point: 2.5, not 2.5e3.
[[nodiscard]] bool has_fraction(std::string_view number);

/// Seconds with nine decimals; parse_stamp returns the same stamp.
[[nodiscard]] std::string print_seconds(Timestamp stamp);

}  // namespace stillkite
