#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/time.hpp"
#include "io/import/gpmf_element.hpp"

namespace stillkite {

/// Samples of one sensor over a recording, from the STRM elements of its payloads.
struct GoproStream {
  /// Samples of one payload.
  struct Block {
    Timestamp start, end;             ///< of the payload in the track
    std::optional<Timestamp> sensor;  ///< STMP: stamp of the first sample by the camera's clock
    std::size_t first = 0;            ///< index of the first sample
  };
  std::vector<Block> blocks;
  std::vector<Eigen::Vector<double, 5>> samples;  ///< divided by SCAL; NaN without a GNSS fix
  std::string axes;  ///< ORIN: axis of each column, lower case for a negative one
};

/// Appends the samples of a payload's STRM element: its last element, of the given key, with as
/// many columns as it has, up to five. Throws InputError beyond 2e7 samples.
void append_samples(GoproStream& stream, Bytes stream_element, std::string_view key,
                    Timestamp start, Timestamp end);

/// Key of the samples of a STRM element, such as "ACCL"; empty without any.
[[nodiscard]] std::string_view samples_key(Bytes stream_element);

/// Camera's clock at the first sample; nullopt unless every payload has STMP.
[[nodiscard]] std::optional<Timestamp> first_sensor_stamp(const GoproStream& stream);

/// Stamps of the samples: by STMP less `origin` if both are known, else by the payloads' times.
/// Sensors sample at a constant rate: a line is fitted to the starts of the payloads over the
/// sample numbers. Where it does not fit (GNSS, gaps), samples are spread over their payload.
[[nodiscard]] std::vector<Timestamp> sample_stamps(const GoproStream& stream,
                                                   std::optional<Timestamp> origin);

}  // namespace stillkite
