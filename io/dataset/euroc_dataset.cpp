#include "io/dataset/euroc_dataset.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <numeric>
#include <string>

#include "geometry/fields.hpp"
#include "io/dataset/table_reader.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

std::optional<fs::path> if_exists(const fs::path& file) {
  return fs::is_regular_file(file) ? std::optional(file) : std::nullopt;
}

bool is_image(const fs::path& file) {
  constexpr auto kExtensions = std::to_array<std::string_view>(
      {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp"});
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

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

std::optional<NumberedName> numbered(const std::string& name) {
  constexpr std::size_t kMaxDigits = 18;
  std::size_t end = name.rfind('.');
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t first = end;
  while (first > 0 && is_digit(name[first - 1])) --first;
  if (first == end || end - first > kMaxDigits) return std::nullopt;
  return NumberedName{name.substr(0, first) + '*' + name.substr(end),
                      std::stoll(name.substr(first, end - first))};
}

// Frame number of each image. If the names differ in a number with a common step, skipped steps are
// missing images; else images are consecutive.
std::vector<std::int64_t> frame_numbers(const std::vector<std::string>& names) {
  std::vector<std::int64_t> consecutive(names.size());
  std::iota(consecutive.begin(), consecutive.end(), 0);
  std::vector<std::int64_t> numbers;
  std::string pattern;
  for (const std::string& name : names) {
    const std::optional<NumberedName> found = numbered(name);
    if (!found || (!pattern.empty() && found->pattern != pattern)) return consecutive;
    pattern = found->pattern;
    numbers.push_back(found->number);
  }
  std::vector<std::int64_t> steps(numbers.size());
  std::adjacent_difference(numbers.begin(), numbers.end(), steps.begin());
  steps.front() = 0;
  if (names.size() < 2) return consecutive;
  const std::int64_t step = *std::min_element(steps.begin() + 1, steps.end());
  if (step <= 0) return consecutive;
  const bool has_common_step =
      std::all_of(steps.begin(), steps.end(), [step](std::int64_t s) { return s % step == 0; });
  // sparser numbers are no frame count
  constexpr std::int64_t kMaxStepsPerImage = 10;
  const std::int64_t last_number = (numbers.back() - numbers.front()) / step;
  if (!has_common_step || last_number > kMaxStepsPerImage * std::ssize(names)) return consecutive;
  const std::int64_t first = numbers.front();
  for (std::int64_t& number : numbers) number = (number - first) / step;
  return numbers;
}

}  // namespace

std::optional<EurocDataset> find_euroc_dataset(const fs::path& folder) {
  fs::path cam0 = folder;
  if (fs::exists(folder / "mav0/cam0/data.csv")) {
    cam0 = folder / "mav0/cam0";
  } else if (fs::exists(folder / "cam0/data.csv")) {
    cam0 = folder / "cam0";
  } else if (!fs::exists(folder / "data.csv") || !fs::is_directory(folder / "data")) {
    return std::nullopt;
  }
  // the parent of "." is empty, so make the path absolute first
  const fs::path mav0 = fs::absolute(cam0 / "..").lexically_normal().parent_path();
  std::optional<fs::path> twists = if_exists(mav0.parent_path() / "velocity.csv");
  if (!twists) twists = if_exists(mav0 / "velocity.csv");
  return EurocDataset{.images_csv = cam0 / "data.csv",
                      .calibration = if_exists(cam0 / "sensor.yaml"),
                      .truth = if_exists(mav0 / "state_groundtruth_estimate0/data.csv"),
                      .camera_twists = twists};
}

std::vector<StampedImage> read_image_list(const fs::path& images_csv) {
  TableReader table(images_csv, Separator::comma, 2);
  std::vector<StampedImage> images;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    const fs::path file = images_csv.parent_path() / "data" / std::string(table.text(1));
    if (!fs::is_regular_file(file)) {
      table.reject(fmt::format("the image {} is missing", file.string()));
    }
    images.push_back({stamp, file});
  }
  if (images.empty()) throw InputError(images_csv.string() + ": no image listed");
  constexpr double kMinInterval_s = 1e-4;
  const double mean_s = seconds_between(images.front().stamp, images.back().stamp) /
                        static_cast<double>(std::max<std::size_t>(1, images.size() - 1));
  if (mean_s > 0 && mean_s < kMinInterval_s) {
    throw InputError(
        fmt::format("{}: the images are {:.3g} ms apart; time stamps must be nanoseconds, not "
                    "microseconds",
                    images_csv.string(), 1e3 * mean_s));
  }
  return images;
}

std::vector<StampedImage> list_images(const fs::path& folder, double rate_hz) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_image(entry.path())) {
      names.push_back(entry.path().filename().string());
    }
  }
  if (names.empty()) {
    throw InputError(folder.string() +
                     ": no image (png, jpg, bmp, tif, pgm, ppm, webp) and no EuRoC data set "
                     "(mav0/cam0/data.csv) in this folder");
  }
  std::sort(names.begin(), names.end(), in_natural_order);
  const std::vector<std::int64_t> numbers = frame_numbers(names);
  std::vector<StampedImage> images;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double t_s = static_cast<double>(numbers[i]) / rate_hz;
    images.push_back({from_seconds(t_s), folder / names[i]});
  }
  return images;
}

}  // namespace stillkite
