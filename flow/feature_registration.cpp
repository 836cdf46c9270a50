#include "flow/feature_registration.hpp"

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core/mat.hpp>
#include <span>
#include <utility>

#include "flow/image_registration.hpp"

namespace stillkite {
namespace {

bool is_found(const FeatureTracks& tracks) {
  constexpr double kMinFoundRatio = 0.5;  // never reached at a wrong registration
  return tracks.found_count >= kMinFoundRatio * static_cast<double>(tracks.found.size());
}

AffineFlow motion_of(const ImageRegistration& registration, const cv::Mat& image) {
  AffineFlow motion{.origin_px = {0.5F * static_cast<float>(image.cols - 1),
                                  0.5F * static_cast<float>(image.rows - 1)},
                    .offset_px = registration.shift_px.cast<float>()};
  motion.gradient =
      Eigen::Rotation2Df(static_cast<float>(registration.rotation_rad)).toRotationMatrix() -
      Eigen::Matrix2f::Identity();
  return motion;
}

// Better of `best` and the alignments from the registrations at these rotations.
PatchAlignment::Solution best_of(PatchAlignment::Solution best, PatchAlignment& alignment,
                                 std::span<const double> rotations_rad) {
  const cv::Mat& current = alignment.current();
  for (const ImageRegistration& registration : register_images(
           alignment.reference(), current, Eigen::Matrix3d::Identity(), rotations_rad)) {
    if (is_found(best.tracks)) break;
    alignment.align_from(motion_of(registration, current));
    if (alignment.tracks().found_count <= best.tracks.found_count) continue;
    best = alignment.solution();
  }
  return best;
}

}  // namespace

void register_lost_features(PatchAlignment& alignment, std::optional<double> image_rotation_rad) {
  const AffineFlow previous_motion = alignment.motion();
  PatchAlignment::Solution best = alignment.solution();
  if (image_rotation_rad) {
    best = best_of(std::move(best), alignment, std::array{*image_rotation_rad});
  } else {
    // rotation 0 first: usually sufficient and 7 times faster
    best = best_of(std::move(best), alignment, kNoRotation_rad);
    if (!is_found(best.tracks)) best = best_of(std::move(best), alignment, kSmallRotations_rad);
  }
  alignment.restore(std::move(best), previous_motion);
}

}  // namespace stillkite
