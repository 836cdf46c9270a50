// Readers of a live flight: links, operators, page, addresses.
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "geometry/fields.hpp"
#include "live/link/line_splitter.hpp"
#include "live/link/link_address.hpp"
#include "live/mavlink/parser.hpp"
#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"
#include "live/mavlink/telemetry.hpp"
#include "live/operator/operator_command.hpp"
#include "live/page/page_access.hpp"
#include "live/sensors/sensor_lines.hpp"
#include "live/stream/stream_address.hpp"
#include "live/tether/command_lines.hpp"
#include "live/tether/station_lines.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace stillkite::fuzz {
namespace {

// The input's first byte, 0 if it is empty; the rest remains.
std::uint8_t take_byte(Input& input) {
  if (input.empty()) return 0;
  const std::uint8_t byte = input.front();
  input = input.subspan(1);
  return byte;
}

// At most `size` bytes from the front of the input; the rest remains.
Input take_bytes(Input& input, std::size_t size) {
  const Input front = input.first(std::min(size, input.size()));
  input = input.subspan(front.size());
  return front;
}

// The input's first line, without its end; the rest remains.
std::string take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string line(text.substr(0, end));
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

bool is_finite(const SensorSample& sample) {
  if (const auto* imu = std::get_if<ImuSample>(&sample)) {
    return imu->angular_rate_in_body_rad_s.allFinite() &&
           imu->specific_force_in_body_m_s2.allFinite();
  }
  if (const auto* attitude = std::get_if<AttitudeSample>(&sample)) {
    return std::abs(attitude->world_from_body.norm() - 1) < 1e-6;
  }
  return std::isfinite(std::get<HeightSample>(sample).height_m);
}

// Packets and their sensor readings, at 100 Hz.
class MavlinkReader {
 public:
  explicit MavlinkReader(std::uint8_t mode)
      : telemetry_({.imu = static_cast<ImuMessage>(mode % 6),
                    .attitude = static_cast<AttitudeMessage>((mode >> 3) & 1),
                    .height = static_cast<HeightMessage>((mode >> 4) % 3)},
                   1) {}

  void add(Input bytes) {
    parser_.add(bytes);
    while (const auto packet = parser_.next()) {
      mavlink::Parser again;
      again.add(packet->raw.bytes());
      const auto same = again.next();
      require(same && same->id == packet->id && same->payload == packet->payload,
              "a packet is read again from its bytes");
      const auto sample = telemetry_.read(*packet, arrival_);
      require(!sample || is_finite(*sample), "readings are finite");
      arrival_.ns += 10'000'000;
    }
  }

 private:
  mavlink::Parser parser_;
  mavlink::Telemetry telemetry_;
  Timestamp arrival_{1'000'000'000'000};
};

// Mode, then bytes of the link, received in parts.
void read_mavlink_bytes(Input input) {
  MavlinkReader reader(take_byte(input));
  while (!input.empty()) {
    const std::size_t size = 1U + take_byte(input);
    reader.add(take_bytes(input, size));
  }
}

constexpr std::array<std::uint32_t, 10> kReadMessages{
    mavlink::Heartbeat::kId,        mavlink::Timesync::kId,  mavlink::AttitudeQuaternion::kId,
    mavlink::HighresImu::kId,       mavlink::ScaledImu::kId, mavlink::ScaledImu2::kId,
    mavlink::ScaledImu3::kId,       mavlink::RawImu::kId,    mavlink::DistanceSensor::kId,
    mavlink::GlobalPositionInt::kId};

// Mode, then payloads with their message and size; they get valid checksums.
void read_mavlink_messages(Input input) {
  MavlinkReader reader(take_byte(input));
  mavlink::Sender sender{.system = 1, .component = mavlink::kAutopilot};
  while (!input.empty()) {
    const std::uint32_t id = kReadMessages[take_byte(input) % kReadMessages.size()];
    const std::size_t size = take_byte(input);
    const Input payload = take_bytes(input, size);
    reader.add(mavlink::pack(id, payload, mavlink::crc_extra(id).value(), sender).bytes());
  }
}

template <mavlink::Message M>
void append_message(std::string& out, std::uint8_t index, const M& message) {
  mavlink::Sender sender;
  const mavlink::PacketBytes packet = mavlink::encode(message, sender);
  const auto payload = packet.bytes().subspan(10, packet.bytes().size() - 12);
  out.push_back(static_cast<char>(index));
  out.push_back(static_cast<char>(payload.size()));
  out.append(payload.begin(), payload.end());
}

std::vector<std::string> mavlink_message_seeds() {
  using namespace mavlink;
  std::string imu(1, '\x01'), others(1, '\x18');  // HIGHRES_IMU; attitude, range finder
  for (int i = 1; i < 4; ++i) {
    const auto t_us = static_cast<std::uint64_t>(10'000 * i);
    append_message(imu, 3, HighresImu{.time_usec = t_us, .zacc = -9.8F, .xgyro = 0.1F});
    const auto t_ms = static_cast<std::uint32_t>(10 * i);
    append_message(others, 2, AttitudeQuaternion{.time_boot_ms = t_ms, .q1 = 1});
    append_message(others, 8,
                   DistanceSensor{.time_boot_ms = t_ms,
                                  .min_distance = 10,
                                  .max_distance = 4000,
                                  .current_distance = 500,
                                  .orientation = 25});
    append_message(others, 1, Timesync{.tc1 = 1, .ts1 = 1'000'000'000'000});
  }
  return {imu, others};
}

std::vector<std::string> mavlink_byte_seeds() {
  using namespace mavlink;
  Sender sender{.system = 1, .component = kAutopilot};
  std::string out("\x01\x3f", 2);
  const auto append = [&](const PacketBytes& packet) {
    out.append(packet.bytes().begin(), packet.bytes().end());
  };
  append(encode(Heartbeat{.type = 2, .autopilot = 12}, sender));
  append(encode(HighresImu{.time_usec = 10'000, .zacc = -9.8F, .id = 1}, sender));
  return {out};
}

void read_station_lines(Input input) {
  LineSplitter splitter;
  while (!input.empty()) {
    splitter.add(text_of(take_bytes(input, 100)));
    while (const auto line = splitter.next()) {
      const auto message = parse_station_line(*line);
      if (!message) continue;
      if (const auto* attitude = std::get_if<DroneAttitude>(&*message)) {
        require(std::abs(attitude->world_from_body.norm() - 1) < 1e-6, "quaternion is normalized");
      }
      const std::string again = station_line(*message);
      const auto same = parse_station_line(std::string_view(again).substr(0, again.size() - 2));
      require(same && same->index() == message->index(), "a message is read again from its line");
    }
  }
}

void read_command_line(Input input) {
  const ParsedCommand command = parse_command_line(text_of(input), 0.003);
  require(!command.position || std::isfinite(command.position->length_rate_m_s),
          "rates are finite");
  require(!command.yaw_rate_rad_s || std::isfinite(*command.yaw_rate_rad_s), "rates are finite");
}

void read_operator_command(Input input) {
  const auto command = parse_operator_command(text_of(input), {1});
  if (!command) return;
  const std::string line = operator_line(*command);
  require(line.find('\n') == std::string::npos, "a command is one line");
  if (line.size() > 1000) return;  // escaped note
  const auto same = parse_operator_command(line, {1});
  require(same && same->action == command->action && operator_line(*same) == line,
          "a command is read again from its line");
}

// Lines of one sender, 10 ms apart.
void read_sensor_lines(Input input) {
  SensorLineReader reader({.imu = ImuMessage::json,
                           .attitude = AttitudeMessage::json,
                           .height = HeightMessage::json_height});
  Timestamp arrival{1'000'000'000'000};
  std::string_view text = text_of(input);
  while (!text.empty()) {
    const ParsedSensorLine parsed = parse_sensor_line(take_line(text));
    require(parsed.line.has_value() == parsed.problem.empty(), "a rejected line has a reason");
    arrival.ns += 10'000'000;
    if (!parsed.line) continue;
    for (const SensorSample& sample : reader.read(*parsed.line, arrival)) {
      require(is_finite(sample), "readings are finite");
    }
  }
}

// Lines of the input: method, path and headers of a request.
void read_page_request(Input input) {
  std::string_view text = text_of(input);
  PageRequest request;
  for (std::string* part :
       {&request.method, &request.path, &request.host, &request.origin, &request.authorization,
        &request.operator_id, &request.content_length}) {
    *part = take_line(text);
  }
  const std::string flags = take_line(text);
  request.has_transfer_encoding = flags.find('t') != std::string::npos;
  request.has_repeated_header = flags.find('r') != std::string::npos;
  const PageAccess open{.public_host = "drone.example", .token = std::nullopt};
  const PageAccess closed{.public_host = "drone.example", .token = "0123456789abcdef"};
  const auto refusal = page_refusal(request, open);
  if (!refusal) {
    require(request.method == "GET" || request.method == "POST", "method is known");
    require(request.path.find("..") == std::string::npos, "path is the page's");
    require(request.origin.empty() || request.origin.size() > request.host.size(),
            "origin is this page");
    require(!request.has_transfer_encoding && !request.has_repeated_header, "no hidden body");
  }
  if (page_refusal(request, closed)) return;
  require(!refusal, "a token refuses more");
  require(request.authorization == "Bearer 0123456789abcdef" || request.operator_id.empty() ||
              request.path == "/" || request.path.starts_with("/page."),
          "token is checked");
}

template <typename Call>
void accept_or_input_error(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    require(std::string_view(error.what()).size() > 10, "an error names its cause");
  }
}

void read_addresses(Input input) {
  const std::string text(text_of(input));
  accept_or_input_error([&] {
    const StreamAddress address = parse_stream_address(text);
    if (address.kind == StreamKind::rtsp || address.kind == StreamKind::rtp) {
      const std::size_t path = address.name.find('/', address.name.find("://") + 3);
      require(address.name.substr(0, path).find('@') == std::string::npos,
              "messages have no password");
    }
    const std::string stored = without_password(text);
    require(without_password(stored) == stored, "nothing remains of the password");
  });
  accept_or_input_error([&] {
    const LinkAddress address = parse_link_address(text, "live.mavlink");
    require(address.port > 0 || address.baud > 0, "a link has a port or a baud rate");
  });
  accept_or_input_error([&] {
    const PageAddress address = parse_page_address(text);
    require(address.host == "localhost" || is_ip_address(address.host), "host is an address");
  });
}

constexpr std::array kLiveTargets{
    Target{"mavlink_bytes", read_mavlink_bytes, mavlink_byte_seeds},
    Target{"mavlink_messages", read_mavlink_messages, mavlink_message_seeds},
    Target{"sensor_lines", read_sensor_lines},
    Target{"station_lines", read_station_lines},
    Target{"command_line", read_command_line},
    Target{"operator_command", read_operator_command},
    Target{"page_request", read_page_request},
    Target{"addresses", read_addresses},
};

}  // namespace

std::span<const Target> live_targets() {
  return kLiveTargets;
}

}  // namespace stillkite::fuzz
