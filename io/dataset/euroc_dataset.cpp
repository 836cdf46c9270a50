#include "io/dataset/euroc_dataset.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "geometry/fields.hpp"
#include "io/dataset/table_reader.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

std::optional<fs::path> if_exists(const fs::path& file) {
  return fs::is_regular_file(file) ? std::optional(file) : std::nullopt;
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

std::vector<StampedImage> read_image_list(const fs::path& images_csv,
                                          std::optional<double> rate_hz) {
  TableReader table(images_csv, Separator::comma, 2);
  std::vector<StampedImage> images;
  while (table.next()) {
    const Timestamp stamp =
        rate_hz && !images.empty()
            ? Timestamp{images.front().stamp.ns +
                        from_seconds(static_cast<double>(images.size()) / *rate_hz).ns}
            : table.stamp("; source.rate_hz counts the images instead");
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

}  // namespace stillkite
