#pragma once

#include <ctime>

namespace stillkite::bench {

/// Stopwatch of the calling thread's CPU time, independent of other load on the machine.
class ProcessorWatch {
 public:
  /// CPU time since the last call (or construction).
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
