#include <fmt/format.h>

#include <Eigen/LU>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "io/dataset/calibration.hpp"
#include "io/dataset/flight_camera.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

Camera make_camera(int width_px, int height_px, double focal_x_px, double focal_y_px,
                   double centre_x_px, double centre_y_px, DistortionModel distortion,
                   const std::vector<double>& coefficients) {
  Camera camera{width_px, height_px, focal_x_px, focal_y_px, centre_x_px, centre_y_px};
  if (const auto wrong = set_distortion(camera, distortion, coefficients)) {
    throw InputError("coefficients: " + *wrong);
  }
  if (!(width_px > 0 && height_px > 0 && focal_x_px > 0 && focal_y_px > 0)) {
    throw InputError("camera: image size and focal lengths must be positive");
  }
  return camera;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::MatrixX2d project_points(const Camera& camera, const Eigen::MatrixX3d& points) {
  Eigen::MatrixX2d pixels(points.rows(), 2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto pixel = project(camera, points.row(i));
    pixels.row(i) = pixel.value_or(Eigen::Vector2d(kNan, kNan));
  }
  return pixels;
}

Eigen::MatrixX2d undistort_pixels(const Camera& camera, const Eigen::MatrixX2d& pixels) {
  Eigen::MatrixX2d points(pixels.rows(), 2);
  for (Eigen::Index i = 0; i < pixels.rows(); ++i) {
    const auto point = undistort(camera, pixels.row(i));
    points.row(i) = point.value_or(Eigen::Vector2d(kNan, kNan));
  }
  return points;
}

Eigen::Quaterniond quaternion_of(const Eigen::Matrix3d& R) {
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error < 1e-3 && R.determinant() > 0)) {
    throw InputError(fmt::format(
        "rotation: the matrix is not a rotation (max |R R^T - I| = {:.3g}, determinant {:.3g}); "
        "pass an orthonormal right-handed one",
        error, R.determinant()));
  }
  return Eigen::Quaterniond(R).normalized();
}

// `rotation`: (3, 3) matrix or (4,) quaternion.
RigidTransform make_transform(const std::optional<Table>& rotation,
                              const Eigen::Vector3d& translation) {
  if (!rotation) return {Eigen::Quaterniond::Identity(), translation};
  if (rotation->ndim() == 1) return {rotation->cast<Eigen::Quaterniond>(), translation};
  require_shape(*rotation, "rotation", 3, 3);
  return {quaternion_of(rotation->cast<Eigen::Matrix3d>()), translation};
}

RigidTransform mount(double down_deg, const std::array<double, 3>& position_m) {
  return mount_of({.down_deg = down_deg, .position_m = position_m}, {});
}

void bind_camera(py::module_& m) {
  py::class_<Camera>(
      m, "Camera",
      "Pinhole camera with lens distortion; the centre of the first pixel is (0, 0).\n\n"
      "distortion: none, radial-tangential (k1 k2 p1 p2 [k3 [k4 k5 k6]], as OpenCV)\n"
      "or equidistant (k1 k2 k3 k4, OpenCV's fisheye).")
      .def(py::init(&make_camera), py::arg("width_px"), py::arg("height_px"), py::arg("focal_x_px"),
           py::arg("focal_y_px"), py::arg("centre_x_px"), py::arg("centre_y_px"),
           py::arg("distortion") = DistortionModel::none,
           py::arg("coefficients") = std::vector<double>())
      .def_readonly("width_px", &Camera::width_px, "Image width, px.")
      .def_readonly("height_px", &Camera::height_px, "Image height, px.")
      .def_readonly("focal_x_px", &Camera::focal_x_px, "Focal length along the rows, px.")
      .def_readonly("focal_y_px", &Camera::focal_y_px, "Focal length along the columns, px.")
      .def_readonly("centre_x_px", &Camera::centre_x_px, "Principal point, px.")
      .def_readonly("centre_y_px", &Camera::centre_y_px, "Principal point, px.")
      .def_readonly("distortion", &Camera::distortion, "Distortion model.")
      .def_property_readonly(
          "coefficients",
          [](const Camera& camera) {
            return Eigen::Map<const Eigen::Matrix<double, 8, 1>>(camera.coefficients.data()).eval();
          },
          "Distortion coefficients, (8,); unused ones are 0.")
      .def("project", &project_points, py::arg("points_in_camera"),
           "Pixels (N, 2) of points (N, 3) in the camera frame; NaN for points that are not in\n"
           "front of the camera.")
      .def(
          "undistort", &undistort_pixels, py::arg("pixels"),
          "Points (x, y), (N, 2), of the plane z = 1 that project to the pixels (N, 2); NaN where\n"
          "the lens model is not invertible.")
      .def(
          "__eq__", [](const Camera& a, const Camera& b) { return a == b; }, py::arg("other"))
      .def("__repr__", [](const Camera& c) {
        return fmt::format("Camera({}x{} px, focal length {} x {} px, centre ({}, {}), {})",
                           c.width_px, c.height_px, c.focal_x_px, c.focal_y_px, c.centre_x_px,
                           c.centre_y_px, name_of(c.distortion));
      });
}

void bind_rigid_transform(py::module_& m) {
  py::class_<RigidTransform>(
      m, "RigidTransform",
      "b_from_a: x_in_b = rotation x_in_a + translation; the translation is\n"
      "the origin of a in b, m.")
      .def(py::init(&make_transform), py::arg("rotation") = py::none(),
           py::arg("translation") = Eigen::Vector3d(0, 0, 0),
           "rotation: matrix (3, 3) or unit quaternion (w, x, y, z); None: identity.")
      .def_property_readonly(
          "rotation", [](const RigidTransform& t) { return t.rotation.toRotationMatrix(); },
          "Rotation matrix, (3, 3).")
      .def_readonly("rotation_wxyz", &RigidTransform::rotation, "Unit quaternion (w, x, y, z).")
      .def_readonly("translation", &RigidTransform::translation, "Translation (3,), m.")
      .def_property_readonly(
          "matrix",
          [](const RigidTransform& t) {
            Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
            matrix.topLeftCorner<3, 3>() = t.rotation.toRotationMatrix();
            matrix.topRightCorner<3, 1>() = t.translation;
            return matrix;
          },
          "Homogeneous matrix, (4, 4).")
      .def("inverse", &RigidTransform::inverse, "a_from_b.")
      .def(
          "transform",
          [](const RigidTransform& t, const Eigen::Vector3d& x) -> Eigen::Vector3d {
            return t * x;
          },
          py::arg("point"), "x_in_b of x_in_a, (3,), m.")
      .def(
          "__matmul__", [](const RigidTransform& a, const RigidTransform& b) { return a * b; },
          py::arg("other"), "c_from_a = c_from_b @ b_from_a.")
      .def("__repr__", [](const RigidTransform& t) {
        return fmt::format(
            "RigidTransform(wxyz=[{:.6g}, {:.6g}, {:.6g}, {:.6g}], "
            "translation=[{:.6g}, {:.6g}, {:.6g}])",
            t.rotation.w(), t.rotation.x(), t.rotation.y(), t.rotation.z(), t.translation.x(),
            t.translation.y(), t.translation.z());
      });
}

}  // namespace

void bind_geometry(py::module_& m) {
  bind_camera(m);
  bind_rigid_transform(m);
  py::class_<Calibration>(m, "Calibration", "Intrinsics and extrinsics of a calibration file.")
      .def_readonly("camera", &Calibration::camera, "Lens model and image size.")
      .def_readonly("body_from_camera", &Calibration::body_from_camera,
                    "Mount of the camera; None if the file has none.")
      .def_readonly("timeshift_cam_imu_s", &Calibration::timeshift_cam_imu_s,
                    "t_imu = t_cam + timeshift, s (Kalibr); None if the file has none.");
  m.def("read_calibration", py::overload_cast<const std::filesystem::path&>(&read_calibration),
        py::arg("path"),
        "Reads a calibration: EuRoC sensor.yaml, Kalibr camchain, or OpenCV YAML or XML.");
  m.def("mount", &mount, py::arg("down_deg") = 90.0,
        py::arg("position_m") = std::array<double, 3>{},
        "body_from_camera without roll: angle of the optical axis below the body's x-y plane, deg\n"
        "(0 forward, 90 down), position of the camera in the body, m.");
}

}  // namespace stillkite::python
