#include "io/import/dji_subtitles.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "geometry/angle.hpp"
#include "io/import/byte_source.hpp"

namespace stillkite {
namespace {

constexpr double kRepeat_s = 1;
constexpr double kFormatWidth_mm = 34.61;

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

// Number at the beginning of the text, which then begins after it.
std::optional<double> take_number(std::string_view& text) {
  text = without_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

bool is_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

// Text after "key:", "key :", "key(" or, with `separator` ' ', "key ".
std::optional<std::string_view> after_key(std::string_view text, std::string_view key,
                                          std::string_view separators = ":(") {
  for (std::size_t at = 0; (at = text.find(key, at)) != std::string_view::npos; ++at) {
    if (at > 0 && is_name(text[at - 1])) continue;
    const std::string_view rest = text.substr(at + key.size());
    const std::string_view value = separators == " " ? rest : without_blanks(rest);
    if (!value.empty() && separators.find(value[0]) != std::string_view::npos) {
      return value.substr(1);
    }
  }
  return std::nullopt;
}

// Value of a key; "47,5" is 47.5.
std::optional<double> number_of(std::string_view text, std::string_view key,
                                std::string_view separators = ":(") {
  const std::optional<std::string_view> value = after_key(text, key, separators);
  if (!value) return std::nullopt;
  std::string number(without_blanks(*value));
  number.resize(std::min(number.find_first_not_of("+-0123456789.,"), number.size()));
  if (const std::size_t comma = number.find(','); comma < number.find('.')) number[comma] = '.';
  std::string_view text_of_number = number;
  return take_number(text_of_number);
}

// Start of "00:00:01,033 --> 00:00:01,066".
std::optional<Timestamp> cue_start(std::string_view line) {
  if (line.find("-->") == std::string_view::npos) return std::nullopt;
  std::array<std::int64_t, 4> parts{};
  for (std::int64_t& part : parts) {
    line = without_blanks(line);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), part);
    if (error != std::errc() || part < 0 || part > 9999) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && (line[0] == ':' || line[0] == ',' || line[0] == '.')) {
      line.remove_prefix(1);
    }
  }
  const auto [hours, minutes, seconds, milliseconds] = parts;
  return Timestamp{(((hours * 60 + minutes) * 60 + seconds) * 1000 + milliseconds) * 1'000'000};
}

// True if the value repeats the last one within kRepeat_s.
template <typename Value, typename Equal>
bool repeats(const TimeSeries<Value>& series, Timestamp stamp, const Value& value, Equal equal) {
  return !series.values.empty() && equal(series.values.back(), value) &&
         stamp > series.stamps.back() && seconds_between(series.stamps.back(), stamp) < kRepeat_s;
}

struct GpsTriple {
  GeodeticPosition position;
  bool has_altitude = false;
};

// GPS(a,b,c): with decimals c is the altitude, and the latitude comes first; an integer c is the
// number of satellites, and the longitude comes first.
std::optional<GpsTriple> gps_triple(std::string_view cue) {
  std::optional<std::string_view> text = after_key(cue, "GPS", "(");
  if (!text) return std::nullopt;
  std::array<double, 3> numbers{};
  bool has_point = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string_view before = *text;
    const std::optional<double> number = take_number(*text);
    if (!number) return std::nullopt;
    numbers[i] = *number;
    has_point = before.substr(0, before.size() - text->size()).find('.') != std::string_view::npos;
    *text = without_blanks(*text);
    if (!text->starts_with(i < 2 ? ',' : ')')) return std::nullopt;
    text->remove_prefix(1);
  }
  GpsTriple out{.has_altitude = has_point};
  const bool latitude_first = has_point && std::abs(numbers[0]) <= 90;
  out.position = {.latitude_deg = numbers[latitude_first ? 0 : 1],
                  .longitude_deg = numbers[latitude_first ? 1 : 0],
                  .altitude_m = has_point ? numbers[2] : 0};
  return out;
}

}  // namespace

void DjiSubtitles::add_height(Timestamp stamp, double height_m) {
  if (repeats(flight_.height_m, stamp, height_m, std::equal_to<>())) return;
  append(flight_.height_m, stamp, height_m, flight_.rejected);
}

void DjiSubtitles::add_position(Timestamp stamp, const GeodeticPosition& position) {
  if (position.latitude_deg == 0 && position.longitude_deg == 0) {
    ++without_fix_;
    return;
  }
  const auto equal = [](const GeodeticPosition& a, const GeodeticPosition& b) {
    return a.latitude_deg == b.latitude_deg && a.longitude_deg == b.longitude_deg &&
           a.altitude_m == b.altitude_m;
  };
  if (repeats(flight_.positions, stamp, position, equal)) return;
  append(flight_.positions, stamp, position, flight_.rejected);
}

// Of the first cue that has them: focal length for the 35 mm format in mm or 0.1 mm, digital zoom
// as factor or in 1e-4. Focal lengths of this kind keep the diagonal field of view; of a 4:3
// sensor, of which 16:9 video uses the full width, the width is 34.6 mm.
void DjiSubtitles::read_camera(std::string_view cue) {
  if (!flight_.horizontal_fov_deg) {
    if (std::optional<double> focal_mm = number_of(cue, "focal_len")) {
      if (*focal_mm >= 200) *focal_mm /= 10;
      double zoom = number_of(cue, "dzoom_ratio").value_or(1);
      if (zoom >= 1000) zoom /= 10000;
      if (*focal_mm > 5 && *focal_mm < 1000 && zoom >= 1 && zoom <= 30) {
        flight_.horizontal_fov_deg =
            2 / kDegree * std::atan(kFormatWidth_mm / 2 / (*focal_mm * zoom));
      }
    }
  }
  if (!flight_.mount_down_deg) {
    const std::optional<double> pitch_deg = number_of(cue, "gb_pitch");
    if (pitch_deg && std::abs(*pitch_deg) <= 90) {
      flight_.mount_down_deg = -*pitch_deg;
      flight_.assumed(fmt::format(
          "mount: {:g} deg below the horizon, the gimbal's pitch in the first subtitle, for the "
          "whole flight",
          *flight_.mount_down_deg));
    }
  }
}

void DjiSubtitles::add(Timestamp stamp, std::string_view cue) {
  ++cues_;
  read_camera(cue);
  std::optional<double> relative_m = number_of(cue, "rel_alt");
  if (!relative_m) relative_m = number_of(cue, "H", " ");
  std::optional<double> height_m = relative_m ? relative_m : number_of(cue, "BAROMETER");
  std::optional<double> altitude_m = number_of(cue, "abs_alt");
  if (!altitude_m) altitude_m = number_of(cue, "altitude");
  if (height_m) add_height(stamp, *height_m);
  if (relative_m && flight_.height_m.values.size() == 1 && flight_.height_m.values[0] > 0) {
    flight_.initial_height_m = flight_.height_m.values[0];
  }

  std::optional<double> longitude_deg = number_of(cue, "longitude");
  if (!longitude_deg) longitude_deg = number_of(cue, "longtitude");
  const std::optional<double> latitude_deg = number_of(cue, "latitude");
  if (latitude_deg && longitude_deg) {
    const GeodeticPosition position{.latitude_deg = *latitude_deg,
                                    .longitude_deg = *longitude_deg,
                                    .altitude_m = altitude_m ? *altitude_m : height_m.value_or(0)};
    if (!flight_.takeoff_altitude_m && relative_m) {
      flight_.takeoff_altitude_m = position.altitude_m - *relative_m;
    }
    add_position(stamp, position);
  } else if (std::optional<GpsTriple> gps = gps_triple(cue)) {
    if (!gps->has_altitude) gps->position.altitude_m = height_m.value_or(0);
    if (!std::exchange(has_position_order_, true)) {
      flight_.assumed(fmt::format(
          "position: GPS(...) lists {}",
          gps->has_altitude ? "latitude, longitude, altitude" : "longitude, latitude, satellites"));
    }
    add_position(stamp, gps->position);
  }
}

ImportedFlight DjiSubtitles::finish() {
  if (flight_.positions.stamps.empty() && flight_.height_m.stamps.empty()) {
    throw InputError(
        fmt::format("no position or height in {} subtitles; switch on video captions in the "
                    "drone's camera settings",
                    cues_));
  }
  if (without_fix_ > 0) {
    flight_.missing(
        fmt::format("position: {} of {} subtitles without GNSS fix", without_fix_, cues_));
  }
  return std::move(flight_);
}

ImportedFlight read_dji_subtitles(const std::filesystem::path& file) {
  constexpr std::size_t kMaxLineBytes = 8192;
  ByteSource source(file);
  DjiSubtitles subtitles;
  std::optional<Timestamp> start;
  std::string cue;
  const auto finish_cue = [&] {
    if (start && !cue.empty()) subtitles.add(*start, cue);
    start.reset();
    cue.clear();
  };
  // lines end with CR, LF or both
  for (Bytes bytes; !(bytes = source.peek(kMaxLineBytes)).empty();) {
    const std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t length = std::min(rest.find_first_of("\r\n"), rest.size());
    if (length == kMaxLineBytes) {
      throw InputError(file.string() + ": a line is longer than 8 KiB; the file is damaged");
    }
    const std::string_view line = rest.substr(0, length);
    if (const std::optional<Timestamp> next = cue_start(line)) {
      finish_cue();
      start = next;
    } else if (start && cue.size() < kMaxLineBytes) {
      cue.append(line).push_back('\n');
    }
    source.skip(length + 1);
  }
  finish_cue();
  try {
    return subtitles.finish();
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

}  // namespace stillkite
