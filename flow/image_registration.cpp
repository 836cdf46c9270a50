#include "flow/image_registration.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

constexpr double kMaxSide_px = 160;
constexpr double kMinOverlapRatio = 0.25;
constexpr double kMinVariance_grey2 = 0.5;  // below: image without texture
constexpr int kPeaksPerRotation = 2;
constexpr int kPeakRadius_px = 4;
constexpr std::size_t kMaxResults = 3;

// Downsampled difference of Gaussians: removes noise and slow brightness variation.
cv::Mat band_passed_copy(const cv::Mat& grey, cv::Size size) {
  cv::Mat small;
  cv::resize(grey, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::Mat denoised, background;
  cv::GaussianBlur(small, denoised, {}, 0.8);
  cv::GaussianBlur(small, background, {}, 6);
  return denoised - background;
}

cv::Mat spectrum(const cv::Mat& image, cv::Size padded) {
  cv::Mat field = cv::Mat::zeros(padded, CV_32F);
  image.copyTo(field(cv::Rect({}, image.size())));
  cv::dft(field, field);
  return field;
}

// Fourier transforms of the mask, the masked image and its square.
struct Spectra {
  cv::Mat mask, values, squares;

  Spectra(const cv::Mat& image, const cv::Mat& valid, cv::Size padded)
      : mask(spectrum(valid, padded)),
        values(spectrum(image.mul(valid), padded)),
        squares(spectrum(image.mul(image).mul(valid), padded)) {}
};

// sum_x a(x) b(x + shift) at every shift, cyclic.
cv::Mat cross_correlation(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat product;
  cv::mulSpectrums(b, a, product, 0, true);
  cv::idft(product, product, cv::DFT_SCALE);
  return product;
}

// Normalized cross-correlation over the overlap; score = correlation * sqrt(overlap ratio).
struct CorrelationMap {
  cv::Mat correlation, score;
};

CorrelationMap correlate(const Spectra& a, const Spectra& b, double pixels) {
  const cv::Mat n = cv::max(cross_correlation(a.mask, b.mask), 1.0);
  const cv::Mat sum_a = cross_correlation(a.values, b.mask);
  const cv::Mat sum_b = cross_correlation(a.mask, b.values);
  const cv::Mat variance_a = cross_correlation(a.squares, b.mask) - sum_a.mul(sum_a) / n;
  const cv::Mat variance_b = cross_correlation(a.mask, b.squares) - sum_b.mul(sum_b) / n;
  const cv::Mat covariance = cross_correlation(a.values, b.values) - sum_a.mul(sum_b) / n;
  const cv::Mat min_variance = kMinVariance_grey2 * n;
  const cv::Mat is_valid =
      (n > kMinOverlapRatio * pixels) & (variance_a > min_variance) & (variance_b > min_variance);
  cv::Mat denominator, overlap_root, validity;
  cv::sqrt(cv::max(variance_a, min_variance).mul(cv::max(variance_b, min_variance)), denominator);
  cv::sqrt(n / pixels, overlap_root);
  is_valid.convertTo(validity, CV_32F, 1.0 / 255);
  CorrelationMap out;
  out.correlation = (covariance / denominator).mul(validity);
  out.score = out.correlation.mul(overlap_root);
  return out;
}

int wrapped(int at, int size) {
  return at > size / 2 ? at - size : at;
}

// Sub-pixel offset of the maximum of a parabola through three values 1 px apart.
double parabola_peak(float before, float at, float after) {
  const double curvature = 2.0 * at - before - after;
  return curvature > 0 ? std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5) : 0.0;
}

struct ScoredRegistration {
  ImageRegistration registration;  // in pixels of the downsampled images
  double score = 0;
};

// Returns the highest peak and suppresses its neighbourhood.
ScoredRegistration extract_peak(CorrelationMap& map) {
  const auto at = [&](int row, int column) {
    return map.score.at<float>((row + map.score.rows) % map.score.rows,
                               (column + map.score.cols) % map.score.cols);
  };
  double score = 0;
  cv::Point top;
  cv::minMaxLoc(map.score, nullptr, &score, nullptr, &top);
  const int x = wrapped(top.x, map.score.cols);
  const int y = wrapped(top.y, map.score.rows);
  ScoredRegistration out{.score = score};
  out.registration.shift_px = {
      x + parabola_peak(at(top.y, top.x - 1), at(top.y, top.x), at(top.y, top.x + 1)),
      y + parabola_peak(at(top.y - 1, top.x), at(top.y, top.x), at(top.y + 1, top.x))};
  out.registration.correlation = map.correlation.at<float>(top);
  for (int row = y - kPeakRadius_px; row <= y + kPeakRadius_px; ++row) {
    for (int column = x - kPeakRadius_px; column <= x + kPeakRadius_px; ++column) {
      map.score.at<float>((row + map.score.rows) % map.score.rows,
                          (column + map.score.cols) % map.score.cols) = 0;
    }
  }
  return out;
}

// Rotation about the image centre, x axis towards y axis.
Eigen::Matrix3d rotation_about_centre(cv::Size size, double rotation_rad) {
  const Eigen::Vector2d centre(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(rotation_rad).toRotationMatrix();
  rotation.topRightCorner<2, 1>() = centre - rotation.topLeftCorner<2, 2>() * centre;
  return rotation;
}

Spectra warped_spectra(const Eigen::Matrix3d& homography, const cv::Mat& image, cv::Size padded) {
  cv::Mat matrix, warped, valid;
  cv::eigen2cv(homography, matrix);
  const cv::Mat all = cv::Mat::ones(image.size(), CV_32F);
  cv::warpPerspective(image, warped, matrix, image.size());
  cv::warpPerspective(all, valid, matrix, image.size(), cv::INTER_NEAREST);
  return {warped, valid, padded};
}

std::vector<ScoredRegistration> correlation_peaks(const cv::Mat& a, const cv::Mat& b,
                                                  const Eigen::Matrix3d& homography,
                                                  std::span<const double> rotations_rad) {
  const cv::Size padded(cv::getOptimalDFTSize(2 * a.cols), cv::getOptimalDFTSize(2 * a.rows));
  const Spectra current = warped_spectra(homography, b, padded);
  std::vector<ScoredRegistration> candidates;
  for (const double rotation_rad : rotations_rad) {
    const Spectra rotated =
        warped_spectra(rotation_about_centre(a.size(), rotation_rad) * homography, a, padded);
    CorrelationMap map = correlate(rotated, current, a.size().area());
    for (int k = 0; k < kPeaksPerRotation; ++k) {
      candidates.push_back(extract_peak(map));
      candidates.back().registration.rotation_rad = rotation_rad;
    }
  }
  return candidates;
}

// Homography between downsampled images; pixel centres at integer coordinates.
Eigen::Matrix3d scaled_homography(const Eigen::Matrix3d& homography, double factor_x,
                                  double factor_y) {
  Eigen::Matrix3d full_from_small;
  full_from_small << factor_x, 0, 0.5 * (factor_x - 1), 0, factor_y, 0.5 * (factor_y - 1), 0, 0, 1;
  return full_from_small.inverse() * homography * full_from_small;
}

}  // namespace

std::vector<ImageRegistration> register_images(const cv::Mat& reference, const cv::Mat& current,
                                               const Eigen::Matrix3d& homography,
                                               std::span<const double> rotations_rad) {
  const double downsampling = std::min(1.0, kMaxSide_px / std::max(reference.cols, reference.rows));
  const cv::Size size(std::max(1, static_cast<int>(std::lround(downsampling * reference.cols))),
                      std::max(1, static_cast<int>(std::lround(downsampling * reference.rows))));
  const double factor_x = static_cast<double>(reference.cols) / size.width;
  const double factor_y = static_cast<double>(reference.rows) / size.height;
  std::vector<ScoredRegistration> candidates =
      correlation_peaks(band_passed_copy(reference, size), band_passed_copy(current, size),
                        scaled_homography(homography, factor_x, factor_y), rotations_rad);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<ImageRegistration> out;
  for (const ScoredRegistration& candidate : candidates) {
    ImageRegistration registration = candidate.registration;
    registration.shift_px = registration.shift_px.cwiseProduct(Eigen::Vector2d(factor_x, factor_y));
    const bool is_new = std::none_of(out.begin(), out.end(), [&](const ImageRegistration& other) {
      return (other.shift_px - registration.shift_px).norm() <= kPeakRadius_px * factor_x;
    });
    if (candidate.score > 0 && is_new && out.size() < kMaxResults) out.push_back(registration);
  }
  return out;
}

}  // namespace stillkite
