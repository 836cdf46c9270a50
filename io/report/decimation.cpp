#include "io/report/decimation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stillkite {

std::vector<float> keep_extremes(std::span<const float> values, std::size_t max_samples) {
  if (values.size() <= max_samples) return {values.begin(), values.end()};
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const std::size_t intervals = max_samples / 2;
  std::vector<float> kept;
  kept.reserve(2 * intervals);
  for (std::size_t i = 0; i < intervals; ++i) {
    const std::size_t end = (i + 1) * values.size() / intervals;
    std::size_t low = end;
    std::size_t high = end;
    for (std::size_t j = i * values.size() / intervals; j < end; ++j) {
      if (std::isnan(values[j])) continue;
      if (low == end || values[j] < values[low]) low = j;
      if (high == end || values[j] > values[high]) high = j;
    }
    kept.push_back(low == end ? kNaN : values[std::min(low, high)]);
    kept.push_back(low == end ? kNaN : values[std::max(low, high)]);
  }
  return kept;
}

std::vector<float> keep_every_nth(std::span<const float> values, std::size_t max_samples) {
  if (values.size() <= max_samples) return {values.begin(), values.end()};
  std::vector<float> kept;
  kept.reserve(max_samples);
  for (std::size_t i = 0; i < max_samples; ++i) {
    kept.push_back(values[i * (values.size() - 1) / (max_samples - 1)]);
  }
  return kept;
}

DecimatedTable::Block DecimatedTable::merged(const Block& a, const Block& b) {
  if (std::isnan(b.low)) return a;
  if (std::isnan(a.low)) return {a.first, b.low, b.high, b.low_is_first};
  const bool low_of_a = a.low <= b.low;
  const bool high_of_a = a.high >= b.high;
  Block block{a.first, low_of_a ? a.low : b.low, high_of_a ? a.high : b.high, low_of_a};
  if (low_of_a == high_of_a) block.low_is_first = low_of_a ? a.low_is_first : b.low_is_first;
  return block;
}

void DecimatedTable::halve() {
  for (Column& column : columns_) {
    for (std::size_t i = 0; i < max_blocks_ / 2; ++i) {
      column.blocks[i] = merged(column.blocks[2 * i], column.blocks[2 * i + 1]);
    }
    column.blocks.resize(max_blocks_ / 2);
  }
  block_frames_ *= 2;
}

void DecimatedTable::add(std::initializer_list<std::string_view> name_parts, double value) {
  if (next_column_ == 0 && frames_ == max_blocks_ * block_frames_) halve();
  if (next_column_ == columns_.size()) {
    std::string name;
    for (const std::string_view part : name_parts) name += part;
    columns_.push_back({.name = std::move(name), .blocks = {}});
  }
  Column& column = columns_[next_column_++];
  column.last = static_cast<float>(value);
  const Block block{column.last, column.last, column.last};
  if (frames_ / block_frames_ == column.blocks.size()) {
    column.blocks.push_back(block);
  } else {
    column.blocks.back() = merged(column.blocks.back(), block);
  }
}

void DecimatedTable::end_frame() {
  ++frames_;
  next_column_ = 0;
}

DecimatedTable::Columns DecimatedTable::extremes() const {
  Columns result;
  for (const Column& column : columns_) {
    std::vector<float>& values = result[column.name];
    for (const Block& block : column.blocks) {
      values.push_back(block.low_is_first ? block.low : block.high);
      if (block_frames_ > 1) values.push_back(block.low_is_first ? block.high : block.low);
    }
  }
  return result;
}

DecimatedTable::Columns DecimatedTable::samples() const {
  Columns result;
  for (const Column& column : columns_) {
    std::vector<float>& values = result[column.name];
    for (const Block& block : column.blocks) values.push_back(block.first);
    if (block_frames_ > 1) values.push_back(column.last);
  }
  return result;
}

}  // namespace stillkite
