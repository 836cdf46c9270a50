#include "flow/dense_lucas_kanade.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "flow/dense_lucas_kanade_rows.hpp"
#include "flow/flow_checks.hpp"

namespace stillkite {
namespace {

constexpr int kStripRows = 128;  // column sums restart here, which bounds the rounding error

DenseLucasKanadeConfig checked(const DenseLucasKanadeConfig& config) {
  if (config.window_px % 2 == 0) {
    throw InputError(
        fmt::format("flow: window_px = {} is even; give an odd number", config.window_px));
  }
  return in_range(config);
}

cv::Mat part(const cv::Mat& matrix, cv::Size size) {
  return matrix(cv::Rect({0, 0}, size));
}

template <typename T>
Rows<T> rows_of(const cv::Mat& matrix) {
  using Value = std::remove_const_t<T>;
  return {reinterpret_cast<T*>(matrix.data),
          static_cast<std::ptrdiff_t>(matrix.step / sizeof(Value))};
}

cv::Vec2f finite_or_zero(cv::Vec2f vector) {
  return std::isfinite(vector[0]) && std::isfinite(vector[1]) ? vector : cv::Vec2f(0, 0);
}

}  // namespace

DenseLucasKanade::DenseLucasKanade(const DenseLucasKanadeConfig& config)
    : config_(checked(config)) {}

const FlowField& DenseLucasKanade::operator()(const cv::Mat& previous, const cv::Mat& current) {
  build_pyramids(previous, current);
  levels_.back().warp.setTo(0);
  return descend();
}

const FlowField& DenseLucasKanade::operator()(const cv::Mat& previous, const cv::Mat& current,
                                              const Eigen::Matrix3d& current_from_previous_px) {
  build_pyramids(previous, current);
  Level& coarsest = levels_.back();
  const double scale = std::ldexp(1.0, static_cast<int>(levels_.size()) - 1);
  for (int y = 0; y < coarsest.size.height; ++y) {
    auto* const row = coarsest.warp.ptr<cv::Vec2f>(y);
    for (int x = 0; x < coarsest.size.width; ++x) {
      const Eigen::Vector2d from(x * scale, y * scale);
      const Eigen::Vector3d to = current_from_previous_px * from.homogeneous();
      const Eigen::Vector2d flow = (to.hnormalized() - from) / scale;
      row[x] = finite_or_zero({static_cast<float>(flow.x()), static_cast<float>(flow.y())});
    }
  }
  return descend();
}

const FlowField& DenseLucasKanade::operator()(const cv::Mat& previous, const cv::Mat& current,
                                              const cv::Mat& predicted_flow_px) {
  if (predicted_flow_px.type() != CV_32FC2 || predicted_flow_px.size() != previous.size()) {
    throw InputError(
        "dense flow: the predicted flow must be CV_32FC2 and of the size of the frames");
  }
  build_pyramids(previous, current);
  Level& coarsest = levels_.back();
  const int scale = 1 << (levels_.size() - 1);
  for (int y = 0; y < coarsest.size.height; ++y) {
    const auto* const from = predicted_flow_px.ptr<cv::Vec2f>(y * scale);
    auto* const row = coarsest.warp.ptr<cv::Vec2f>(y);
    for (int x = 0; x < coarsest.size.width; ++x) {
      row[x] = finite_or_zero(from[x * scale] / static_cast<float>(scale));
    }
  }
  return descend();
}

void DenseLucasKanade::allocate(cv::Size size) {
  levels_.clear();
  for (int level = 0; level < config_.levels; ++level) {
    const cv::Size wide(size.width + kRowMargin, size.height);
    const cv::Mat image = cv::Mat::zeros(wide + cv::Size(0, 1), CV_8UC1);
    const cv::Mat flow = cv::Mat::zeros(wide, CV_32FC2);
    levels_.push_back({size, image, image.clone(), flow, flow.clone()});
    size = {(size.width + 1) / 2, (size.height + 1) / 2};
    if (std::min(size.width, size.height) < config_.window_px) break;
  }
  const Level& finest = levels_.front();
  information_ = cv::Mat::zeros(finest.flow.size(), CV_32FC1);
  field_.flow_px = part(finest.flow, finest.size);
  field_.information = part(information_, finest.size);
  scratch_.clear();
}

void DenseLucasKanade::build_pyramids(const cv::Mat& previous, const cv::Mat& current) {
  check_frames(previous, current);
  if (levels_.empty() || levels_.front().size != previous.size()) allocate(previous.size());
  for (const auto& [image, source] :
       {std::pair{&Level::previous, &previous}, {&Level::current, &current}}) {
    cv::Mat finer;
    for (Level& level : levels_) {
      cv::Mat target = part(level.*image, level.size);
      if (finer.empty()) {
        source->copyTo(target);
      } else {
        cv::pyrDown(finer, target, level.size);
      }
      finer = target;
    }
  }
}

const FlowField& DenseLucasKanade::descend() {
  for (std::size_t i = levels_.size(); i-- > 0;) {
    Level& level = levels_[i];
    const int steps = i == 0 ? config_.finest_steps : config_.steps;
    for (int iteration = 0; iteration < steps; ++iteration) {
      const bool final_step = i == 0 && iteration == steps - 1;
      step(i, final_step);
      if (final_step) break;
      cv::Mat smooth = part(level.warp, level.size);
      cv::blur(part(level.flow, level.size), smooth, {config_.window_px, config_.window_px},
               {-1, -1}, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
    }
    if (i == 0) break;
    const Level& finer = levels_[i - 1];
    upsample_flow(rows_of<const float>(level.warp), level.size.width, level.size.height,
                  rows_of<float>(finer.warp), finer.size.width, finer.size.height,
                  level.flow.ptr<float>());
  }
  return field_;
}

void DenseLucasKanade::step(std::size_t level, bool with_information) {
  const Level& at = levels_[level];
  const DenseStep step{
      .width = at.size.width,
      .height = at.size.height,
      .previous = rows_of<const std::uint8_t>(at.previous),
      .current = rows_of<const std::uint8_t>(at.current),
      .warp = rows_of<const float>(at.warp),
      .flow = rows_of<float>(at.flow),
      .information = with_information ? rows_of<float>(information_) : Rows<float>{},
      .radius = config_.window_px / 2,
      .regularisation =
          static_cast<float>(std::ldexp(config_.regularisation, -2 * static_cast<int>(level)))};
  const int workers = std::max(1, cv::getNumThreads());
  const int finest_width = levels_.front().size.width;
  while (static_cast<int>(scratch_.size()) < workers) {
    scratch_.emplace_back(1, static_cast<int>(scratch_size(finest_width, step.radius)), CV_32FC1);
  }
  // strips are independent of the number of workers, hence so is the flow
  const int strips = (step.height + kStripRows - 1) / kStripRows;
  cv::parallel_for_({0, workers}, [&](const cv::Range& range) {
    for (int worker = range.start; worker < range.end; ++worker) {
      auto* const scratch = scratch_[static_cast<std::size_t>(worker)].ptr<float>();
      for (int strip = worker; strip < strips; strip += workers) {
        const int first = strip * kStripRows;
        step_rows(step, first, std::min(first + kStripRows, step.height), scratch);
      }
    }
  });
}

}  // namespace stillkite
