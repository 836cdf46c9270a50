#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "geometry/time.hpp"
#include "io/import/byte_source.hpp"

namespace stillkite {

/// Message of a ROS recording.
struct RosMessage {
  std::string_view topic;
  std::string_view type;  ///< "sensor_msgs/Imu", as in ROS 1
  Timestamp logged;       ///< time of recording
  Bytes data;
  bool is_cdr = true;  ///< ROS 2's serialization, else that of ROS 1
};

/// Time of recording in ns; 0 if it is beyond 200 years, so that differences do not overflow.
[[nodiscard]] inline Timestamp time_of_recording(std::uint64_t t_ns) {
  constexpr std::uint64_t kMax_ns = 6'311'520'000'000'000'000;
  return {t_ns > kMax_ns ? 0 : static_cast<std::int64_t>(t_ns)};
}

/// Called for each message in the order of the recording.
using TakeRosMessage = std::function<void(const RosMessage&)>;

/// Fields of a message one after another. CDR aligns numbers to their size, after four bytes that
/// state the byte order; ROS 1 does not align, and its headers begin with a sequence number. After
/// the end of the data, or with the most significant byte first, is_valid() is false and numbers
/// are 0.
class RosFields {
 public:
  explicit RosFields(const RosMessage& message);

  template <typename T>
  T next() {
    if (is_cdr_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (at_ > data_.size() || data_.size() - at_ < sizeof(T)) is_valid_ = false;
    const T value = is_valid_ ? little_endian<T>(data_, at_) : T{};
    at_ += sizeof(T);
    return value;
  }
  /// Array or text of bytes, after its length.
  [[nodiscard]] Bytes bytes();
  [[nodiscard]] std::string_view text();
  /// Stamp of a std_msgs/Header, or the time of recording if it is 0; skips the frame's name.
  [[nodiscard]] Timestamp header();
  /// True if header() found no stamp.
  [[nodiscard]] bool lacks_stamp() const { return lacks_stamp_; }
  void skip_doubles(int count);

  [[nodiscard]] bool is_valid() const { return is_valid_; }

 private:
  Bytes data_;
  bool is_cdr_;
  bool is_valid_ = true;
  bool lacks_stamp_ = false;
  Timestamp logged_;
  std::size_t at_ = 0;
};

/// Type name without ROS 2's "/msg": "sensor_msgs/msg/Imu" becomes "sensor_msgs/Imu".
[[nodiscard]] std::string ros1_type(std::string_view type);

}  // namespace stillkite
