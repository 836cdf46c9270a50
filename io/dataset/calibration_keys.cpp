#include "io/dataset/calibration_keys.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "io/config/config_values.hpp"

namespace stillkite {
namespace {

using Words = std::span<const std::string_view>;

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

bool contains_any(std::string_view name, Words parts) {
  return std::ranges::any_of(
      parts, [&](std::string_view part) { return name.find(part) != std::string_view::npos; });
}

// Words between the separators _ . - and blank.
bool has_word(std::string_view name, Words words) {
  while (true) {
    const std::size_t end = name.find_first_of("_.- ");
    if (std::ranges::find(words, name.substr(0, end)) != words.end()) return true;
    if (end == std::string_view::npos) return false;
    name.remove_prefix(end + 1);
  }
}

// Names A and B of a transform that maps B to A; empty for other keys.
std::pair<std::string, std::string> frames_of(std::string_view key) {
  std::string name = lower_case(key);
  if (name.starts_with("imu.")) name.erase(0, 4);  // ORB-SLAM: IMU.T_b_c1
  for (const std::string_view infix : {"_from_", "_t_"}) {
    const std::size_t at = name.find(infix);
    if (at != std::string::npos && at > 0) {
      return {name.substr(0, at), name.substr(at + infix.size())};
    }
  }
  const bool is_short = key.size() == 3 && key[0] == 'T';  // Tbc
  if (!name.starts_with("t_") && !is_short) return {};
  name.erase(0, is_short ? 1 : 2);
  if (const std::size_t bar = name.find('_'); bar != std::string::npos) {
    return {name.substr(0, bar), name.substr(bar + 1)};
  }
  if (name.size() == 2) return {name.substr(0, 1), name.substr(1)};
  return {};
}

enum class KeyKind { none, mount, clock, shutter, lens };

KeyKind kind_of(std::string_view key) {
  // Of rectified images, calibration boards and residuals.
  constexpr auto kOther = std::to_array<std::string_view>(
      {"rectification_matrix", "projection_matrix", "extrinsic_parameters",
       "avg_reprojection_error", "per_view_reprojection_errors"});
  constexpr auto kShutter = std::to_array<std::string_view>({"shutter", "line_delay", "readout"});
  constexpr auto kClock =
      std::to_array<std::string_view>({"timeshift", "time_shift", "time_offset", "timeoffset",
                                       "temporal", "timedelay", "delay", "latency", "clock"});
  constexpr auto kClockWords = std::to_array<std::string_view>({"td", "dt", "lag", "toffset"});
  constexpr auto kMount = std::to_array<std::string_view>(
      {"extrinsic", "mount", "rotation", "translation", "quaternion", "orientation", "lever",
       "_from_", "_wrt_", "_to_"});
  constexpr auto kMountWords =
      std::to_array<std::string_view>({"t", "r", "q", "p", "roll", "pitch", "yaw", "rpy", "euler",
                                       "pose", "position", "tvec", "rvec"});
  constexpr auto kLens = std::to_array<std::string_view>(
      {"distort", "distcoeff", "dist_coeff", "intrinsic", "focal", "principal", "fisheye",
       "camera_model", "camera_matrix", "model_type", "camera_type", "thin_prism", "tilted",
       "projection_param", "mirror", "lens", "field_of_view", "binning", "resolution"});
  constexpr auto kLensWords = std::to_array<std::string_view>(
      {"xi", "fx", "fy", "cx", "cy", "fov", "skew", "zoom", "crop", "k1", "k2",
       "k3", "k4", "k5", "k6", "p1", "p2",  "s1",   "s2",   "s3",   "s4"});
  const std::string name = lower_case(key);
  if (std::ranges::find(kOther, name) != kOther.end()) return KeyKind::none;
  if (contains_any(name, kShutter)) return KeyKind::shutter;
  if (contains_any(name, kClock) || has_word(name, kClockWords)) return KeyKind::clock;
  const bool is_short = key.size() == 3 && (key[0] == 'T' || key[0] == 'R') &&
                        std::isalpha(static_cast<unsigned char>(key[1])) != 0 &&
                        std::isalpha(static_cast<unsigned char>(key[2])) != 0;  // Tbc, Rbc
  if (is_short || contains_any(name, kMount) || has_word(name, kMountWords)) return KeyKind::mount;
  if (contains_any(name, kLens) || has_word(name, kLensWords)) return KeyKind::lens;
  return KeyKind::none;
}

// Zero, false or none in every cell.
bool is_zero(const ConfigNode& node) {
  switch (node.kind) {
    case ConfigNode::Kind::null:
      return true;
    case ConfigNode::Kind::list:
      return std::ranges::all_of(node.items, is_zero);
    case ConfigNode::Kind::map: {
      const ConfigNode* const data = node.find("data");
      return data != nullptr && is_zero(*data);
    }
    case ConfigNode::Kind::scalar:
      break;
  }
  const std::string text = lower_case(node.text);
  return text == "false" || text == "none" || text == "pinhole" ||
         (text.find('0') != std::string::npos &&
          text.find_first_not_of("0.e+-") == std::string::npos);
}

bool is_of_further_camera(std::string_view key) {
  const std::string name = lower_case(key);
  const std::size_t at = name.find("cam");
  const std::size_t digit = name.find_first_of("0123456789", at);
  return at != std::string::npos && digit != std::string::npos && name[digit] != '0' &&
         name.find("cam0") == std::string::npos;
}

std::string remedy(KeyKind kind) {
  switch (kind) {
    case KeyKind::mount:
      return "looks like a mount, which is read from T_BS, T_BC, T_SC, T_imu_cam, body_T_cam0 "
             "(4 x 4, body from camera) or T_cam_imu (camera from body); rename it, or remove it "
             "and set mount.rotation_wxyz";
    case KeyKind::clock:
      return "looks like a clock offset, which is read from timeshift_cam_imu (t_imu = t_cam + "
             "timeshift); rename it, or remove it and set imu.time_offset_s";
    case KeyKind::shutter:
      return "looks like a rolling shutter; remove it and set navigator.readout_s";
    default:
      return "looks like a lens parameter and is not part of the supported models "
             "(radial-tangential, equidistant); calibrate with one of these, or remove it";
  }
}

}  // namespace

MountKey mount_key(std::string_view name) {
  const auto [a, b] = frames_of(name);
  constexpr auto kBody = std::to_array<std::string_view>({"b", "i", "body", "imu", "imu0"});
  constexpr auto kCamera =
      std::to_array<std::string_view>({"c", "c0", "cam", "cam0", "camera", "camera0"});
  const auto is_one_of = [](const std::string& frame, const auto& names) {
    return std::ranges::find(names, frame) != names.end();
  };
  // S is the camera in EuRoC's T_BS and the IMU in OKVIS's T_SC.
  const auto is_body = [&](const std::string& frame, const std::string& other) {
    return is_one_of(frame, kBody) || (frame == "s" && is_one_of(other, kCamera));
  };
  const auto is_camera = [&](const std::string& frame, const std::string& other) {
    return is_one_of(frame, kCamera) || (frame == "s" && other == "b") ||
           (frame == "c1" && other == "b");  // ORB-SLAM counts from 1
  };
  if (is_body(a, b) && is_camera(b, a)) return MountKey::body_from_camera;
  if (is_camera(a, b) && is_body(b, a)) return MountKey::camera_from_body;
  return MountKey::none;
}

void reject_unread_keys(const ConfigNode& map, const std::string& prefix, Words read) {
  const bool has_mount = std::ranges::any_of(
      read, [](std::string_view key) { return mount_key(key) != MountKey::none; });
  for (const auto& [key, value] : map.entries) {
    const bool is_group = value.kind == ConfigNode::Kind::map && value.find("data") == nullptr;
    if (is_of_further_camera(key) && (has_mount || is_group)) continue;
    if (std::ranges::find(read, key) != read.end()) continue;
    const KeyKind kind = kind_of(key);
    const bool is_neutral = kind == KeyKind::none || (kind != KeyKind::mount && is_zero(value));
    if (!is_neutral) reject_value(value, prefix + key, remedy(kind));
    if (is_group) reject_unread_keys(value, prefix + key + '.', {});
    for (const ConfigNode& item : value.items) reject_unread_keys(item, prefix + key + '.', {});
  }
}

}  // namespace stillkite
