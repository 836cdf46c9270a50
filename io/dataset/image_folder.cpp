#include "io/dataset/image_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Natural order: runs of digits compare by value (frame2 before frame10), other characters by code.
bool in_natural_order(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    const auto number = [](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t first = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return std::string_view(text).substr(first, at - first);
    };
    const std::string_view left = number(a, i);
    const std::string_view right = number(b, j);
    if (left.size() != right.size()) return left.size() < right.size();
    if (left != right) return left < right;
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

// Last number of a file name, and the name with `*` in its place.
struct NumberedName {
  std::string pattern;
  std::int64_t number = 0;
};

std::string digits_before(const std::string& name, std::size_t end) {
  std::size_t first = end;
  while (first > 0 && is_digit(name[first - 1])) --first;
  return name.substr(first, end - first);
}

std::optional<std::int64_t> parsed(const std::string& digits) {
  std::int64_t number = 0;
  const char* const end = digits.data() + digits.size();
  const auto [at, error] = std::from_chars(digits.data(), end, number);
  return error == std::errc() && at == end ? std::optional(number) : std::nullopt;
}

// Seconds with decimals, such as 1305031102.175304, are one number.
std::optional<NumberedName> numbered(const std::string& name) {
  constexpr std::size_t kMinDecimals = 3, kMaxDecimals = 9, kMinSeconds = 9;
  std::size_t end = std::min(name.rfind('.'), name.size());
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::string digits = digits_before(name, end);
  std::size_t first = end - digits.size();
  if (digits.size() >= kMinDecimals && digits.size() <= kMaxDecimals && first > 0 &&
      name[first - 1] == '.') {
    const std::string seconds = digits_before(name, first - 1);
    if (seconds.size() >= kMinSeconds) {
      first -= seconds.size() + 1;
      digits.insert(0, seconds);
    }
  }
  const std::optional<std::int64_t> number = parsed(digits);
  if (!number) return std::nullopt;
  return NumberedName{name.substr(0, first) + '*' + name.substr(end), *number};
}

// Name with `#` for its numbers, except those of a camera (cam0), and the numbers.
struct SeriesName {
  std::string series;
  std::string numbers;
};

SeriesName series_of(const std::string& name) {
  SeriesName out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (!is_digit(name[i])) {
      out.series += name[i];
      continue;
    }
    const bool is_camera = out.series.ends_with("cam") || out.series.ends_with("camera");
    if (!is_camera) out.series += '#';
    const std::size_t first = i;
    while (i + 1 < name.size() && is_digit(name[i + 1])) ++i;
    (is_camera ? out.series : out.numbers += ' ') += name.substr(first, i + 1 - first);
  }
  return out;
}

// Rejects images of two cameras, thumbnails and copies in another format: equal numbers in
// different names.
void reject_several_series(const std::vector<std::string>& names, const fs::path& folder) {
  std::map<std::string, std::set<std::string>> numbers_of;
  for (const std::string& name : names) {
    const SeriesName found = series_of(name);
    if (!found.numbers.empty()) numbers_of[found.series].insert(found.numbers);
  }
  std::erase_if(numbers_of, [](const auto& entry) { return entry.second.size() < 2; });
  for (auto a = numbers_of.begin(); a != numbers_of.end(); ++a) {
    for (auto b = std::next(a); b != numbers_of.end(); ++b) {
      const auto shared = std::ranges::count_if(
          a->second, [&](const std::string& numbers) { return b->second.contains(numbers); });
      if (2 * shared < std::ssize(a->second) || 2 * shared < std::ssize(b->second)) continue;
      throw InputError(fmt::format(
          "{}: two series of images with equal numbers, {} ({} images) and {} ({}); move each "
          "into a folder of its own",
          folder.string(), a->first, a->second.size(), b->first, b->second.size()));
    }
  }
}

// Frame numbers of counters: the numbers have a common step, skipped steps are missing images.
std::optional<std::vector<std::int64_t>> by_common_step(const std::vector<std::int64_t>& numbers,
                                                        const std::vector<std::int64_t>& steps) {
  // sparser numbers are no frame count
  constexpr std::int64_t kMaxStepsPerImage = 10;
  const std::int64_t step = *std::ranges::min_element(steps);
  const bool has_common_step =
      step > 0 && std::ranges::all_of(steps, [step](std::int64_t s) { return s % step == 0; });
  if (!has_common_step ||
      (numbers.back() - numbers.front()) / step > kMaxStepsPerImage * std::ssize(numbers)) {
    return std::nullopt;
  }
  std::vector<std::int64_t> frames;
  for (const std::int64_t number : numbers) frames.push_back((number - numbers.front()) / step);
  return frames;
}

// Frame numbers of time stamps: each step is nearly a multiple of the median step.
std::optional<std::vector<std::int64_t>> by_median_step(const std::vector<std::int64_t>& numbers,
                                                        const std::vector<std::int64_t>& steps) {
  constexpr std::int64_t kMinStamp = 100'000'000'000;  // of 12 digits
  constexpr double kMaxDeviation = 0.25;
  if (numbers.back() < kMinStamp) return std::nullopt;
  std::vector<std::int64_t> sorted = steps;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::ranges::nth_element(sorted, middle);
  const auto median = static_cast<double>(*middle);
  std::vector<std::int64_t> frames{0};
  for (const std::int64_t step : steps) {
    const double periods = static_cast<double>(step) / median;
    if (std::round(periods) < 1 || std::abs(periods - std::round(periods)) > kMaxDeviation) {
      return std::nullopt;
    }
    frames.push_back(frames.back() + std::llround(periods));
  }
  return frames;
}

// Time stamps since 1970 imply a rate.
void check_rate(const std::vector<std::int64_t>& numbers, const std::vector<std::int64_t>& frames,
                double rate_hz, const fs::path& folder) {
  constexpr double kMaxRatio = 1.02;
  constexpr double kFirst_s = 1e9, kLast_s = 4e9;  // 2001 to 2096
  for (const double unit_s : {1e-3, 1e-6, 1e-9}) {
    const double begin_s = unit_s * static_cast<double>(numbers.front());
    const double duration_s = unit_s * static_cast<double>(numbers.back() - numbers.front());
    if (begin_s < kFirst_s || begin_s > kLast_s || !(duration_s > 0)) continue;
    const double named_hz = static_cast<double>(frames.back()) / duration_s;
    if (named_hz < kMaxRatio * rate_hz && rate_hz < kMaxRatio * named_hz) return;
    throw InputError(fmt::format(
        "{}: the file names are time stamps of {:.4g} images per second, source.rate_hz is {:.4g}; "
        "set it to that rate, or list the images with their stamps in a EuRoC data set",
        folder.string(), named_hz, rate_hz));
  }
}

// Frame number of each image; consecutive unless the names differ in one number.
std::vector<std::int64_t> frame_numbers(const std::vector<std::string>& names, double rate_hz,
                                        const fs::path& folder) {
  std::vector<std::int64_t> consecutive(names.size());
  std::iota(consecutive.begin(), consecutive.end(), 0);
  std::vector<std::int64_t> numbers, steps;
  std::string pattern;
  for (const std::string& name : names) {
    const std::optional<NumberedName> found = numbered(name);
    if (!found || (!pattern.empty() && found->pattern != pattern)) return consecutive;
    pattern = found->pattern;
    if (!numbers.empty()) steps.push_back(found->number - numbers.back());
    numbers.push_back(found->number);
  }
  if (steps.empty()) return consecutive;
  auto frames = by_common_step(numbers, steps);
  if (!frames) frames = by_median_step(numbers, steps);
  check_rate(numbers, frames.value_or(consecutive), rate_hz, folder);
  return frames.value_or(consecutive);
}

}  // namespace

bool is_image(const fs::path& file) {
  constexpr auto kExtensions = std::to_array<std::string_view>(
      {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp"});
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<StampedImage> list_images(const fs::path& folder, std::optional<double> rate_hz) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && is_image(entry.path()) && !name.starts_with('.')) {
      names.push_back(name);
    }
  }
  if (names.empty()) {
    throw InputError(folder.string() +
                     ": no image (png, jpg, bmp, tif, pgm, ppm, webp) and no EuRoC data set "
                     "(mav0/cam0/data.csv) in this folder");
  }
  if (!rate_hz) {
    throw InputError(folder.string() +
                     ": the images have no time stamps; set their frame rate as source.rate_hz");
  }
  reject_several_series(names, folder);
  std::sort(names.begin(), names.end(), in_natural_order);
  const std::vector<std::int64_t> numbers = frame_numbers(names, *rate_hz, folder);
  std::vector<StampedImage> images;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double t_s = static_cast<double>(numbers[i]) / *rate_hz;
    images.push_back({from_seconds(t_s), folder / names[i]});
  }
  return images;
}

}  // namespace stillkite
