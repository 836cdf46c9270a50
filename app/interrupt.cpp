#include "app/interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace stillkite {
namespace {

volatile std::sig_atomic_t flag = 0;

extern "C" void raise_flag(int /*signal*/) {
  flag = 1;
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = raise_flag;
  action.sa_flags = SA_RESETHAND;  // no SA_RESTART: a blocked open() returns EINTR
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool interrupted() {
  return flag != 0;
}

}  // namespace stillkite
