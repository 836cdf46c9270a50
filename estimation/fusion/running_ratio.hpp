#pragma once

namespace stillkite {

/// The mean of ratios that are 1 as a rule.
class RunningRatio {
 public:
  static constexpr double kMost = 12.5;

  /// Forgotten after a hundred more; none counts for more than `kMost`, for none alone tells.
  void add(double ratio) {
    constexpr double kForgotten = 0.01;
    sum_ += (ratio < kMost ? ratio : kMost) - kForgotten * sum_;
    count_ += 1 - kForgotten * count_;
  }
  /// Near 1 until some are there.
  [[nodiscard]] double value() const { return (sum_ + kAsUsual) / (count_ + kAsUsual); }

 private:
  static constexpr double kAsUsual = 5;  // that many are taken to have been 1
  double sum_ = 0;
  double count_ = 0;
};

}  // namespace stillkite
