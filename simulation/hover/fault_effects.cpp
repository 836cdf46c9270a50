#include "simulation/hover/fault_effects.hpp"

#include <cmath>
#include <numbers>

#include "simulation/random.hpp"

namespace stillkite {
namespace {

// Pattern of squares, 24 px wide, with random grey values.
float pattern_grey(int across_px, int down_px) {
  constexpr int kSquare_px = 24;
  constexpr int kOffset_px = 1 << 20;  // makes the dividend positive
  const auto column = static_cast<std::uint64_t>((across_px + kOffset_px) / kSquare_px);
  const auto row = static_cast<std::uint64_t>(down_px / kSquare_px);
  return static_cast<float>(40 + (mix_bits((column << 32) + row) & 0x7fU));
}

}  // namespace

HoverReadings with_fault(HoverReadings readings, const FaultEffect& fault) {
  for (AttitudeReading& reading : readings.attitude) {
    reading.angular_rate_in_body_rad_s.array() += fault.gyro_bias_rad_s;
    if (fault.heading_error_rad == 0) continue;
    reading.world_from_body = Eigen::AngleAxisd(fault.heading_error_rad, Eigen::Vector3d::UnitZ()) *
                              reading.world_from_body;
  }
  return readings;
}

cv::Mat occluded(const cv::Mat& irradiance, double ratio, double t_s) {
  constexpr double kAmplitude_px = 80;
  constexpr double kPeriod_s = 2;
  const int shift_px = static_cast<int>(
      std::lround(kAmplitude_px * std::sin(2 * std::numbers::pi * t_s / kPeriod_s)));
  cv::Mat out = irradiance.clone();
  const int rows = static_cast<int>(std::lround(ratio * irradiance.rows));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < irradiance.cols; ++column) {
      out.at<float>(row, column) = pattern_grey(column + shift_px, row);
    }
  }
  return out;
}

PatchScene displace_floor(PatchScene scene, const Eigen::Vector3d& by_m) {
  for (Patch& patch : scene.patches) {
    const bool is_floor = patch.corner_in_world_m.z() == 0 && patch.right_in_world_m.z() == 0 &&
                          patch.down_in_world_m.z() == 0;
    if (is_floor) patch.corner_in_world_m += by_m;
  }
  return scene;
}

}  // namespace stillkite
