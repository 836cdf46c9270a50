#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Telemetry in the subtitles of DJI's videos. Keys of all known dialects, in any order:
///
///     [latitude: 10.1] [longitude: 20.2] [rel_alt: 5.0 abs_alt: 105.0]   deg, m
///     [longtitude : 20.2] [altitude: 105.0] [focal_len : 240] [dzoom_ratio: 10000]
///     [gb_pitch: -90.0]                                                  gimbal, deg
///     GPS(10.100217,20.200305,69.800) BAROMETER(91.2)                    latitude first, altitude
///     GPS (20.2003, 10.1002, 16), D 12.1m, H 98.00m                      longitude first,
///     satellites
///
/// Stamps are the cues' start, on the clock of the video. A position or height that repeats the
/// last one is kept once a second: telemetry is slower than the frames.
class DjiSubtitles {
 public:
  void add(Timestamp stamp, std::string_view cue);

  /// Throws InputError, without the file's name, if no cue has telemetry.
  [[nodiscard]] ImportedFlight finish();

 private:
  void add_height(Timestamp stamp, double height_m);
  void add_position(Timestamp stamp, const GeodeticPosition& position);
  void read_camera(std::string_view cue);

  ImportedFlight flight_;
  bool has_position_order_ = false;
  std::size_t cues_ = 0;
  std::size_t without_fix_ = 0;
};

/// Telemetry of an SRT file. Throws InputError "file: problem" if it has none.
[[nodiscard]] ImportedFlight read_dji_subtitles(const std::filesystem::path& file);

}  // namespace stillkite
