#include "flow/image_search.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

constexpr double kLongestSide_px = 160;
constexpr double kLeastOverlap = 0.25;
constexpr double kLeastVariance = 0.5;  // grey^2 a pixel; less is a bare image
constexpr int kPeaksPerTurn = 2;
constexpr int kPeakRadius_px = 4;
constexpr std::size_t kMostAnswers = 3;

// Small, without noise and without slow changes of brightness.
cv::Mat small_copy(const cv::Mat& grey, cv::Size size) {
  cv::Mat small;
  cv::resize(grey, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::Mat fine, slow;
  cv::GaussianBlur(small, fine, {}, 0.8);
  cv::GaussianBlur(small, slow, {}, 6);
  return fine - slow;
}

cv::Mat spectrum(const cv::Mat& image, cv::Size padded) {
  cv::Mat field = cv::Mat::zeros(padded, CV_32F);
  image.copyTo(field(cv::Rect({}, image.size())));
  cv::dft(field, field);
  return field;
}

// Of an image and where it has pixels: mask, values and squares.
struct Spectra {
  cv::Mat mask, values, squares;

  Spectra(const cv::Mat& image, const cv::Mat& seen, cv::Size padded)
      : mask(spectrum(seen, padded)),
        values(spectrum(image.mul(seen), padded)),
        squares(spectrum(image.mul(image).mul(seen), padded)) {}
};

// Sum over x of a(x) b(x + shift), at every shift; the negative ones wrap round.
cv::Mat sums(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat product;
  cv::mulSpectrums(b, a, product, 0, true);
  cv::idft(product, product, cv::DFT_SCALE);
  return product;
}

// The correlation of what overlaps, and it again, times the root of the overlap's share: how
// certain it is.
struct CorrelationMap {
  cv::Mat correlation, score;
};

CorrelationMap correlate(const Spectra& a, const Spectra& b, double pixels) {
  const cv::Mat n = cv::max(sums(a.mask, b.mask), 1.0);
  const cv::Mat sum_a = sums(a.values, b.mask);
  const cv::Mat sum_b = sums(a.mask, b.values);
  const cv::Mat variance_a = sums(a.squares, b.mask) - sum_a.mul(sum_a) / n;
  const cv::Mat variance_b = sums(a.mask, b.squares) - sum_b.mul(sum_b) / n;
  const cv::Mat covariance = sums(a.values, b.values) - sum_a.mul(sum_b) / n;
  const cv::Mat least = kLeastVariance * n;
  const cv::Mat known = (n > kLeastOverlap * pixels) & (variance_a > least) & (variance_b > least);
  cv::Mat scale, root, trusted;
  cv::sqrt(cv::max(variance_a, least).mul(cv::max(variance_b, least)), scale);
  cv::sqrt(n / pixels, root);
  known.convertTo(trusted, CV_32F, 1.0 / 255);
  CorrelationMap out;
  out.correlation = (covariance / scale).mul(trusted);
  out.score = out.correlation.mul(root);
  return out;
}

int wrapped(int at, int size) {
  return at > size / 2 ? at - size : at;
}

// Top of the parabola through three values a pixel apart.
double peak_between(float before, float at, float after) {
  const double bend = 2.0 * at - before - after;
  return bend > 0 ? std::clamp(0.5 * (after - before) / bend, -0.5, 0.5) : 0.0;
}

struct ScoredShift {
  ImageShift shift;  // in pixels of the small copies
  double score = 0;
};

// The highest peak; its surroundings are taken away for the next one.
ScoredShift take_peak(CorrelationMap& map) {
  const auto at = [&](int row, int column) {
    return map.score.at<float>((row + map.score.rows) % map.score.rows,
                               (column + map.score.cols) % map.score.cols);
  };
  double score = 0;
  cv::Point top;
  cv::minMaxLoc(map.score, nullptr, &score, nullptr, &top);
  const int x = wrapped(top.x, map.score.cols);
  const int y = wrapped(top.y, map.score.rows);
  ScoredShift out{.score = score};
  out.shift.shift_px = {
      x + peak_between(at(top.y, top.x - 1), at(top.y, top.x), at(top.y, top.x + 1)),
      y + peak_between(at(top.y - 1, top.x), at(top.y, top.x), at(top.y + 1, top.x))};
  out.shift.correlation = map.correlation.at<float>(top);
  for (int row = y - kPeakRadius_px; row <= y + kPeakRadius_px; ++row) {
    for (int column = x - kPeakRadius_px; column <= x + kPeakRadius_px; ++column) {
      map.score.at<float>((row + map.score.rows) % map.score.rows,
                          (column + map.score.cols) % map.score.cols) = 0;
    }
  }
  return out;
}

// A turn about the image's middle, x axis to y axis.
Eigen::Matrix3d turn_about_middle(cv::Size size, double turn_rad) {
  const Eigen::Vector2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
  turn.topRightCorner<2, 1>() = middle - turn.topLeftCorner<2, 2>() * middle;
  return turn;
}

Spectra seen_through(const Eigen::Matrix3d& view, const cv::Mat& image, cv::Size padded) {
  cv::Mat homography, warped, seen;
  cv::eigen2cv(view, homography);
  const cv::Mat all = cv::Mat::ones(image.size(), CV_32F);
  cv::warpPerspective(image, warped, homography, image.size());
  cv::warpPerspective(all, seen, homography, image.size(), cv::INTER_NEAREST);
  return {warped, seen, padded};
}

std::vector<ScoredShift> peaks_of_turns(const cv::Mat& a, const cv::Mat& b,
                                        const Eigen::Matrix3d& view,
                                        std::span<const double> turns_rad) {
  const cv::Size padded(cv::getOptimalDFTSize(2 * a.cols), cv::getOptimalDFTSize(2 * a.rows));
  const Spectra current = seen_through(view, b, padded);
  std::vector<ScoredShift> found;
  for (const double turn_rad : turns_rad) {
    const Spectra turned = seen_through(turn_about_middle(a.size(), turn_rad) * view, a, padded);
    CorrelationMap map = correlate(turned, current, a.size().area());
    for (int k = 0; k < kPeaksPerTurn; ++k) {
      found.push_back(take_peak(map));
      found.back().shift.turn_rad = turn_rad;
    }
  }
  return found;
}

// The same view of copies that are smaller by these factors: pixel centres at whole numbers.
Eigen::Matrix3d shrunk(const Eigen::Matrix3d& view, double across, double down) {
  Eigen::Matrix3d full_from_small;
  full_from_small << across, 0, 0.5 * (across - 1), 0, down, 0.5 * (down - 1), 0, 0, 1;
  return full_from_small.inverse() * view * full_from_small;
}

}  // namespace

std::vector<ImageShift> find_shifts(const cv::Mat& reference, const cv::Mat& current,
                                    const Eigen::Matrix3d& view,
                                    std::span<const double> turns_rad) {
  const double shrink = std::min(1.0, kLongestSide_px / std::max(reference.cols, reference.rows));
  const cv::Size size(std::max(1, static_cast<int>(std::lround(shrink * reference.cols))),
                      std::max(1, static_cast<int>(std::lround(shrink * reference.rows))));
  const double across = static_cast<double>(reference.cols) / size.width;
  const double down = static_cast<double>(reference.rows) / size.height;
  std::vector<ScoredShift> found =
      peaks_of_turns(small_copy(reference, size), small_copy(current, size),
                     shrunk(view, across, down), turns_rad);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<ImageShift> out;
  for (const ScoredShift& next : found) {
    ImageShift shift = next.shift;
    shift.shift_px = shift.shift_px.cwiseProduct(Eigen::Vector2d(across, down));
    const bool is_new = std::none_of(out.begin(), out.end(), [&](const ImageShift& known) {
      return (known.shift_px - shift.shift_px).norm() <= kPeakRadius_px * across;
    });
    if (next.score > 0 && is_new && out.size() < kMostAnswers) out.push_back(shift);
  }
  return out;
}

}  // namespace stillkite
