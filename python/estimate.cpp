#include <fmt/format.h>

#include "navigation/estimate.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

// Arrays of a result are read-only views of its memory.

void bind_metric_state(py::module_& m) {
  py::class_<MetricState>(
      m, "MetricState",
      "Position and velocity in metres. The covariances exclude the error of an\n"
      "initial height, an unknown constant factor, until a sensor measures it.")
      .def_readonly("position_in_world_m", &MetricState::position_in_world_m,
                    "Position of the body in the world, (3,), m.")
      .def_readonly("position_covariance_m2", &MetricState::position_covariance_m2,
                    "Covariance of the position in the world, (3, 3), m^2.")
      .def_readonly("velocity_in_world_m_s", &MetricState::velocity_in_world_m_s,
                    "Velocity of the camera in the world, mean over the interval, (3,), m/s.")
      .def_readonly("velocity_in_camera_m_s", &MetricState::velocity_in_camera_m_s,
                    "The same in the camera frame at mid-interval, (3,), m/s.")
      .def_readonly("velocity_covariance_m2_s2", &MetricState::velocity_covariance_m2_s2,
                    "Covariance of the velocity in the camera frame, (3, 3), m^2/s^2.")
      .def_readonly("scale", &MetricState::scale,
                    "Source of the scale: initial_height, range, barometer or imu.")
      .def_readonly("scale_age_s", &MetricState::scale_age_s,
                    "Time since the last reading of that source, s.");
}

void bind_relative_state(py::module_& m) {
  py::class_<RelativeState>(m, "RelativeState",
                            "Position and velocity in initial heights of the camera above ground.")
      .def_readonly("position_in_world_heights", &RelativeState::position_in_world_heights,
                    "Position of the body in the world, (3,), initial heights.")
      .def_readonly("velocity_in_world_heights_s", &RelativeState::velocity_in_world_heights_s,
                    "Velocity of the camera in the world, (3,), initial heights per second.");
}

void bind_reference_pose(py::module_& m) {
  py::class_<ReferencePose>(m, "ReferencePose", "Pose of the camera relative to a reference image.")
      .def_readonly("stamp_ns", &ReferencePose::stamp, "Stamp of the reference image, ns.")
      .def_readonly("on_first_reference", &ReferencePose::on_first_reference,
                    "False: a later image is the reference.")
      .def_readonly("reference_from_camera_wxyz", &ReferencePose::reference_from_camera,
                    "Quaternion (w, x, y, z).")
      .def_readonly("rotation_covariance_rad2", &ReferencePose::rotation_covariance_rad2,
                    "Covariance of the rotation vector in the reference camera, (3, 3), rad^2.")
      .def_readonly("displacement", &ReferencePose::displacement,
                    "unknown, zero, direction or metric.")
      .def_readonly("displacement_in_reference_m", &ReferencePose::displacement_in_reference_m,
                    "Origin of the camera in the reference camera, (3,), m; None unless metric.")
      .def_readonly("direction_in_reference", &ReferencePose::direction_in_reference,
                    "Unit vector to that origin, (3,); None unless displacement is direction.")
      .def_readonly("displacement_covariance", &ReferencePose::displacement_covariance,
                    "Covariance of displacement, m^2, or direction, (3, 3), reference camera.");
}

}  // namespace

void bind_estimate(py::module_& m) {
  bind_metric_state(m);
  bind_relative_state(m);
  bind_reference_pose(m);
  py::class_<Estimate>(
      m, "Estimate",
      "State at an image's stamp. World: z up by gravity, ground at z = 0; body: x forward, y "
      "left,\n"
      "z up; camera: x right, y down, z forward. The pose is predicted unless is_measured.")
      .def_readonly("stamp_ns", &Estimate::stamp, "Stamp of the image, ns.")
      .def_readonly("frame_index", &Estimate::frame_index, "Number of the image, from 0.")
      .def_readonly("verdict", &Estimate::verdict, "Status of the frame: ok, or why not measured.")
      .def_property_readonly(
          "is_measured", [](const Estimate& e) { return is_measured(e.verdict); },
          "True if the frame is measured or its pose given, not predicted.")
      .def_readonly("source", &Estimate::source,
                    "Estimator that produced it: flow, reference or fused.")
      .def_property_readonly(
          "world_from_body", [](const Estimate& e) { return e.world_from_body.toRotationMatrix(); },
          "Attitude of the body, rotation matrix, (3, 3).")
      .def_readonly("world_from_body_wxyz", &Estimate::world_from_body,
                    "Attitude of the body, quaternion (w, x, y, z).")
      .def_readonly("attitude_covariance_rad2", &Estimate::attitude_covariance_rad2,
                    "Covariance of the rotation vector in the world, (3, 3), rad^2.")
      .def_readonly("angular_rate_in_camera_rad_s", &Estimate::angular_rate_in_camera_rad_s,
                    "Mean angular rate over the interval, camera frame, (3,), rad/s.")
      .def_readonly("angular_rate_covariance_rad2_s2", &Estimate::angular_rate_covariance_rad2_s2,
                    "Covariance of the angular rate in the camera frame, (3, 3), rad^2/s^2.")
      .def_readonly("metric", &Estimate::metric,
                    "Position and velocity in metres; None without a source of scale.")
      .def_readonly("relative", &Estimate::relative,
                    "The same in initial heights; None if metric, or if no length is measured.")
      .def_readonly("reference", &Estimate::reference,
                    "Pose relative to the reference image; None unless measured in this image.")
      .def("__repr__", [](const Estimate& e) {
        return fmt::format("Estimate(stamp_ns={}, verdict='{}', source='{}')", e.stamp.ns,
                           name_of(e.verdict), name_of(e.source));
      });
}

}  // namespace stillkite::python
