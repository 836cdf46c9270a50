#pragma once

#include <ctime>

namespace stillkite::bench {

/// This thread's processor time from lap to lap: where others share the machine, wall time counts
/// their work into long laps and leaves it out of short ones.
class ProcessorWatch {
 public:
  double lap_ms() {
    const double now = now_ms();
    const double ms = now - last_;
    last_ = now;
    return ms;
  }

 private:
  static double now_ms() {
    std::timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }
  double last_ = now_ms();
};

}  // namespace stillkite::bench
