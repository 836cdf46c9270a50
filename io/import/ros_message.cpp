#include "io/import/ros_message.hpp"

namespace stillkite {

RosFields::RosFields(const RosMessage& message)
    : data_(message.data), is_cdr_(message.is_cdr), logged_(message.logged) {
  constexpr std::size_t kEncapsulation = 4;
  if (!is_cdr_) return;
  is_valid_ = data_.size() >= kEncapsulation && (data_[1] & 1) != 0;
  data_ = data_.subspan(std::min(kEncapsulation, data_.size()));
}

Bytes RosFields::bytes() {
  const std::size_t length = next<std::uint32_t>();
  if (!is_valid_ || length > data_.size() - at_) {
    is_valid_ = false;
    return {};
  }
  const Bytes out = data_.subspan(at_, length);
  at_ += length;
  return out;
}

std::string_view RosFields::text() {
  const Bytes raw = bytes();
  const std::string_view all(reinterpret_cast<const char*>(raw.data()), raw.size());
  return all.substr(0, all.find('\0'));
}

Timestamp RosFields::header() {
  if (!is_cdr_) (void)next<std::uint32_t>();
  const auto seconds = next<std::int32_t>();
  const auto nanoseconds = next<std::uint32_t>();
  (void)text();
  lacks_stamp_ = seconds == 0 && nanoseconds == 0;
  if (lacks_stamp_) return logged_;
  return {std::int64_t{1'000'000'000} * seconds + nanoseconds};
}

void RosFields::skip_doubles(int count) {
  for (int i = 0; i < count; ++i) (void)next<double>();
}

std::string ros1_type(std::string_view type) {
  std::string out(type);
  if (const std::size_t at = out.find("/msg/"); at != std::string::npos) out.erase(at, 4);
  return out;
}

}  // namespace stillkite
