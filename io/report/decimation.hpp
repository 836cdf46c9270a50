#pragma once

#include <cstddef>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillkite {

/// Decimation for drawing to at most `max_samples` (even) values: minimum and maximum of equal
/// intervals, in their order; NaN twice for an interval without a number. Shorter series are
/// returned unchanged. Series of equal length use the same intervals, so samples stay aligned.
[[nodiscard]] std::vector<float> keep_extremes(std::span<const float> values,
                                               std::size_t max_samples);

/// At most `max_samples` values, evenly spaced, first and last included.
[[nodiscard]] std::vector<float> keep_every_nth(std::span<const float> values,
                                                std::size_t max_samples);

/// Columns of a recording in bounded memory. Beyond `max_blocks` (even) frames, blocks of 2, 4, 8
/// ... frames keep their first value, minimum and maximum.
class DecimatedTable {
 public:
  using Columns = std::map<std::string, std::vector<float>>;

  explicit DecimatedTable(std::size_t max_blocks) : max_blocks_(max_blocks) {}

  /// Value of the frame's next column; all frames have the same columns in the same order. The
  /// parts form the column's name.
  void add(std::initializer_list<std::string_view> name_parts, double value);
  void end_frame();

  [[nodiscard]] std::size_t frames() const { return frames_; }
  /// Values of all frames, or minimum and maximum of each block, in their order; NaN for a block
  /// without a number.
  [[nodiscard]] Columns extremes() const;
  /// First value of each block, and the last frame's.
  [[nodiscard]] Columns samples() const;

 private:
  struct Block {
    float first = 0, low = 0, high = 0;
    bool low_is_first = true;  // the minimum comes before the maximum
  };
  struct Column {
    std::string name;
    std::vector<Block> blocks;
    float last = 0;
  };
  [[nodiscard]] static Block merged(const Block& a, const Block& b);
  void halve();

  std::size_t max_blocks_;
  std::size_t frames_ = 0;
  std::size_t block_frames_ = 1;
  std::size_t next_column_ = 0;
  std::vector<Column> columns_;
};

}  // namespace stillkite
