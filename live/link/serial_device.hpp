#pragma once

#include <asio/serial_port.hpp>

#include "live/link/link_address.hpp"

namespace stillkite {

/// Opens a serial device for this process alone: 8 bits, no flow control. False if the device, its
/// baud rate or the permission is missing.
[[nodiscard]] bool open_serial_device(asio::serial_port& serial, const LinkAddress& address);

}  // namespace stillkite
