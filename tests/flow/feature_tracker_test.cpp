#include "flow/feature_tracker.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flow/feature_detection.hpp"
#include "flow/opencv_feature_tracker.hpp"
#include "tests/flow/analytic_image.hpp"

namespace stillkite {
namespace {

const cv::Size kImageSize(400, 300);

Eigen::Affine2d motion_about_centre(double angle_rad, double scale, const Eigen::Vector2d& shift) {
  const Eigen::Vector2d centre(200, 150);
  return Eigen::Translation2d(centre + shift) * Eigen::Rotation2Dd(angle_rad) *
         Eigen::Scaling(scale) * Eigen::Translation2d(-centre);
}

std::vector<cv::Point2f> corners(const cv::Mat& grey) {
  return detect_features(grey, {.max_features = 200, .min_distance_px = 8});
}

/// Maximum error and number of the found features.
struct TrackError {
  double max_px = 0;
  int found = 0;
};
TrackError error_of(const FeatureTracks& tracks, const Eigen::Affine2d& motion) {
  TrackError error;
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    ++error.found;
    const Eigen::Vector2d truth = motion * tracks.reference_px[i].cast<double>();
    error.max_px = std::max(error.max_px, (tracks.current_px[i].cast<double>() - truth).norm());
  }
  return error;
}

// Masked in the reference or in the current image.
TEST(FeatureTracker, RejectsMaskedFeatures) {
  const Eigen::Affine2d motion = motion_about_centre(0, 1, {20, 0});
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  const cv::Mat current = analytic_frame(kImageSize, motion);
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const FeatureTracks all = tracker.track(current);
  cv::Mat valid_pixels(kImageSize, CV_8U, cv::Scalar(255));
  valid_pixels.colRange(150, 250) = 0;
  tracker.set_mask(std::make_shared<const ImageMask>(valid_pixels));
  const FeatureTracks masked = tracker.track(current);
  const auto is_in_mask = [](const Eigen::Vector2f& at_px) {
    return at_px.x() > 145 && at_px.x() < 255;
  };
  const auto is_far = [](const Eigen::Vector2f& at_px) {
    return at_px.x() < 140 || at_px.x() > 260;
  };
  int in_reference_mask = 0, in_current_mask = 0;
  for (std::size_t i = 0; i < all.found.size(); ++i) {
    const bool was_masked = is_in_mask(all.reference_px[i]),
               is_masked_now = is_in_mask(all.current_px[i]);
    EXPECT_FALSE((was_masked || is_masked_now) && masked.found[i] != 0)
        << all.reference_px[i].transpose();
    in_reference_mask += all.found[i] != 0 && was_masked ? 1 : 0;
    in_current_mask += all.found[i] != 0 && is_masked_now && is_far(all.reference_px[i]) ? 1 : 0;
    if (is_far(all.reference_px[i]) && is_far(all.current_px[i])) {
      EXPECT_EQ(masked.found[i], all.found[i]) << all.reference_px[i].transpose();
    }
  }
  EXPECT_GT(in_reference_mask, 10);
  EXPECT_GT(in_current_mask, 2);
  tracker.set_mask(nullptr);
  EXPECT_EQ(tracker.track(current).found, all.found);
}

TEST(FeatureTracker, TracksSmallMotion) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const struct {
    Eigen::Affine2d motion;
    double allowed_px = 0;
  } cases[] = {{motion_about_centre(0, 1, {0, 0}), 0.02},
               {motion_about_centre(0, 1, {3.3, -1.7}), 0.05},
               {motion_about_centre(0.01, 1.01, {-4.6, 2.2}), 0.05},
               {motion_about_centre(-0.02, 0.98, {2, 3}), 0.1}};
  for (const auto& at : cases) {
    tracker.set_reference(reference, corners(reference));
    const TrackError error =
        error_of(tracker.track(analytic_frame(kImageSize, at.motion)), at.motion);
    EXPECT_GT(error.found, 100);
    EXPECT_LT(error.max_px, at.allowed_px);
  }
}

// Faster than the pyramid reaches; the image moves on as in the interval before.
TEST(FeatureTracker, FindsFastMotionFromTheExpectedFlow) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  const Eigen::Affine2d motion = motion_about_centre(0.05, 1, {70, 30});
  const cv::Mat current = analytic_frame(kImageSize, motion);
  FeatureTracker tracker({.search = false});
  const auto accurate_count = [&](const AffineFlow& expected_px) {
    constexpr double kMaxError_px = 0.1;
    tracker.set_reference(reference, corners(reference));
    const FeatureTracks& tracks = tracker.track(current, {}, expected_px);
    int count = 0;
    for (std::size_t i = 0; i < tracks.found.size(); ++i) {
      const Eigen::Vector2d truth = motion * tracks.reference_px[i].cast<double>();
      const double error_px = (tracks.current_px[i].cast<double>() - truth).norm();
      count += tracks.found[i] != 0 && error_px < kMaxError_px;
    }
    return count;
  };
  EXPECT_LT(accurate_count({}), 10);
  EXPECT_GT(accurate_count({.origin_px = {200, 150}, .offset_px = {66, 33}}), 60);
}

// Normalized squared error e^T C^-1 e per coordinate, mean over the features; 1 if consistent.
double chi_square(const FeatureTracks& tracks, const Eigen::Affine2d& motion) {
  double sum = 0;
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    const Eigen::Vector2d truth = motion * tracks.reference_px[i].cast<double>();
    const Eigen::Vector2d error = tracks.current_px[i].cast<double>() - truth;
    sum += 0.5 * error.dot(tracks.covariance_px2[i].cast<double>().llt().solve(error));
  }
  return sum / tracks.found_count;
}

TEST(FeatureTracker, CovarianceIsConsistentUnderWhiteNoise) {
  const Eigen::Affine2d motion = motion_about_centre(0, 1, {3.3, -1.7});
  cv::RNG random(11);
  const auto noisy = [&](cv::Mat image, double noise_grey) {
    cv::Mat noise(kImageSize, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, noise_grey);
    cv::add(image, noise, image, cv::noArray(), CV_8U);
    return image;
  };
  const cv::Mat clean = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  const std::vector<cv::Point2f> features = corners(clean);
  for (const double noise_grey : {1.0, 3.0, 6.0, 9.0}) {
    FeatureTracker tracker({});
    tracker.set_reference(noisy(clean.clone(), noise_grey), features);
    const FeatureTracks& tracks =
        tracker.track(noisy(analytic_frame(kImageSize, motion), noise_grey));
    ASSERT_GT(tracks.found_count, 100);
    EXPECT_GT(chi_square(tracks, motion), 0.8) << noise_grey;
    EXPECT_LT(chi_square(tracks, motion), 1.3) << noise_grey;
  }
}

// Patches without visible noise, as after compression: the median noise of the image applies.
TEST(FeatureTracker, CovarianceHasLowerBoundOfMedianNoise) {
  const cv::Mat clean = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  const cv::Rect noisy_part(0, 0, 2 * kImageSize.width / 3, kImageSize.height);
  const auto median_trace_beyond = [&](double noise_grey) {
    cv::RNG random(12);
    const auto noisy = [&] {
      cv::Mat image = clean.clone();
      cv::Mat noise(noisy_part.size(), CV_32F);
      random.fill(noise, cv::RNG::NORMAL, 0, noise_grey);
      cv::add(image(noisy_part), noise, image(noisy_part), cv::noArray(), CV_8U);
      return image;
    };
    FeatureTracker tracker({});
    tracker.set_reference(noisy(), corners(clean));
    const FeatureTracks& tracks = tracker.track(noisy());
    std::vector<float> traces;
    for (std::size_t i = 0; i < tracks.found.size(); ++i) {
      const bool is_beyond = tracks.reference_px[i].x() > static_cast<float>(noisy_part.width + 9);
      if (tracks.found[i] != 0 && is_beyond) traces.push_back(tracks.covariance_px2[i].trace());
    }
    std::sort(traces.begin(), traces.end());
    return traces.at(traces.size() / 2);
  };
  EXPECT_GT(median_trace_beyond(6), 50 * median_trace_beyond(0));
}

// Ground and strips at another depth: patches on the occlusion boundaries contain both motions.
TEST(FeatureTracker, InflatesCovarianceOnOcclusionBoundaries) {
  constexpr int kStrip_px = 50;  // equal to the gap
  const Eigen::Vector2d ground_px(0.2, 0.1);
  const Eigen::Vector2d strips_px(0.7, -0.3);
  const auto from_left_edge = [](double x) {
    return x - 2 * kStrip_px * std::floor(x / (2 * kStrip_px));
  };
  cv::RNG random(13);
  const auto image = [&](const Eigen::Vector2d& ground_at, const Eigen::Vector2d& strips_at) {
    const auto grey_at = [](const Eigen::Vector2d& shift) {
      return analytic_frame(kImageSize, Eigen::Affine2d(Eigen::Translation2d(shift)));
    };
    const cv::Mat ground = grey_at(ground_at);
    const cv::Mat strips = grey_at(strips_at + Eigen::Vector2d(900, 700));
    cv::Mat out(kImageSize, CV_8UC1);
    for (int y = 0; y < kImageSize.height; ++y) {
      for (int x = 0; x < kImageSize.width; ++x) {
        const double to_left = from_left_edge(x - strips_at.x()) + 0.5;
        const double strip =
            std::clamp(to_left, 0.0, 1.0) - std::clamp(to_left - kStrip_px, 0.0, 1.0);
        out.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(
            strip * strips.at<unsigned char>(y, x) + (1 - strip) * ground.at<unsigned char>(y, x) +
            random.gaussian(1));
      }
    }
    return out;
  };
  const cv::Mat reference = image({0, 0}, {0, 0});
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const FeatureTracks& tracks = tracker.track(image(ground_px, strips_px));
  std::vector<double> at_edges;
  std::vector<double> elsewhere;
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    const Eigen::Vector2d moved = (tracks.current_px[i] - tracks.reference_px[i]).cast<double>();
    const auto nees = [&](const Eigen::Vector2d& truth) {
      const Eigen::Matrix2d covariance_px2 = tracks.covariance_px2[i].cast<double>();
      return 0.5 * (moved - truth).dot(covariance_px2.llt().solve(moved - truth));
    };
    const double to_left = from_left_edge(tracks.reference_px[i].x());
    const double to_edge =
        std::min({to_left, std::abs(to_left - kStrip_px), 2 * kStrip_px - to_left});
    const auto error = [&] { return std::min(nees(ground_px), nees(strips_px)); };
    if (to_edge < 8) at_edges.push_back(error());
    if (to_edge > 13) elsewhere.push_back(error());
  }
  ASSERT_GT(at_edges.size(), 50);
  ASSERT_GT(elsewhere.size(), 50);
  const auto mean = [](const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  EXPECT_LT(mean(at_edges), 15);  // 58 under white residual noise
  EXPECT_GT(mean(elsewhere), 0.8);
  EXPECT_LT(mean(elsewhere), 1.6);
}

// Multi-scale texture: unambiguous under large displacements.
cv::Mat scene() {
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(kImageSize, CV_32F);
  for (int cell = 4; cell <= 64; cell *= 2) {
    cv::Mat noise(kImageSize / cell, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 14);
    cv::resize(noise, noise, kImageSize, 0, 0, cv::INTER_CUBIC);
    sum += noise;
  }
  cv::Mat grey;
  sum.convertTo(grey, CV_8U, 1, 128);
  return grey;
}

TEST(FeatureTracker, TracksLargeMotion) {
  const cv::Mat reference = scene();
  FeatureTracker tracker({});
  for (const Eigen::Affine2d& motion :
       {motion_about_centre(0, 1, {-21, 17}), motion_about_centre(0.06, 1.05, {6, 3}),
        motion_about_centre(-0.12, 0.92, {-4, 2})}) {
    cv::Mat moved;
    const cv::Matx23d A(motion(0, 0), motion(0, 1), motion(0, 2), motion(1, 0), motion(1, 1),
                        motion(1, 2));
    cv::warpAffine(reference, moved, A, kImageSize, cv::INTER_CUBIC, cv::BORDER_REFLECT);
    tracker.set_reference(reference, corners(reference));
    const TrackError error = error_of(tracker.track(moved), motion);
    EXPECT_GT(error.found, 70);
    EXPECT_LT(error.max_px, 0.25);
  }
}

TEST(FeatureTracker, RegistersAtGivenRotationOnly) {
  const cv::Mat reference = scene();
  const double rotation_rad = 0.2;
  const Eigen::Affine2d motion = motion_about_centre(rotation_rad, 1, {25, -19});
  cv::Mat moved;
  const cv::Matx23d A(motion(0, 0), motion(0, 1), motion(0, 2), motion(1, 0), motion(1, 1),
                      motion(1, 2));
  cv::warpAffine(reference, moved, A, kImageSize, cv::INTER_CUBIC, cv::BORDER_REFLECT);
  const auto found_at = [&](double hypothesis_rad) {
    FeatureTracker tracker({});
    tracker.set_reference(reference, corners(reference));
    return error_of(tracker.track(moved, hypothesis_rad), motion);
  };
  EXPECT_GT(found_at(rotation_rad).found, 70);
  EXPECT_LT(found_at(rotation_rad).max_px, 0.3);
  EXPECT_LT(found_at(-rotation_rad).found, 20);
}

TEST(FeatureTracker, TracksLongDisplacementWithoutDrift) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  for (int i = 1; i <= 12; ++i) {
    const Eigen::Affine2d motion = motion_about_centre(0.01 * i, 1 + 0.01 * i, {5.0 * i, 2.0 * i});
    const TrackError error = error_of(tracker.track(analytic_frame(kImageSize, motion)), motion);
    EXPECT_GT(error.found, 40) << i;
    EXPECT_LT(error.max_px, 0.2) << i;
  }
}

// Left half static, right half approaching: no common deformation.
TEST(FeatureTracker, EstimatesLocalScaleChange) {
  constexpr int kSeam_px = 200;
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const Eigen::Vector2d origin(300, 150);
  for (int percent = 1; percent <= 10; ++percent) {
    const Eigen::Affine2d scaling = Eigen::Translation2d(origin) *
                                    Eigen::Scaling(1 + 0.01 * percent) *
                                    Eigen::Translation2d(-origin);
    cv::Mat current = reference.clone();
    const cv::Rect right(kSeam_px, 0, kImageSize.width - kSeam_px, kImageSize.height);
    analytic_frame(kImageSize, scaling)(right).copyTo(current(right));
    const FeatureTracks& tracks = tracker.track(current);
    double square = 0;
    int count = 0;
    for (std::size_t i = 0; i < tracks.found.size(); ++i) {
      const Eigen::Vector2d at = tracks.reference_px[i].cast<double>();
      if (tracks.found[i] == 0 || std::abs(at.x() - kSeam_px) < 30) continue;
      const Eigen::Vector2d truth = at.x() < kSeam_px ? at : scaling * at;
      square += (tracks.current_px[i].cast<double>() - truth).squaredNorm();
      ++count;
    }
    EXPECT_GT(count, 70) << percent;
    EXPECT_LT(std::sqrt(square / count), 0.05) << percent;
  }
}

TEST(FeatureTracker, IsInvariantToBrightnessOffset) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const Eigen::Affine2d motion = motion_about_centre(0, 1, {2.4, 1.1});
  const TrackError error = error_of(tracker.track(analytic_frame(kImageSize, motion, 12)), motion);
  EXPECT_GT(error.found, 100);
  EXPECT_LT(error.max_px, 0.06);
}

TEST(FeatureTracker, RejectsOccludedFeatures) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const Eigen::Affine2d motion = motion_about_centre(0, 1, {2, 1});
  cv::Mat covered = analytic_frame(kImageSize, motion);
  covered(cv::Rect(200, 0, 200, 300)).setTo(90);
  const FeatureTracks& tracks = tracker.track(covered);
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    const bool is_covered = tracks.reference_px[i].x() > 210;
    EXPECT_FALSE(is_covered && tracks.found[i] != 0) << i;
  }
  EXPECT_LT(error_of(tracks, motion).max_px, 0.5);  // patches that are half covered
  EXPECT_GT(tracks.found_count, 40);
}

TEST(FeatureTracker, RecoversAfterBlackFrame) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  FeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  EXPECT_EQ(tracker.track(cv::Mat::zeros(kImageSize, CV_8UC1)).found_count, 0);
  const Eigen::Affine2d motion = motion_about_centre(0, 1, {5, -3});
  const TrackError error = error_of(tracker.track(analytic_frame(kImageSize, motion)), motion);
  EXPECT_GT(error.found, 100);
  EXPECT_LT(error.max_px, 0.05);
}

TEST(OpenCvFeatureTracker, TracksSmallMotion) {
  const cv::Mat reference = analytic_frame(kImageSize, Eigen::Affine2d::Identity());
  OpenCvFeatureTracker tracker({});
  tracker.set_reference(reference, corners(reference));
  const Eigen::Affine2d motion = motion_about_centre(0, 1, {-14.6, 9.2});
  const TrackError error = error_of(tracker.track(analytic_frame(kImageSize, motion)), motion);
  EXPECT_GT(error.found, 100);
}

TEST(FeatureDetection, DescriptorsMatchIdenticalImage) {
  const cv::Mat grey = analytic_frame({400, 300}, Eigen::Affine2d::Identity());
  for (const auto& [kind, name] : EnumNames<Detector>::value) {
    FeatureMatcher matcher({.kind = kind, .max_features = 300, .fast_threshold = 5});
    matcher.set_reference(grey);
    EXPECT_GT(matcher.reference_count(), 20) << name;
    const FeatureMatches matches = matcher.match(grey);
    EXPECT_GT(matches.reference_px.size(), 10U) << name;
    for (std::size_t i = 0; i < matches.reference_px.size(); ++i) {
      EXPECT_EQ(matches.reference_px[i], matches.current_px[i]) << name;
    }
  }
}

TEST(FeatureDetection, KeepsMinimumDistanceToTrackedFeatures) {
  const cv::Mat grey = analytic_frame({400, 300}, Eigen::Affine2d::Identity());
  for (const Detector kind : {Detector::shi_tomasi, Detector::fast}) {
    const DetectorConfig config{.kind = kind, .min_distance_px = 10, .fast_threshold = 5};
    std::vector<cv::Point2f> tracked = detect_features(grey, config);
    ASSERT_GT(tracked.size(), 20U);
    tracked.resize(tracked.size() / 2);
    const std::vector<cv::Point2f> added = detect_features(grey, config, tracked);
    EXPECT_GT(added.size(), 5U);
    for (const cv::Point2f& new_feature : added) {
      for (const cv::Point2f& at : tracked) EXPECT_GT(cv::norm(new_feature - at), 9);
    }
  }
}

TEST(FeatureDetection, ReturnsNothingWithoutTexture) {
  const cv::Mat grey(200, 200, CV_8UC1, cv::Scalar(80));
  for (const auto& [kind, name] : EnumNames<Detector>::value) {
    EXPECT_TRUE(detect_features(grey, {.kind = kind}).empty()) << name;
    FeatureMatcher matcher({.kind = kind});
    matcher.set_reference(grey);
    EXPECT_TRUE(matcher.match(grey).reference_px.empty()) << name;
  }
}

}  // namespace
}  // namespace stillkite
