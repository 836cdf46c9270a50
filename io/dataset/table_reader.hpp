#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"
#include "io/dataset/unit_name.hpp"

namespace stillkite {

enum class Separator { comma, blank };

/// A text table with a stamp in its first column: EuRoC and telemetry CSV (comma), TUM (blank).
/// Lines that begin with # are comments; one line of names may come first, bare or as a comment.
/// Stamps are nanoseconds unless the first column's name has [s], [ms] or [us]; in a table that is
/// separated by blanks they are seconds. Nothing else is converted: a column whose name gives
/// another unit than it is read in is refused.
/// Every problem is an InputError "file:line: column: problem".
class TableReader {
 public:
  /// Reads the file; rows with fewer cells than `min_columns` are errors later. `units` are those
  /// of the columns after the stamp.
  TableReader(const std::filesystem::path& file, Separator separator, std::size_t min_columns,
              std::vector<Unit> units = {});

  /// Moves to the next row; false at the end.
  [[nodiscard]] bool next();

  /// The row's stamp; throws unless it is later than that of the row before.
  [[nodiscard]] Timestamp stamp();

  [[nodiscard]] double number(std::size_t column, const Range& range = kAny) const;
  [[nodiscard]] std::string_view text(std::size_t column) const { return cells_[column]; }
  [[nodiscard]] std::size_t columns() const { return cells_.size(); }
  /// As the file names it; empty where it does not.
  [[nodiscard]] std::string_view name(std::size_t column) const {
    return column < names_.size() ? std::string_view(names_[column]) : std::string_view();
  }

  /// Throws InputError at the current row.
  [[noreturn]] void reject(const std::string& problem) const;

 private:
  void take_names(std::string_view line);
  void check_units() const;
  void split(std::string_view line);
  [[nodiscard]] std::string column_name(std::size_t column) const;

  std::string file_;
  std::string content_;
  Separator separator_;
  std::size_t min_columns_;
  std::size_t at_ = 0;  // first character that is not read yet
  int line_ = 0;
  int names_line_ = 0;
  bool in_rows_ = false;
  bool units_are_checked_ = false;
  std::vector<Unit> units_;
  std::vector<std::string> names_;
  int unit_exponent_;  // of ten, from the stamp's unit to nanoseconds
  std::vector<std::string_view> cells_;
  std::optional<Timestamp> last_stamp_;
  int last_stamp_line_ = 0;
};

/// Exact nanoseconds of a decimal number in units of 10^unit_exponent ns; rounded where it has
/// more digits. Nothing if the text is no number or does not fit.
[[nodiscard]] std::optional<Timestamp> parse_stamp(std::string_view text, int unit_exponent);

/// Seconds with nine decimals; parse_stamp gives the same stamp again.
[[nodiscard]] std::string print_seconds(Timestamp stamp);

}  // namespace stillkite
