#include "io/setup/image_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "geometry/median.hpp"
#include "io/setup/block_statistics.hpp"

namespace stillkite {
namespace {

// Frame for the motion blur: loss of the gradients' squares along the displacement, as the variance
// of a blur, and the squared displacement.
struct BlurSample {
  double variance_px2 = 0;
  double shift2_px2 = 0;
};

std::optional<BlurSample> blur_sample(const ImageGradients& frame) {
  constexpr double kMinShift_px = 0.5;  // below it the direction is noise
  const double shift_px = frame.shift_px.norm();
  if (!(shift_px > kMinShift_px)) return std::nullopt;
  const Eigen::Vector2d u = frame.shift_px / shift_px;
  const Eigen::Vector2d v(-u.y(), u.x());
  const Eigen::Vector3d w(u.x() * u.x(), u.x() * u.y(), u.y() * u.y());
  const double along = u.dot(frame.first * u), across = v.dot(frame.first * v);
  const Eigen::Vector3d cross(-w.y(), 0.5 * (w.x() - w.z()), w.y());
  const double loss = w.dot(frame.second * w) / along - cross.dot(frame.second * cross) / across;
  if (!(along > 0 && across > 0 && loss > 0)) return std::nullopt;
  return BlurSample{-std::log(along / across) / loss, shift_px * shift_px};
}

struct Line {
  double slope = 0;
  double spread = 0;  // standard deviation of the abscissa
};

template <typename Excluded>
Line line_of(std::span<const BlurSample> samples, const Excluded& excluded) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (excluded(i)) continue;
    n += 1;
    x += samples[i].shift2_px2;
    y += samples[i].variance_px2;
    xx += samples[i].shift2_px2 * samples[i].shift2_px2;
    xy += samples[i].shift2_px2 * samples[i].variance_px2;
  }
  const double variance = xx / n - (x / n) * (x / n);
  return {(xy / n - x * y / (n * n)) / std::max(variance, 1e-12),
          std::sqrt(std::max(variance, 0.0))};
}

double quantile_of(std::vector<double>& values, double ratio) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(ratio * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

SetupFinding sharpness_finding(const ImageStatistics& images) {
  constexpr double kMaxBlur_px = 4;
  const double blur_px = images.blur_px();
  SetupFinding out{.question = "sharpness",
                   .verdict = blur_px <= kMaxBlur_px ? SetupVerdict::ok : SetupVerdict::doubtful,
                   .text = fmt::format("blur of at most {:.1f} px (Gaussian sigma; bound {:g} px)",
                                       blur_px, kMaxBlur_px),
                   .measured = SetupMeasurement{blur_px, {}, kMaxBlur_px, "px"}};
  if (out.verdict != SetupVerdict::ok) {
    out.remedy = "focus the lens, clean it, or record fewer pixels at a lower compression";
  }
  return out;
}

SetupFinding exposure_finding(const ImageStatistics& images) {
  constexpr double kMaxClipped = 0.3, kMaxWrong = 0.6;
  const double saturated = images.saturated_ratio(), dark = images.dark_ratio();
  const double clipped = saturated + dark;
  SetupFinding out{
      .question = "exposure",
      .verdict = clipped <= kMaxClipped ? SetupVerdict::ok
                 : clipped <= kMaxWrong ? SetupVerdict::doubtful
                                        : SetupVerdict::wrong,
      .text = fmt::format("{:.1f} % of the pixels saturated, {:.1f} % dark (bound {:g} % in all)",
                          100 * saturated, 100 * dark, 100 * kMaxClipped),
      .measured = SetupMeasurement{clipped, {}, kMaxClipped, "ratio"}};
  if (out.verdict != SetupVerdict::ok) {
    out.remedy =
        "change the exposure of the camera; mask what never shows the scene: calibration: "
        "{mask_path: FILE}";
  }
  return out;
}

SetupFinding texture_finding(const ImageStatistics& images) {
  constexpr double kMinTextured = 0.2, kMinUsable = 0.05;  // the latter: is_textureless
  const double textured = images.textured_ratio();
  SetupFinding out{.question = "texture",
                   .verdict = textured >= kMinTextured ? SetupVerdict::ok
                              : textured >= kMinUsable ? SetupVerdict::doubtful
                                                       : SetupVerdict::wrong,
                   .text = fmt::format(
                       "{:.0f} % of the image is textured at a quarter of its size (bound {:g} %)",
                       100 * textured, 100 * kMinTextured),
                   .measured = SetupMeasurement{textured, {}, kMinTextured, "ratio"}};
  if (out.verdict != SetupVerdict::ok) {
    out.remedy = "fly higher over weak texture, or correct focus and exposure";
  }
  return out;
}

SetupFinding shutter_finding(std::span<const ImageGradients> frames, double frame_interval_s) {
  constexpr double kMinSigmas = 3, kMaxBlur_px = 4, kFast = 0.95;
  constexpr std::size_t kMinSamples = 100;
  SetupFinding out{.question = "shutter"};
  std::vector<BlurSample> samples;
  std::vector<double> shifts_px;
  for (const ImageGradients& frame : frames) {
    if (const auto sample = blur_sample(frame)) {
      samples.push_back(*sample);
      shifts_px.push_back(std::sqrt(sample->shift2_px2));
    }
  }
  if (samples.size() < kMinSamples || !(frame_interval_s > 0)) {
    out.text = fmt::format("{} images with a measured displacement, {} needed", samples.size(),
                           kMinSamples);
    return out;
  }
  const BlockEstimate slope = block_jackknife(
      samples.size(), [&](const auto& excluded) { return line_of(samples, excluded).slope; });
  const double fast_px = quantile_of(shifts_px, kFast);
  // slope = (exposure / interval)^2 / 12
  const double limit = std::max(slope.value, 0.0) + kMinSigmas * slope.sigma;
  const double blur_limit_px = std::sqrt(12 * limit) * fast_px;
  const bool is_measured = slope.value > kMinSigmas * slope.sigma;
  const double ratio = std::sqrt(12 * std::max(slope.value, 0.0));
  const double blur_px = ratio * fast_px;
  if (ratio > 1 || (!is_measured && blur_limit_px > kMaxBlur_px)) {
    out.text = fmt::format(
        "motion blur not distinguished from texture (below {:.1f} px at {:.0f} px "
        "per frame)",
        blur_limit_px, fast_px);
    return out;
  }
  out.verdict = SetupVerdict::ok;
  out.measured = SetupMeasurement{blur_px, {}, kMaxBlur_px, "px"};
  if (!is_measured) {
    out.measured->value = blur_limit_px;
    out.text = fmt::format("motion blur below {:.1f} px at {:.0f} px per frame (bound {:g} px)",
                           blur_limit_px, fast_px, kMaxBlur_px);
    return out;
  }
  const double ratio_sigma = 6 * slope.sigma / ratio;
  out.measured->sigma = ratio_sigma * fast_px;
  out.text = fmt::format(
      "exposure of {:.1f} +- {:.1f} ms by the motion blur, {:.1f} px at {:.0f} px per frame (bound "
      "{:g} px)",
      1e3 * ratio * frame_interval_s, 1e3 * ratio_sigma * frame_interval_s, blur_px, fast_px,
      kMaxBlur_px);
  if (blur_px - kMinSigmas * *out.measured->sigma > kMaxBlur_px) {
    out.verdict = SetupVerdict::doubtful;
    out.remedy = "shorten the exposure";
  }
  return out;
}

SetupFinding frame_rate_finding(const FrameStamps& stamps) {
  constexpr double kMaxJitter = 0.1, kMaxMissed = 0.05;
  constexpr std::size_t kMinFrames = 10;
  SetupFinding out{.question = "frame rate"};
  const std::size_t count = stamps.filtered.size();
  if (count < kMinFrames) {
    out.text = fmt::format("{} images, {} needed", count, kMinFrames);
    return out;
  }
  std::vector<double> intervals_s;
  double error2 = 0;
  for (std::size_t i = 1; i < count; ++i) {
    intervals_s.push_back(seconds_between(stamps.filtered[i - 1], stamps.filtered[i]));
    const double recorded_s = seconds_between(stamps.recorded[i - 1], stamps.recorded[i]);
    error2 += (recorded_s - intervals_s.back()) * (recorded_s - intervals_s.back());
  }
  const double period_s = median(intervals_s);
  double missed = 0;
  for (const double interval_s : intervals_s) missed += std::round(interval_s / period_s) - 1;
  const double missed_ratio = missed / (missed + static_cast<double>(intervals_s.size()));
  const double jitter = std::sqrt(error2 / static_cast<double>(intervals_s.size())) / period_s;
  out.text = fmt::format(
      "{:.4g} images/s, {:.0f} of {:.0f} missing, jitter {:.2g} % of the interval "
      "(bounds {:g} and {:g} %)",
      1 / period_s, missed, missed + static_cast<double>(count), 100 * jitter, 100 * kMaxMissed,
      100 * kMaxJitter);
  out.measured = SetupMeasurement{1 / period_s, {}, {}, "1/s"};
  out.verdict = SetupVerdict::ok;
  if (jitter > kMaxJitter || missed_ratio > kMaxMissed) {
    out.verdict = SetupVerdict::doubtful;
    out.remedy = fmt::format(
        "record the time of exposure; if the camera is regular: source: {{rate_hz: {:.4g}}}",
        1 / period_s);
  }
  return out;
}

SetupFinding displacement_finding(std::vector<double> displacements_px, int width_px) {
  constexpr double kMaxRatio = 0.15, kFast = 0.95;
  constexpr std::size_t kMinFrames = 10;
  SetupFinding out{.question = "displacement between images"};
  if (displacements_px.size() < kMinFrames) {
    out.text = fmt::format("measured in {} images, {} needed", displacements_px.size(), kMinFrames);
    return out;
  }
  const double fast_px = quantile_of(displacements_px, kFast);
  const double bound_px = kMaxRatio * width_px;
  out.verdict = fast_px <= bound_px ? SetupVerdict::ok : SetupVerdict::doubtful;
  out.measured = SetupMeasurement{fast_px, {}, bound_px, "px"};
  out.text =
      fmt::format("below {:.3g} px in 95 % of the images (bound {:.3g} px, {:g} % of the width)",
                  fast_px, bound_px, 100 * kMaxRatio);
  if (out.verdict != SetupVerdict::ok) out.remedy = "record more images per second, or fly higher";
  return out;
}

}  // namespace stillkite
