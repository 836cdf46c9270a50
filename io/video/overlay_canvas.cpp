#include "io/video/overlay_canvas.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kCapitalAtScaleOne = 22;  // px, cap height of kFont
constexpr int kShift = 4;                  // sub-pixel bits of OpenCV's drawing

cv::Point fixed(const cv::Point2d& p) {
  return {cvRound(p.x * (1 << kShift)), cvRound(p.y * (1 << kShift))};
}

const cv::Scalar kRim(20, 20, 20);

}  // namespace

OverlayCanvas::OverlayCanvas(cv::Mat image)
    : image_(std::move(image)), unit_(std::max(image_.rows / 720.0, image_.cols / 1800.0)) {
  CV_Assert(image_.type() == CV_8UC3);
}

int OverlayCanvas::pixels(double units) const {
  return std::max(1, cvRound(units * unit_));
}

void OverlayCanvas::panel(const cv::Rect2d& area) {
  const cv::Rect whole(0, 0, image_.cols, image_.rows);
  cv::Mat part = image_(cv::Rect(area) & whole);
  part.convertTo(part, -1, 0.35);
}

void OverlayCanvas::text(const std::string& words, const cv::Point2d& at, double height,
                         const cv::Scalar& colour, bool bold) {
  const double scale = height * unit_ / kCapitalAtScaleOne;
  const int thickness = std::max(1, cvRound(scale * (bold ? 2.0 : 1.2)));
  cv::putText(image_, words, cv::Point(at), kFont, scale, colour, thickness, cv::LINE_AA);
}

void OverlayCanvas::pill(const std::string& words, const cv::Point2d& top_left, double height,
                         const cv::Scalar& colour) {
  const double capital = 0.46 * height;
  const double scale = capital * unit_ / kCapitalAtScaleOne;
  const int thickness = std::max(1, cvRound(scale * 1.4));
  const double words_px = cv::getTextSize(words, kFont, scale, thickness, nullptr).width;
  const double radius = 0.5 * height * unit_;
  const cv::Point2d left = top_left + cv::Point2d(radius, radius);
  const cv::Point2d right = left + cv::Point2d(words_px, 0);
  for (const cv::Point2d& end : {left, right}) {
    cv::circle(image_, fixed(end), cvRound(radius * (1 << kShift)), colour, cv::FILLED, cv::LINE_AA,
               kShift);
  }
  cv::rectangle(image_,
                cv::Rect(cv::Point(left - cv::Point2d(0, radius)),
                         cv::Point(right + cv::Point2d(0, radius + 1))),
                colour, cv::FILLED);
  cv::putText(image_, words, cv::Point(left + cv::Point2d(0, 0.5 * capital * unit_)), kFont, scale,
              {255, 255, 255}, thickness, cv::LINE_AA);
}

void OverlayCanvas::arrow(const cv::Point2d& from, const cv::Point2d& to, double width,
                          const cv::Scalar& colour) {
  const cv::Point2d shaft = to - from;
  const double length = std::hypot(shaft.x, shaft.y);
  if (!(length >= 0.5)) return;
  const cv::Point2d along = shaft / length;
  const cv::Point2d across(-along.y, along.x);
  const double head = std::min(4.5 * width * unit_, 0.6 * length);
  const cv::Point2d neck = to - head * along;
  for (const auto& [extra, paint] : {std::pair{1.6, kRim}, std::pair{0.0, colour}}) {
    const double rim = extra * unit_;
    cv::line(image_, fixed(from), fixed(neck), paint, pixels(width + 2 * extra), cv::LINE_AA,
             kShift);
    const std::array<cv::Point, 3> tip{fixed(to + rim * 1.6 * along),
                                       fixed(neck + (0.55 * head + rim) * across - rim * along),
                                       fixed(neck - (0.55 * head + rim) * across - rim * along)};
    cv::fillConvexPoly(image_, tip.data(), 3, paint, cv::LINE_AA, kShift);
  }
}

void OverlayCanvas::dot(const cv::Point2d& centre, double radius, const cv::Scalar& colour) {
  cv::circle(image_, fixed(centre), cvRound(radius * unit_ * (1 << kShift)), colour, cv::FILLED,
             cv::LINE_AA, kShift);
}

void OverlayCanvas::ring(const cv::Point2d& centre, double radius, double width,
                         const cv::Scalar& colour) {
  cv::circle(image_, fixed(centre), cvRound(radius * unit_ * (1 << kShift)), colour, pixels(width),
             cv::LINE_AA, kShift);
}

void OverlayCanvas::line(const cv::Point2d& from, const cv::Point2d& to, double width,
                         const cv::Scalar& colour) {
  cv::line(image_, fixed(from), fixed(to), colour, pixels(width), cv::LINE_AA, kShift);
}

}  // namespace stillkite
