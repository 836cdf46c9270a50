#include "io/import/gopro_stream.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr double kNoFix = std::numeric_limits<double>::quiet_NaN();

// Elements of a STRM element that describe its samples.
struct Description {
  std::vector<double> scale;
  std::string_view types;
  double fix = 3;
};

Eigen::Vector<double, 5> scaled(const std::vector<double>& numbers, const Description& about,
                                std::string_view key) {
  constexpr std::size_t kGps9Fix = 8;
  constexpr double kFix2d = 2;
  Eigen::Vector<double, 5> out = Eigen::Vector<double, 5>::Zero();
  for (std::size_t i = 0; i < numbers.size() && i < 5; ++i) {
    const double scale =
        about.scale.empty()
            ? 1
            : about.scale[about.scale.size() == 1 ? 0 : std::min(i, about.scale.size() - 1)];
    out[static_cast<Eigen::Index>(i)] = scale != 0 ? numbers[i] / scale : numbers[i];
  }
  const bool has_fix = key == "GPS9" ? numbers.size() > kGps9Fix && numbers[kGps9Fix] >= kFix2d
                                     : about.fix >= kFix2d;
  if (key.starts_with("GPS") && !has_fix) out.setConstant(kNoFix);
  return out;
}

// Times of the first samples of the payloads, and of the end of the last, in s after the first.
std::vector<double> block_times_s(const GoproStream& stream, bool by_sensor) {
  std::vector<double> out;
  const GoproStream::Block& front = stream.blocks.front();
  for (const GoproStream::Block& block : stream.blocks) {
    out.push_back(by_sensor ? seconds_between(*front.sensor, *block.sensor)
                            : seconds_between(front.start, block.start));
  }
  const GoproStream::Block& back = stream.blocks.back();
  out.push_back(out.back() + seconds_between(back.start, back.end));
  return out;
}

// Least squares of time over sample number at the starts of the payloads.
struct Line {
  double offset_s = 0, period_s = 0, rms_s = 0;
};

Line fit_line(const std::vector<GoproStream::Block>& blocks, const std::vector<double>& t_s) {
  const auto n = static_cast<double>(blocks.size());
  double mean_i = 0, mean_t = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    mean_i += static_cast<double>(blocks[k].first) / n;
    mean_t += t_s[k] / n;
  }
  double ii = 0, it = 0, tt = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const double i = static_cast<double>(blocks[k].first) - mean_i, t = t_s[k] - mean_t;
    ii += i * i;
    it += i * t;
    tt += t * t;
  }
  const double period_s = it / ii;
  return {.offset_s = mean_t - period_s * mean_i,
          .period_s = period_s,
          .rms_s = std::sqrt(std::max(0.0, tt - period_s * it) / n)};
}

}  // namespace

std::string_view samples_key(Bytes stream_element) {
  std::string_view key;
  while (const std::optional<GpmfElement> element = take_gpmf(stream_element)) key = element->key;
  return key;
}

void append_samples(GoproStream& stream, Bytes stream_element, std::string_view key,
                    Timestamp start, Timestamp end) {
  constexpr std::size_t kMaxSamples = 20'000'000;
  Description about;
  GoproStream::Block block{.start = start, .end = end, .first = stream.samples.size()};
  while (const std::optional<GpmfElement> element = take_gpmf(stream_element)) {
    if (element->key == "SCAL") {
      about.scale.clear();
      for (std::size_t i = 0; i < std::min<std::size_t>(element->repeat, 16); ++i) {
        for (const double value : element->numbers(i)) about.scale.push_back(value);
      }
    } else if (element->key == "TYPE") {
      about.types = element->text();
    } else if (element->key == "ORIN") {
      stream.axes = element->text();
    } else if (element->key == "STMP") {
      const std::vector<double> t_us = element->numbers(0);
      if (!t_us.empty() && t_us[0] >= 0 && t_us[0] < 1e15)
        block.sensor = from_seconds(1e-6 * t_us[0]);
    } else if (element->key == "GPSF") {
      const std::vector<double> fix = element->numbers(0);
      if (!fix.empty()) about.fix = fix[0];
    } else if (element->key == key) {
      for (std::size_t i = 0; i < element->repeat; ++i) {
        const std::vector<double> numbers = element->numbers(i, about.types);
        if (!numbers.empty()) stream.samples.push_back(scaled(numbers, about, key));
      }
    }
  }
  if (stream.samples.size() > kMaxSamples) {
    throw InputError("more than 2e7 samples of one sensor; import a shorter video");
  }
  if (stream.samples.size() > block.first) stream.blocks.push_back(block);
}

std::optional<Timestamp> first_sensor_stamp(const GoproStream& stream) {
  for (const GoproStream::Block& block : stream.blocks) {
    if (!block.sensor) return std::nullopt;
  }
  return stream.blocks.empty() ? std::nullopt : stream.blocks.front().sensor;
}

std::vector<Timestamp> sample_stamps(const GoproStream& stream, std::optional<Timestamp> origin) {
  std::vector<Timestamp> out;
  if (stream.blocks.empty()) return out;
  const std::vector<GoproStream::Block>& blocks = stream.blocks;
  const std::optional<Timestamp> sensor = first_sensor_stamp(stream);
  const bool by_sensor = sensor && origin;
  const std::vector<double> t_s = block_times_s(stream, by_sensor);
  const Timestamp first{by_sensor ? sensor->ns - origin->ns : blocks.front().start.ns};
  constexpr double kMax_s = 1e9;  // damaged stamps, extrapolated
  const auto stamp = [&](double time_s) {
    return Timestamp{first.ns + from_seconds(std::clamp(time_s, -kMax_s, kMax_s)).ns};
  };

  constexpr std::size_t kMinBlocks = 3;
  constexpr double kMaxRms_periods = 1.5;
  if (blocks.size() >= kMinBlocks) {
    const Line line = fit_line(blocks, t_s);
    if (line.period_s > 0 && line.rms_s < kMaxRms_periods * line.period_s) {
      for (std::size_t i = 0; i < stream.samples.size(); ++i) {
        out.push_back(stamp(line.offset_s + line.period_s * static_cast<double>(i)));
      }
      return out;
    }
  }
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const std::size_t end = k + 1 < blocks.size() ? blocks[k + 1].first : stream.samples.size();
    const double step_s = (t_s[k + 1] - t_s[k]) / static_cast<double>(end - blocks[k].first);
    for (std::size_t i = blocks[k].first; i < end; ++i) {
      out.push_back(stamp(t_s[k] + step_s * static_cast<double>(i - blocks[k].first)));
    }
  }
  return out;
}

}  // namespace stillkite
