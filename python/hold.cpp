#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "navigation/hover_pilot.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"
#include "python/configuration.hpp"
#include "stabilization/hold_controller.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

HoldConfig hold_config_of(const RunConfig& config, bool shadow) {
  return shadow ? in_shadow_mode(config.hold) : config.hold;
}

struct LockedPilot {
  explicit LockedPilot(HoverPilot&& unlocked) : pilot(std::move(unlocked)) {}

  HoverPilot pilot;
  std::mutex mutex;
};

std::unique_ptr<LockedPilot> make_pilot(const Camera& camera,
                                        const RigidTransform& body_from_camera,
                                        const InitialState& initial, const py::object& source,
                                        bool shadow, const std::optional<py::array>& valid_pixels) {
  const RunConfig config = run_config_of(source);
  std::optional<ImageView> mask;
  if (valid_pixels) mask = image_view(*valid_pixels, "valid_pixels");
  return std::make_unique<LockedPilot>(HoverPilot(camera, body_from_camera, config.navigator,
                                                  config.estimator, hold_config_of(config, shadow),
                                                  initial, mask));
}

HoldStep step_pilot(LockedPilot& self, const py::array& image, Timestamp stamp,
                    const std::optional<TetherReading>& tether, const SensorReadings& readings,
                    const std::optional<Timestamp>& now,
                    const std::optional<Eigen::Quaterniond>& station_from_body, HoldReason withheld,
                    bool hold_here, double stamp_sigma_s) {
  const ImageView view = image_view(image, "image");
  const TetheredReadings tethered{.now = now.value_or(stamp),
                                  .tether = tether,
                                  .station_from_body = station_from_body,
                                  .sensors = readings,
                                  .withheld = withheld,
                                  .hold_here = hold_here};
  const py::gil_scoped_release released;
  const std::scoped_lock lock(self.mutex);
  return self.pilot.step(view, stamp, tethered, stamp_sigma_s);
}

void bind_tether(py::module_& m) {
  py::class_<TetherReading>(
      m, "TetherReading",
      "Measurement of the tether's sensors, in the station's frame: x ahead,\n"
      "y left, z up.")
      .def(py::init([](Timestamp stamp, double length_m, double elevation_rad, double azimuth_rad,
                       bool taut) {
             return TetherReading{stamp, {length_m, elevation_rad, azimuth_rad}, taut};
           }),
           py::arg("stamp_ns"), py::arg("length_m"), py::arg("elevation_rad"),
           py::arg("azimuth_rad"), py::arg("taut") = true,
           "elevation_rad in [0, pi]; taut False: the length is not the distance of the drone.")
      .def_readonly("stamp_ns", &TetherReading::stamp, "Stamp, ns.")
      .def_property_readonly(
          "length_m", [](const TetherReading& r) { return r.tether.length_m; }, "Length, m.")
      .def_property_readonly(
          "elevation_rad", [](const TetherReading& r) { return r.tether.elevation_rad; },
          "Elevation, rad.")
      .def_property_readonly(
          "azimuth_rad", [](const TetherReading& r) { return r.tether.azimuth_rad; },
          "Azimuth, rad.")
      .def_readonly("taut", &TetherReading::taut, "False on a slack tether.");
  py::class_<TetherCommand>(m, "TetherCommand", "Rates of the tether's coordinates and of yaw.")
      .def_readonly("length_rate_m_s", &TetherCommand::length_rate_m_s, "Length rate, m/s.")
      .def_readonly("elevation_rate_rad_s", &TetherCommand::elevation_rate_rad_s,
                    "Elevation rate, rad/s.")
      .def_readonly("azimuth_rate_rad_s", &TetherCommand::azimuth_rate_rad_s,
                    "Azimuth rate, rad/s.")
      .def_readonly("yaw_rate_rad_s", &TetherCommand::yaw_rate_rad_s,
                    "Yaw rate of the drone, rad/s, left is positive.");
}

void bind_motion_estimate(py::module_& m) {
  py::class_<MotionEstimate>(m, "MotionEstimate",
                             "Relative pose of the camera to the reference pose: input of "
                             "HoldController, for an estimator\n"
                             "of your own.")
      .def(py::init([](Timestamp stamp, const Eigen::Quaterniond& reference_from_camera_wxyz,
                       DisplacementKind displacement_kind,
                       const Eigen::Vector3d& displacement_in_reference,
                       const std::optional<Eigen::Matrix3d>& displacement_covariance,
                       double mean_shift_px, double parallax_rad,
                       const std::optional<Eigen::Vector3d>& velocity, ScaleSource scale,
                       EstimateStatus status) {
             MotionEstimate motion{.stamp = stamp,
                                   .status = status,
                                   .reference_from_camera = reference_from_camera_wxyz,
                                   .displacement_kind = displacement_kind,
                                   .displacement_in_reference = displacement_in_reference,
                                   .displacement_covariance =
                                       displacement_covariance.value_or(Eigen::Matrix3d::Zero()),
                                   .mean_shift_px = mean_shift_px,
                                   .parallax_rad = parallax_rad,
                                   .scale = scale};
             if (velocity) motion.twist_in_camera = Twist{.velocity_m_s = *velocity};
             return motion;
           }),
           py::arg("stamp_ns"), py::arg("reference_from_camera_wxyz"),
           py::arg("displacement_kind") = DisplacementKind::unknown,
           py::arg("displacement_in_reference") = Eigen::Vector3d(0, 0, 0),
           py::arg("displacement_covariance") = py::none(), py::arg("mean_shift_px") = 0.0,
           py::arg("parallax_rad") = 0.0, py::arg("velocity_in_camera_m_s") = py::none(),
           py::arg("scale") = ScaleSource::none, py::arg("status") = EstimateStatus::ok,
           "displacement_in_reference: origin of the camera in the reference camera, (3,), m for\n"
           "the kind metric, unit vector for direction. parallax_rad: displacement over scene "
           "depth.")
      .def_readonly("stamp_ns", &MotionEstimate::stamp, "Time of exposure, ns.")
      .def_readonly("status", &MotionEstimate::status, "ok, gated, predicted or lost.")
      .def_readonly("displacement_kind", &MotionEstimate::displacement_kind,
                    "unknown, zero, direction or metric.")
      .def_readonly("displacement_in_reference", &MotionEstimate::displacement_in_reference,
                    "Origin of the camera in the reference camera, (3,).");
}

void bind_decision(py::module_& m) {
  py::class_<HoldDecision>(m, "HoldDecision",
                           "Command within the vehicle's limits; action hold always has a reason.")
      .def_readonly("command", &HoldDecision::command, "Rates of the tether and of yaw.")
      .def_readonly("action", &HoldDecision::action, "hold (all rates are 0) or command.")
      .def_readonly("reason", &HoldDecision::reason, "Reason for no command; none if controlled.")
      .def_readonly("position_error_in_station_m", &HoldDecision::position_error_in_station_m,
                    "Reference minus camera in the station's frame, (3,), m.")
      .def_readonly("yaw_error_rad", &HoldDecision::yaw_error_rad, "Yaw to the left, rad.");
  py::class_<HoldStep>(m, "HoldStep", "Estimate and command of one image.")
      .def_readonly("estimate", &HoldStep::estimate, "Estimate of the navigator.")
      .def_readonly("decision", &HoldStep::decision, "Decision of the controller.");
}

void bind_controller(py::module_& m) {
  py::class_<HoldController>(m, "HoldController",
                             "Position hold of a tethered drone: tether rates that reduce the\n"
                             "estimated displacement from the reference pose.")
      .def(py::init([](const py::object& source, bool shadow) {
             return HoldController(hold_config_of(run_config_of(source), shadow));
           }),
           py::arg("config") = py::none(), py::kw_only(), py::arg("shadow") = false,
           "config: section hold of Config. shadow: the drone does not execute the commands.")
      .def(
          "decide",
          [](HoldController& self, Timestamp now, const std::optional<MotionEstimate>& estimate,
             const std::optional<TetherReading>& tether,
             const Eigen::Quaterniond& station_from_camera_wxyz, HoldReason withheld) {
            return self.decide({.now = now,
                                .estimate = estimate,
                                .tether = tether,
                                .station_from_camera = station_from_camera_wxyz,
                                .withheld = withheld});
          },
          py::arg("now_ns"), py::arg("estimate"), py::arg("tether"),
          py::arg("station_from_camera_wxyz"), py::arg("withheld") = HoldReason::none,
          "Decision at a control instant, by the latest estimate and tether reading (None: none\n"
          "received yet). station_from_camera_wxyz: attitude at the estimate's exposure.");
}

}  // namespace

void bind_hold(py::module_& m) {
  bind_tether(m);
  bind_motion_estimate(m);
  bind_decision(m);
  bind_controller(m);
  py::class_<LockedPilot>(m, "HoverPilot",
                          "Navigator and hold controller of a tethered drone in one step.")
      .def(py::init(&make_pilot), py::arg("camera"), py::arg("body_from_camera"),
           py::arg("initial"), py::arg("config") = py::none(), py::kw_only(),
           py::arg("shadow") = false, py::arg("valid_pixels") = py::none(),
           "As Navigator. body_from_camera: mount of the gimbal, which keeps pitch and roll.\n"
           "shadow: the drone does not execute the commands, as in a recording.")
      .def("step", &step_pilot, py::arg("image"), py::arg("stamp_ns"),
           py::arg("tether") = py::none(), py::arg("readings") = SensorReadings(), py::kw_only(),
           py::arg("now_ns") = py::none(), py::arg("station_from_body_wxyz") = py::none(),
           py::arg("withheld") = HoldReason::none, py::arg("hold_here") = false,
           py::arg("stamp_sigma_s") = 0.0,
           "Estimate and command of an image; arguments as for Navigator.step.\n\n"
           "tether: latest reading. now_ns: time of the command, default the image's stamp.\n"
           "station_from_body_wxyz: attitude at the exposure, yaw zeroed at take-off.\n"
           "withheld: reason of an operator to withhold the command. hold_here: hold the pose of\n"
           "this image from now on.");
}

}  // namespace stillkite::python
