#pragma once

#include <span>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

/// Frame interval of a camera by the stamps of its frames: without missed frames, and with stamps
/// of arrival in bursts (buffered transmission).
///
/// It is the median interval, unless more than half of the frames would be missed at that rate.
/// Then the frames come in bursts, and it is the median of the mean over blocks of intervals. A
/// block is a quarter of the intervals, so that a single pause is in fewer than half of the blocks.
class FramePeriod {
 public:
  /// Later intervals replace those before the last 128. A pause above one second interrupts the
  /// stream, it is no delay: not counted.
  void add(Timestamp from, Timestamp to);
  void clear() { intervals_s_.clear(); }

  /// Period by the intervals added and those between `stamps`; 0: no interval.
  [[nodiscard]] double with(std::span<const Timestamp> stamps) const;

 private:
  std::vector<double> intervals_s_;
};

}  // namespace stillkite
