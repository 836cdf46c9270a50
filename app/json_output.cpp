#include "app/json_output.hpp"

#include <cstdint>
#include <cstdio>
#include <stdexcept>
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

void JsonOutput::send(const NavigationEstimate& estimate) {
  const std::string line = estimate_json(estimate);
  if (port_) {
    port_->send(std::vector<std::uint8_t>(line.begin(), line.end()));
    return;
  }
  if (std::fwrite(line.data(), 1, line.size(), stdout) != line.size() || std::fflush(stdout) != 0) {
    throw std::runtime_error("standard output is closed");
  }
}

}  // namespace stillkite
