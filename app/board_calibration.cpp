#include "app/board_calibration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "calibration/board_detector.hpp"
#include "calibration/image_coverage.hpp"
#include "calibration/lens_calibration.hpp"
#include "calibration/view_collector.hpp"
#include "geometry/angle.hpp"
#include "io/config/config_printing.hpp"
#include "io/dataset/calibration_file.hpp"
#include "io/dataset/camera_check.hpp"
#include "io/dataset/euroc_dataset.hpp"
#include "io/dataset/lens_check.hpp"
#include "io/report/calibration_report.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/video/frame_source.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Views of the board in the source.
struct BoardRecording {
  int width_px = 0;
  int height_px = 0;
  std::int64_t frames = 0;
  std::int64_t found = 0;
  std::vector<BoardView> views;  // without nearly equal ones
};

// Images without stamps have no time; the calibration needs none.
SourceConfig untimed(SourceConfig source) {
  std::error_code ignored;
  if (!source.rate_hz && fs::is_directory(source.path, ignored) &&
      !find_euroc_dataset(source.path)) {
    source.rate_hz = 1;
  }
  return source;
}

BoardRecording read_views(const SourceConfig& config, const BoardConfig& board) {
  constexpr double kMinInterval_s = 0.09;  // ten views per second show what a board can
  const BoardDetector detector(board);
  FrameSource source(untimed(config));
  BoardRecording recording{.width_px = source.first().grey.cols,
                           .height_px = source.first().grey.rows};
  ViewCollector collector(recording.width_px);
  ProgressBar progress("calibrate", source.expected());
  std::optional<Timestamp> last;
  while (const std::optional<Frame> frame = source.next()) {
    if (interrupted()) throw Interrupted{};
    progress.step();
    ++recording.frames;
    if (last && seconds_between(*last, frame->stamp) < kMinInterval_s) continue;
    last = frame->stamp;
    std::optional<BoardView> view = detector.detect(frame->grey);
    if (!view) continue;
    ++recording.found;
    view->stamp = frame->stamp;
    view->frame = frame->index;
    collector.add(std::move(*view));
  }
  if (const auto problem = source.problem()) fmt::print(stderr, "stillkite: {}\n", *problem);
  recording.views = collector.views();
  return recording;
}

void check_coverage(const std::vector<std::string_view>& unseen, const BoardConfig& board) {
  if (unseen.empty()) return;
  const std::string corners = fmt::format("{}", fmt::join(unseen, ", "));
  if (!board.allow_unseen_corners) {
    throw InputError(fmt::format(
        "calibration_board: the board was never seen in the {} of the image; record it there (the "
        "outer sixth of width and height), or set calibration_board.allow_unseen_corners: true",
        corners));
  }
  fmt::print(stderr,
             "stillkite: the board was never seen in the {} of the image: the lens model "
             "is extrapolated there\n",
             corners);
}

double tilt_deg(const RigidTransform& camera_from_board) {
  const double cosine = std::abs((camera_from_board.rotation * Eigen::Vector3d::UnitZ()).z());
  return std::acos(std::min(1.0, cosine)) / kDegree;
}

json parameters_json(const LensFit& fit) {
  json parameters = json::array();
  for (int i = 0; i < fit.model.parameters(); ++i) {
    parameters.push_back({{"name", name_of_parameter(fit.model, i)},
                          {"value", lens_parameter(fit.camera, i)},
                          {"sigma", std::sqrt(fit.covariance(i, i))}});
  }
  return parameters;
}

json models_json(const LensCalibration& calibration) {
  json models = json::array();
  for (const HeldOutError& one : calibration.models) {
    models.push_back({{"name", name_of_model(one.model)},
                      {"parameters", one.model.parameters()},
                      {"held_out_rms_px", one.rms_px},
                      {"selected", one.model == calibration.fit.model}});
  }
  return models;
}

json views_json(const LensCalibration& calibration, const std::vector<BoardView>& views) {
  json selected = json::array();
  for (std::size_t i = 0; i < calibration.selected.size(); ++i) {
    const BoardView& view = views[calibration.selected[i]];
    selected.push_back({{"frame", view.frame},
                        {"t_s", to_seconds(view.stamp)},
                        {"corners", view.pixels.size()},
                        {"tilt_deg", tilt_deg(calibration.fit.camera_from_board[i])},
                        {"rms_px", view_rms_px(calibration.fit.residuals[i])}});
  }
  return selected;
}

// Angle between the bearings at the middle of the left and right border.
double horizontal_fov_deg(const Camera& camera) {
  const double y = 0.5 * (camera.height_px - 1);
  const auto left = undistort(camera, {-0.5, y});
  const auto right = undistort(camera, {camera.width_px - 0.5, y});
  if (!left || !right) return std::nan("");
  return angle_between_rad(Eigen::Vector3d(left->homogeneous()),
                           Eigen::Vector3d(right->homogeneous())) /
         kDegree;
}

json calibration_json(const LensCalibration& calibration, const BoardRecording& recording,
                      const std::vector<std::string_view>& unseen) {
  const LensFit& fit = calibration.fit;
  const double fov_deg = horizontal_fov_deg(fit.camera);
  return {{"image", {{"width_px", recording.width_px}, {"height_px", recording.height_px}}},
          {"views",
           {{"frames", recording.frames},
            {"found", recording.found},
            {"different", recording.views.size()},
            {"selected", calibration.selected.size()}}},
          {"model", name_of_model(fit.model)},
          {"parameters", parameters_json(fit)},
          {"horizontal_fov_deg", std::isfinite(fov_deg) ? json(fov_deg) : json(nullptr)},
          {"corner_sigma_px", fit.corner_sigma_px},
          {"lens_sigma_px", calibration.lens_sigma_px},
          {"models", models_json(calibration)},
          {"unseen_corners", unseen},
          {"selected", views_json(calibration, recording.views)}};
}

CalibrationReportCorners report_corners(const LensCalibration& calibration,
                                        const std::vector<BoardView>& views) {
  CalibrationReportCorners corners;
  for (std::size_t i = 0; i < calibration.selected.size(); ++i) {
    const BoardView& view = views[calibration.selected[i]];
    for (std::size_t j = 0; j < view.pixels.size(); ++j) {
      if (!calibration.fit.inliers[i][j]) continue;
      corners.pixels.emplace_back(view.pixels[j].cast<float>());
      corners.residuals_px.emplace_back(calibration.fit.residuals[i][j].cast<float>());
    }
  }
  return corners;
}

std::string sensor_yaml(const LensCalibration& calibration, const BoardRecording& recording,
                        const BoardConfig& board) {
  const LensFit& fit = calibration.fit;
  const Eigen::VectorXd variances = fit.covariance.diagonal().head(fit.model.parameters());
  const Eigen::VectorXd sigmas = variances.cwiseSqrt();
  const auto first_coefficient = sigmas.begin() + 4;
  return calibration_yaml(
      {.camera = fit.camera,
       .coefficients = fit.model.coefficients,
       .comment = fmt::format("stillkite calibrate: {} of {} views of the board ({}, {} x {})",
                              calibration.selected.size(), recording.found, name_of(board.type),
                              board.columns, board.rows),
       .intrinsics_note = fmt::format("fu, fv, cu, cv; sigma {:.3g}",
                                      fmt::join(sigmas.begin(), first_coefficient, ", ")),
       .coefficients_note =
           fit.model.coefficients == 0
               ? ""
               : fmt::format("sigma {:.2g}", fmt::join(first_coefficient, sigmas.end(), ", ")),
       .notes = fmt::format("# image displacement by the sigmas: {:.3f} px\n",
                            calibration.lens_sigma_px)});
}

}  // namespace

json calibrate_by_board(const CalibrateConfig& config, const std::string& title,
                        const fs::path& out) {
  constexpr std::uintmax_t kMaxBytes = 4 << 20;  // of all results
  const BoardConfig& board = *config.calibration_board;
  const BoardRecording recording = read_views(config.run.source, board);
  const LensCalibration calibration =
      calibrate_lens(recording.views, recording.width_px, recording.height_px);
  const auto unseen = unseen_corners(recording.views, recording.width_px, recording.height_px);
  check_coverage(unseen, board);
  const std::string origin = config.run.source.path.string();
  check_camera(calibration.fit.camera, origin);
  check_lens(calibration.fit.camera, nullptr, origin);
  const json result = calibration_json(calibration, recording, unseen);
  prepare_output_folder(out, kMaxBytes);
  write_files(out, {{"sensor.yaml", sensor_yaml(calibration, recording, board)},
                    {"calibration.json", json_text(result) + "\n"},
                    {"report.html",
                     calibration_report_html(title, print_config(config), result,
                                             report_corners(calibration, recording.views))}});
  return result;
}

void print_board_calibration(const json& calibration) {
  const json& views = calibration["views"];
  fmt::print("{} of {} different views, board found in {} images\n{}\n",
             views["selected"].get<int>(), views["different"].get<int>(), views["found"].get<int>(),
             calibration["model"].get<std::string>());
  for (const json& one : calibration["parameters"]) {
    fmt::print("  {:<12} {:>14.6f}  sigma {:.2g}\n", one["name"].get<std::string>(),
               one["value"].get<double>(), one["sigma"].get<double>());
  }
  fmt::print("corners: sigma {:.3f} px; lens over the image: sigma {:.3f} px\n",
             calibration["corner_sigma_px"].get<double>(),
             calibration["lens_sigma_px"].get<double>());
}

}  // namespace stillkite
