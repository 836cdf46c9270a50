#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillkite {

struct ConfigNode;

/// Direction of the transform that a key names.
enum class MountKey { none, body_from_camera, camera_from_body };

/// Recognizes T_A_B, A_T_B, A_from_B and T_AB of any spelling: maps B to A. The body is body, imu,
/// b or i, the camera cam, cam0, camera or c. T_BS is body_from_camera (EuRoC), T_SC too (OKVIS: S
/// is the IMU).
[[nodiscard]] MountKey mount_key(std::string_view name);

/// Throws InputError "file:line:column: key: problem" at a key, at any depth, that looks like a
/// mount, a clock or a lens and is not in `read`. A clock or lens value of zero is accepted, and
/// so are keys of further cameras (cam1).
void reject_unread_keys(const ConfigNode& map, const std::string& prefix,
                        std::span<const std::string_view> read);

}  // namespace stillkite
