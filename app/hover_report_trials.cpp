#include "app/hover_report_trials.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

HoverReportSample report_sample(const TrialSample& sample, bool stabilized) {
  const auto along = [&](PaperAxis axis) {
    return paper_axis_in_world(axis).dot(sample.displacement_in_world_m);
  };
  return {.t_s = sample.t_s,
          .displacement_m = {along(PaperAxis::x), along(PaperAxis::y), along(PaperAxis::z)},
          .station_in_world_m = sample.station_in_world_m,
          .drone_in_world_m = sample.drone_in_world_m,
          .yaw_deg = sample.yaw_rad / kDegree,
          .action = stabilized ? name_of(sample.action) : std::string_view(),
          .reason = stabilized ? name_of(sample.reason) : std::string_view()};
}

}  // namespace

HoverImage hover_image(const Frame& frame) {
  constexpr int kWidth_px = 240;
  constexpr int kQuality = 60;
  const cv::Size size(kWidth_px, kWidth_px * frame.grey.rows / frame.grey.cols);
  cv::Mat small;
  cv::resize(frame.grey, small, size, 0, 0, cv::INTER_AREA);
  HoverImage image{.t_s = to_seconds(frame.stamp), .jpeg = {}};
  cv::imencode(".jpg", small, image.jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return image;
}

std::vector<HoverReportTrial> hover_report_trials(const std::vector<TrialRecord>& records,
                                                  std::vector<std::vector<HoverImage>> images,
                                                  const std::string& policy) {
  std::vector<HoverReportTrial> trials;
  trials.reserve(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Trial& flown = records[i].trial;
    HoverReportTrial trial{.moved_axis = static_cast<int>(flown.axis),
                           .stabilized = flown.stabilized,
                           .policy = flown.stabilized ? policy : "none",
                           .seed = flown.seed,
                           .samples = {},
                           .images = std::move(images[i])};
    for (const TrialSample& sample : records[i].samples) {
      trial.samples.push_back(report_sample(sample, flown.stabilized));
    }
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace stillkite
