#include "app/json_output.hpp"

#include <poll.h>
#include <unistd.h>

#include <cstdint>
#include <iterator>
#include <vector>

#include "geometry/fields.hpp"
#include "io/results/estimate_json.hpp"

namespace stillkite {

JsonOutput::JsonOutput(const std::string& target) {
  if (target == "-") return;
  const LinkAddress address = parse_link_address(target, "live.json");
  if (address.kind != LinkAddress::Kind::udp || address.host.empty()) {
    throw InputError("live.json: " + target + " has no host; expected - or udp://HOST:PORT");
  }
  port_.emplace(
      address, "live.json", [](auto&&...) {}, [] {});
  port_->start();
}

bool JsonOutput::send(const NavigationEstimate& estimate) {
  const std::string line = estimate_json(estimate);
  if (port_) {
    port_->send(std::vector<std::uint8_t>(line.begin(), line.end()));
    return true;
  }
  // a pipe that is ready takes PIPE_BUF (4096) bytes without blocking; a line is shorter
  pollfd ready{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
  if (poll(&ready, 1, 0) == 0) {
    ++dropped_;
    return true;
  }
  return write(STDOUT_FILENO, line.data(), line.size()) == std::ssize(line);
}

}  // namespace stillkite
