#include "live/link/pseudo_terminal.hpp"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "geometry/fields.hpp"

namespace stillkite {
namespace fs = std::filesystem;

PseudoTerminal::PseudoTerminal(const fs::path& link)
    : link_(link), device_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  const bool is_open = device_ >= 0 && grantpt(device_) == 0 && unlockpt(device_) == 0;
  const char* const name = is_open ? ptsname(device_) : nullptr;
  if (name != nullptr) other_ = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (other_ < 0 || tcgetattr(other_, &settings) != 0) {
    throw InputError(std::string("no pseudo-terminal is available: ") + std::strerror(errno));
  }
  cfmakeraw(&settings);
  tcsetattr(other_, TCSANOW, &settings);
  std::error_code failure;
  if (fs::is_symlink(link_, failure)) fs::remove(link_, failure);
  fs::create_symlink(name, link_, failure);
  if (failure) throw InputError(link_.string() + ": cannot be created: " + failure.message());
}

PseudoTerminal::~PseudoTerminal() {
  std::error_code ignored;
  fs::remove(link_, ignored);
  close(other_);
  close(device_);
}

std::string PseudoTerminal::read() {
  std::string out;
  std::array<char, 1024> bytes{};
  while (true) {
    const ssize_t size = ::read(device_, bytes.data(), bytes.size());
    if (size <= 0) return out;
    out.append(bytes.data(), static_cast<std::size_t>(size));
  }
}

void PseudoTerminal::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t size = ::write(device_, bytes.data(), bytes.size());
    if (size <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(size));
  }
}

}  // namespace stillkite
