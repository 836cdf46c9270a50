#include "io/euroc_dataset.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "geometry/fields.hpp"
#include "io/table_reader.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

std::optional<fs::path> if_there(const fs::path& file) {
  return fs::is_regular_file(file) ? std::optional(file) : std::nullopt;
}

bool is_picture(const fs::path& file) {
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

// frame2 before frame10: runs of digits compare by value, all else letter by letter.
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
  // absolute first: the parent of "." is nothing
  const fs::path mav0 = fs::absolute(cam0 / "..").lexically_normal().parent_path();
  std::optional<fs::path> twists = if_there(mav0.parent_path() / "velocity.csv");
  if (!twists) twists = if_there(mav0 / "velocity.csv");
  return EurocDataset{.images_csv = cam0 / "data.csv",
                      .calibration = if_there(cam0 / "sensor.yaml"),
                      .truth = if_there(mav0 / "state_groundtruth_estimate0/data.csv"),
                      .camera_twists = twists};
}

std::vector<StampedImage> read_image_list(const fs::path& images_csv) {
  TableReader table(images_csv, Separator::comma, 2);
  std::vector<StampedImage> images;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    const fs::path file = images_csv.parent_path() / "data" / std::string(table.text(1));
    if (!fs::is_regular_file(file)) {
      table.reject(fmt::format("the picture {} is not there", file.string()));
    }
    images.push_back({stamp, file});
  }
  if (images.empty()) throw InputError(images_csv.string() + ": lists no picture");
  constexpr double kShortest_s = 1e-4;
  const double mean_s = seconds_between(images.front().stamp, images.back().stamp) /
                        static_cast<double>(std::max<std::size_t>(1, images.size() - 1));
  if (mean_s > 0 && mean_s < kShortest_s) {
    throw InputError(fmt::format(
        "{}: the pictures are {:.3g} ms apart; its stamps are to be nanoseconds, are they "
        "microseconds?",
        images_csv.string(), 1e3 * mean_s));
  }
  return images;
}

std::vector<StampedImage> list_images(const fs::path& folder, double rate_hz) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_picture(entry.path())) {
      names.push_back(entry.path().filename().string());
    }
  }
  if (names.empty()) {
    throw InputError(folder.string() +
                     ": holds no picture (png, jpg, bmp, tif, pgm, ppm, webp) and no EuRoC data "
                     "set (mav0/cam0/data.csv)");
  }
  std::sort(names.begin(), names.end(), in_natural_order);
  std::vector<StampedImage> images;
  for (const std::string& name : names) {
    const double t_s = static_cast<double>(images.size()) / rate_hz;
    images.push_back({from_seconds(t_s), folder / name});
  }
  return images;
}

}  // namespace stillkite
