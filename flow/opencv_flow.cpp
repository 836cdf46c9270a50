#include "flow/opencv_flow.hpp"

#include "flow/flow_checks.hpp"

namespace stillkite {
namespace {

cv::Ptr<cv::DenseOpticalFlow> make_dense(const OpenCvFlowConfig& config) {
  using DIS = cv::DISOpticalFlow;
  switch (config.method) {
    case OpenCvFlowMethod::farneback:

      return cv::FarnebackOpticalFlow::create(config.levels, 0.5, false, config.window_px, 3, 5,
                                              1.2);
    case OpenCvFlowMethod::dis_ultrafast:
      return DIS::create(DIS::PRESET_ULTRAFAST);
    case OpenCvFlowMethod::dis_fast:
      return DIS::create(DIS::PRESET_FAST);
    case OpenCvFlowMethod::dis_medium:
      return DIS::create(DIS::PRESET_MEDIUM);
    case OpenCvFlowMethod::pyramidal_lucas_kanade:
      break;
  }
  return nullptr;
}

// calcOpticalFlowPyrLK: eigenvalues of gradients in units of 1/32, times 2^-20.
constexpr float kEigenvalueScale = 1024.0F;

}  // namespace

OpenCvFlow::OpenCvFlow(const OpenCvFlowConfig& config)
    : config_(in_range(config)), dense_(make_dense(config)) {}

const FlowField& OpenCvFlow::operator()(const cv::Mat& previous, const cv::Mat& current) {
  check_frames(previous, current);
  if (!dense_) {
    track_grid(previous, current);
    return field_;
  }
  // DIS uses a non-empty output as initial flow
  field_.flow_px.release();
  dense_->calc(previous, current, field_.flow_px);
  return field_;
}

void OpenCvFlow::track_grid(const cv::Mat& previous, const cv::Mat& current) {
  const int stride = config_.stride_px;
  const int half = stride / 2;
  const cv::Size grid((previous.cols - half + stride - 1) / stride,
                      (previous.rows - half + stride - 1) / stride);
  from_px_.clear();
  for (int i = 0; i < grid.height; ++i) {
    for (int j = 0; j < grid.width; ++j) {
      from_px_.emplace_back(cv::Point(stride * j + half, stride * i + half));
    }
  }
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01);
  cv::calcOpticalFlowPyrLK(previous, current, from_px_, to_px_, found_, eigenvalues_,
                           {config_.window_px, config_.window_px}, config_.levels - 1, until,
                           cv::OPTFLOW_LK_GET_MIN_EIGENVALS);
  field_.stride_px = stride;
  field_.flow_px.create(grid, CV_32FC2);
  field_.information.create(grid, CV_32FC1);
  for (std::size_t k = 0; k < from_px_.size(); ++k) {
    const int at = static_cast<int>(k);
    const bool found = found_[k] != 0;
    const cv::Point2f flow = found ? to_px_[k] - from_px_[k] : cv::Point2f(0, 0);
    field_.flow_px.at<cv::Point2f>(at / grid.width, at % grid.width) = flow;
    field_.information.at<float>(at / grid.width, at % grid.width) =
        found ? kEigenvalueScale * eigenvalues_[k] : 0.0F;
  }
}

}  // namespace stillkite
