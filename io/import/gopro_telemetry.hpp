#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "io/import/gopro_stream.hpp"
#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Telemetry of a GoPro video (GPMF). Clock: that of the video. Keys, units and frames:
/// docs/import.md.
///
/// The camera's axes are x left, y backward, z up, seen from behind. The body is the camera: x
/// forward along the optical axis, y left, z up. The IMU and the attitude of stabilized images are
/// those of the image: a camera that rotates as the image does.
class GoproTelemetry {
 public:
  /// Payload of the telemetry track, which covers [start, end) of the video.
  void add(Bytes payload, Timestamp start, Timestamp end);

  /// Throws InputError, without the file's name, if the payloads have no sensor.
  [[nodiscard]] ImportedFlight finish();

 private:
  enum Key : std::size_t {
    accel,
    gyro,
    gravity,
    camera_orientation,
    image_orientation,
    gps5,
    gps9,
    keys
  };
  static constexpr std::array<std::string_view, keys> kKeys{"ACCL", "GYRO", "GRAV", "CORI",
                                                            "IORI", "GPS5", "GPS9"};

  void add_device(Bytes device, Timestamp start, Timestamp end);
  void add_imu(ImportedFlight& flight, std::optional<Timestamp> origin) const;
  void add_positions(ImportedFlight& flight, std::optional<Timestamp> origin) const;

  std::string model_;
  std::array<GoproStream, keys> streams_;
};

}  // namespace stillkite
