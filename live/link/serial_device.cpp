#include "live/link/serial_device.hpp"

#include <sys/ioctl.h>
#include <termios.h>

namespace stillkite {

bool open_serial_device(asio::serial_port& serial, const LinkAddress& address) {
  asio::error_code error;
  serial.open(address.host, error);
  if (error) return false;
  const auto set = [&](const auto& option) {
    if (!error) serial.set_option(option, error);
  };
  set(asio::serial_port::baud_rate(address.baud));
  set(asio::serial_port::character_size(8));
  set(asio::serial_port::flow_control(asio::serial_port::flow_control::none));
  if (!error && ioctl(serial.native_handle(), TIOCEXCL) == 0) {
    tcflush(serial.native_handle(), TCIFLUSH);  // bytes of an unknown time
    return true;
  }
  asio::error_code ignored;
  serial.close(ignored);
  return false;
}

}  // namespace stillkite
