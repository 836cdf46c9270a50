#include "app/interrupt.hpp"

#include <csignal>

namespace stillkite {
namespace {

volatile std::sig_atomic_t flag = 0;

extern "C" void raise_flag(int signal) {
  flag = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, raise_flag);
  std::signal(SIGTERM, raise_flag);
  std::signal(SIGHUP, raise_flag);
}

bool interrupted() {
  return flag != 0;
}

}  // namespace stillkite
