#include "evaluation/evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "io/dataset/trajectory_file.hpp"
#include "navigation/estimate.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"
#include "python/trajectory.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

PoseSeries make_series(const py::array& stamps_ns, const Table& positions_m,
                       const std::optional<Table>& attitudes_wxyz) {
  const std::vector<Timestamp> stamps = stamps_of(stamps_ns, "stamps_ns");
  const auto count = static_cast<py::ssize_t>(stamps.size());
  require_shape(positions_m, "positions_m", count, 3);
  if (attitudes_wxyz) require_shape(*attitudes_wxyz, "attitudes_wxyz", count, 4);
  PoseSeries series{.poses = {}, .has_attitude = attitudes_wxyz.has_value()};
  for (py::ssize_t i = 0; i < count; ++i) {
    RigidTransform pose{.translation = Eigen::Map<const Eigen::Vector3d>(positions_m.data(i, 0))};
    if (attitudes_wxyz) {
      const py::object row = (*attitudes_wxyz)[py::int_(i)];
      pose.rotation = row.cast<Eigen::Quaterniond>();
    }
    series.poses.push_back({stamps[static_cast<std::size_t>(i)], pose});
  }
  return series;
}

Eigen::Vector3d position_of(const Estimate& estimate, bool metric) {
  if (metric && estimate.metric) return estimate.metric->position_in_world_m;
  if (!metric && estimate.relative) return estimate.relative->position_in_world_heights;
  throw InputError(fmt::format(
      "estimate {}: no position in {} (verdict {}); pass those that have one, for example "
      "[e for e in estimates if e.{}]",
      estimate.frame_index, metric ? "metres, as later ones have" : "initial heights",
      name_of(estimate.verdict), metric ? "metric" : "relative"));
}

// In metres if any estimate is metric, else in initial heights.
PoseSeries series_of(const std::vector<const Estimate*>& estimates) {
  const bool metric =
      std::ranges::any_of(estimates, [](const Estimate* e) { return e->metric.has_value(); });
  PoseSeries series;
  for (const Estimate* estimate : estimates) {
    series.poses.push_back(
        {estimate->stamp, {estimate->world_from_body, position_of(*estimate, metric)}});
  }
  return series;
}

PoseSeries read_series(const std::filesystem::path& path) {
  std::vector<StampedPose> poses = read_trajectory(path);
  const bool attitude = has_attitude(poses);
  return {.poses = std::move(poses), .has_attitude = attitude};
}

py::array_t<std::int64_t> stamps(const PoseSeries& series) {
  std::vector<Timestamp> stamps;
  for (const StampedPose& pose : series.poses) stamps.push_back(pose.stamp);
  return array_of(stamps);
}

using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
Positions positions(const PoseSeries& series) {
  Positions rows(series.poses.size(), 3);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows.row(i) = series.poses[static_cast<std::size_t>(i)].world_from_body.translation;
  }
  return rows;
}

using Attitudes = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
std::optional<Attitudes> attitudes(const PoseSeries& series) {
  if (!series.has_attitude) return std::nullopt;
  Attitudes rows(series.poses.size(), 4);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Eigen::Quaterniond& q =
        series.poses[static_cast<std::size_t>(i)].world_from_body.rotation;
    rows.row(i) << q.w(), q.x(), q.y(), q.z();
  }
  return rows;
}

Evaluation evaluate_series(const PoseSeries& estimate, const PoseSeries& truth, Alignment alignment,
                           double tolerance_s) {
  const std::vector<EvaluatedMotion> motions =
      evaluated_motions(estimate.poses, estimate.has_attitude);
  Evaluation evaluation =
      evaluate(motions, Truth{.poses = truth.poses, .has_attitude = truth.has_attitude},
               {.tolerance_s = tolerance_s, .alignment = alignment, .body_from_camera = {}});
  if (evaluation.matched == 0) {
    throw InputError(fmt::format(
        "evaluate: no stamp of the estimate is within {} s of the truth; both must be nanoseconds "
        "of the same clock",
        tolerance_s));
  }
  return evaluation;
}

std::optional<RelativeError> relative_error(const PoseSeries& estimate, const PoseSeries& truth,
                                            std::optional<int> frames,
                                            std::optional<double> distance_m, double tolerance_s) {
  if (frames.has_value() == distance_m.has_value() || frames.value_or(1) < 1 ||
      !(distance_m.value_or(1) > 0)) {
    throw InputError("relative_error: pass either frames > 0 or distance_m > 0");
  }
  const std::vector<EvaluatedMotion> motions =
      evaluated_motions(estimate.poses, estimate.has_attitude);
  const std::vector<PosePair> pairs = matched_poses(
      motions, Truth{.poses = truth.poses, .has_attitude = truth.has_attitude}, tolerance_s);
  return frames ? relative_error_over_frames(pairs, *frames)
                : relative_error_over_distance(pairs, *distance_m);
}

void bind_trajectory(py::module_& m) {
  py::class_<PoseSeries>(m, "Trajectory", "Poses of the body in the world, stamps ascending.")
      .def(
          py::init(&make_series), py::arg("stamps_ns"), py::arg("positions_m"),
          py::arg("attitudes_wxyz") = py::none(),
          "stamps_ns: (N,), integers, ns. positions_m: (N, 3). attitudes_wxyz: (N, 4), world from\n"
          "body; None: unknown.")
      .def_static("from_estimates", &series_of, py::arg("estimates"),
                  "Poses of estimates, in metres, or in initial heights if none is metric. Raises\n"
                  "InputError on one without a position in that unit.")
      .def_static("read", &read_series, py::arg("path"),
                  "EuRoC or TUM file, or the folder of a data set or of a run.")
      .def_property_readonly("stamps_ns", &stamps, "Stamps, (N,), ns.")
      .def_property_readonly("positions_m", &positions, "Positions in the world, (N, 3), m.")
      .def_property_readonly("attitudes_wxyz", &attitudes,
                             "World from body, (N, 4), w, x, y, z; None if unknown.")
      .def("__len__", [](const PoseSeries& series) { return series.poses.size(); });
}

void bind_relative_error(py::module_& m) {
  py::class_<RelativeError>(m, "RelativeError",
                            "Relative pose error (RPE) of the motions over one step.")
      .def_readonly("count", &RelativeError::count, "Number of steps.")
      .def_readonly("translation_rmse_m", &RelativeError::translation_rmse_m,
                    "RMS error of the displacement, m.")
      .def_readonly("rotation_rmse_rad", &RelativeError::rotation_rmse_rad,
                    "RMS error of the rotation, rad; None without attitudes.")
      .def_readonly("mean_length_m", &RelativeError::mean_length_m,
                    "Mean true path length of a step, m.");
}

// Member of an optional group, None without it.
template <typename Value>
auto position_value(Value PositionError::*member) {
  return [member](const Evaluation& e) -> std::optional<Value> {
    if (!e.trajectory || !e.trajectory->position) return std::nullopt;
    return (*e.trajectory->position).*member;
  };
}

auto end_value(double EndError::*member) {
  return [member](const Evaluation& e) -> std::optional<double> {
    const auto end = position_value(&PositionError::end)(e);
    if (!end || !*end) return std::nullopt;
    return (**end).*member;
  };
}

auto attitude_value(double AttitudeError::*member) {
  return [member](const Evaluation& e) -> std::optional<double> {
    if (!e.trajectory || !e.trajectory->attitude) return std::nullopt;
    return (*e.trajectory->attitude).*member;
  };
}

void bind_result(py::module_& m) {
  py::class_<Evaluation>(m, "Evaluation",
                         "Errors of a trajectory; None where estimate or truth lacks the quantity.")
      .def_readonly("matched", &Evaluation::matched, "Number of estimates with a true pose.")
      .def_readonly("path_length_m", &Evaluation::path_length_m, "Length of the true path, m.")
      .def_property_readonly("position_rmse_m", position_value(&PositionError::rmse_m),
                             "Absolute trajectory error (ATE), 3-D RMS, m.")
      .def_property_readonly("position_max_m", position_value(&PositionError::max_m),
                             "Largest position error, m.")
      .def_property_readonly("end_error_horizontal_m", end_value(&EndError::horizontal_m),
                             "Horizontal error of the last pose, m.")
      .def_property_readonly("end_error_vertical_m", end_value(&EndError::vertical_m),
                             "Vertical error of the last pose, absolute value, m.")
      .def_property_readonly("tilt_rmse_rad", attitude_value(&AttitudeError::tilt_rmse_rad),
                             "RMS angle between the two verticals, rad.")
      .def_property_readonly("yaw_rmse_rad", attitude_value(&AttitudeError::yaw_rmse_rad),
                             "RMS yaw error, rad.")
      .def_readonly("drift_percent", &Evaluation::drift_percent,
                    "100 x 3-D end error / path length.")
      .def_readonly("rmse_percent", &Evaluation::rmse_percent, "100 x position RMSE / path length.")
      .def_readonly("per_frame", &Evaluation::per_frame,
                    "Relative pose error between consecutive matched frames.")
      .def_readonly("per_metre", &Evaluation::per_metre,
                    "Relative pose error over 1 m of the path.")
      .def_readonly("per_tenth", &Evaluation::per_tenth,
                    "Relative pose error over 10 % of the path.");
}

}  // namespace

void bind_evaluation(py::module_& m) {
  bind_trajectory(m);
  bind_relative_error(m);
  bind_result(m);
  m.def(
      "evaluate", &evaluate_series, py::arg("estimate"), py::arg("truth"),
      py::arg("alignment") = Alignment::none, py::arg("tolerance_s") = 0.01,
      "Errors of a trajectory relative to the truth, as `stillkite evaluate`.\n\n"
      "alignment of the estimate before the errors: none, origin (first pose), yaw (4 degrees of\n"
      "freedom), se3 or sim3. tolerance_s: largest time difference to the nearest true pose, s.\n"
      "Raises InputError if no stamp matches.");
  m.def("relative_error", &relative_error, py::arg("estimate"), py::arg("truth"), py::kw_only(),
        py::arg("frames") = py::none(), py::arg("distance_m") = py::none(),
        py::arg("tolerance_s") = 0.01,
        "Relative pose error (RPE) over steps of a number of frames, or of a distance along the\n"
        "true path, m; None if the path is shorter.");
}

}  // namespace stillkite::python
