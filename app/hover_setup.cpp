#include "app/hover_setup.hpp"

#include <fmt/format.h>

#include <array>
#include <opencv2/imgcodecs.hpp>

#include "io/config/config_binding.hpp"
#include "navigation/effective_config.hpp"

namespace stillkite {
namespace {

constexpr std::array<std::string_view, 7> kSharedHoverSections{
    "seed", "scene", "trials", "link", "plant_file", "plant", "serve"};

/// JPEG compression of the video link.
cv::Mat through_jpeg(const cv::Mat& grey, int quality) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
}

}  // namespace

HoverConfig load_hover_config(const std::optional<std::filesystem::path>& file,
                              const std::vector<std::string>& overrides) {
  return bind_hover_config(read_config(file, overrides));
}

HoverConfig bind_hover_config(const ConfigNode& root) {
  HoverConfig config;
  if (root.find("plant_file") != nullptr) {
    const auto plant_file = bind_config<HoverConfig>(root).plant_file;
    if (plant_file) {
      config.plant = bind_config<PlantConfig>(read_config_section(*plant_file, "plant."));
    }
  }
  config = bind_config<HoverConfig>(root, config);
  // a trial measures its initial height
  config.navigator =
      effective_config(config.navigator, config.estimator.policy, ScaleSource::initial_height);
  return config;
}

HoverWorld make_world(const HoverConfig& config) {
  const int quality = config.link.jpeg_quality;
  if (quality == 0) return make_hover_world(config);
  return make_hover_world(config,
                          [quality](const cv::Mat& grey) { return through_jpeg(grey, quality); });
}

std::vector<HoverVariant> load_hover_variants(const std::filesystem::path& file,
                                              const std::vector<std::string>& overrides,
                                              const std::vector<VariantName>& names) {
  require_shared(names, kSharedHoverSections);
  return load_each<HoverConfig>(names, overrides, [&](const std::vector<std::string>& keys) {
    return load_hover_config(file, keys);
  });
}

}  // namespace stillkite
