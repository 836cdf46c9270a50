#include <fmt/format.h>

#include <optional>
#include <vector>

#include "io/dataset/sensor_log.hpp"
#include "navigation/sensor_readings.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

constexpr int kImuColumns = 6;

// Both or none; rows (angular rate, specific force).
TimeSeries<Vector6d> imu_series(const std::optional<py::array>& stamps_ns,
                                const std::optional<Table>& imu) {
  if (stamps_ns.has_value() != imu.has_value()) {
    throw InputError("imu_stamps_ns and imu: pass both, or none of them");
  }
  TimeSeries<Vector6d> series;
  if (!imu) return series;
  series.stamps = stamps_of(*stamps_ns, "imu_stamps_ns");
  require_shape(*imu, "imu", static_cast<py::ssize_t>(series.stamps.size()), kImuColumns);
  const auto rows = imu->unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    series.values.emplace_back(Eigen::Map<const Vector6d>(rows.data(i, 0)));
  }
  series.max_gap_s = max_gap_s(series.stamps);
  return series;
}

SensorReadings make_readings(const std::optional<Eigen::Vector3d>& mean_angular_rate_in_body_rad_s,
                             std::optional<double> height_m, ScaleSource height_source,
                             const std::optional<Eigen::Quaterniond>& attitude_wxyz,
                             const std::optional<Vector6d>& acceleration,
                             const std::optional<py::array>& imu_stamps_ns,
                             const std::optional<Table>& imu) {
  SensorReadings readings{.mean_angular_rate_in_body_rad_s = mean_angular_rate_in_body_rad_s,
                          .height_m = height_m,
                          .height_source = height_source,
                          .attitude = attitude_wxyz,
                          .acceleration = acceleration,
                          .inertial = {}};
  const TimeSeries<Vector6d> series = imu_series(imu_stamps_ns, imu);
  for (std::size_t i = 0; i < series.stamps.size(); ++i) {
    readings.inertial.push_back({.stamp = series.stamps[i],
                                 .angular_rate_in_body_rad_s = series.values[i].head<3>(),
                                 .specific_force_in_body_m_s2 = series.values[i].tail<3>()});
  }
  return readings;
}

py::array_t<std::int64_t> imu_stamps(const SensorReadings& readings) {
  std::vector<Timestamp> stamps;
  for (const InertialReading& reading : readings.inertial) stamps.push_back(reading.stamp);
  return array_of(stamps);
}

Eigen::Matrix<double, Eigen::Dynamic, kImuColumns, Eigen::RowMajor> imu_rows(
    const SensorReadings& readings) {
  Eigen::Matrix<double, Eigen::Dynamic, kImuColumns, Eigen::RowMajor> rows(readings.inertial.size(),
                                                                           kImuColumns);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const InertialReading& reading = readings.inertial[static_cast<std::size_t>(i)];
    rows.row(i) << reading.angular_rate_in_body_rad_s.transpose(),
        reading.specific_force_in_body_m_s2.transpose();
  }
  return rows;
}

SensorLog make_log(const std::optional<py::array>& imu_stamps_ns, const std::optional<Table>& imu,
                   const std::optional<py::array>& height_stamps_ns,
                   const std::optional<Table>& height_m, ScaleSource height_source) {
  if (height_stamps_ns.has_value() != height_m.has_value()) {
    throw InputError("height_stamps_ns and height_m: pass both, or none of them");
  }
  SensorLog log;
  log.imu = imu_series(imu_stamps_ns, imu);
  log.height_source = height_source;
  if (height_m) {
    log.height_m.stamps = stamps_of(*height_stamps_ns, "height_stamps_ns");
    require_shape(*height_m, "height_m", static_cast<py::ssize_t>(log.height_m.stamps.size()), 0);
    log.height_m.values.assign(height_m->data(), height_m->data() + height_m->size());
    log.height_m.max_gap_s = max_gap_s(log.height_m.stamps);
  }
  return log;
}

void bind_initial_state(py::module_& m) {
  py::class_<InitialState>(m, "InitialState", "Body pose at the first image.")
      .def(
          py::init([](const RigidTransform& world_from_body, ScaleSource scale) {
            return InitialState{.world_from_body = world_from_body, .scale = scale};
          }),
          py::arg("world_from_body"), py::arg("scale") = ScaleSource::none,
          "world_from_body: z is the height above the ground, positive; 1 if unknown.\n"
          "scale: source of that height, initial_height if z is in metres; none: estimates are in\n"
          "initial heights and have no metric part.")
      .def_static(
          "at_height",
          [](double height_m) {
            return InitialState{.world_from_body = {.translation = {0, 0, height_m}},
                                .scale = ScaleSource::initial_height};
          },
          py::arg("height_m"), "Level body at a measured height above the ground, m.")
      .def_readonly("world_from_body", &InitialState::world_from_body, "Body pose in the world.")
      .def_readonly("scale", &InitialState::scale, "Source of the height.");
}

void bind_readings(py::module_& m) {
  py::class_<SensorReadings>(
      m, "SensorReadings",
      "Readings of other sensors for the interval that ends at an image; each is optional.")
      .def(py::init(&make_readings), py::kw_only(),
           py::arg("mean_angular_rate_in_body_rad_s") = py::none(),
           py::arg("height_m") = py::none(), py::arg("height_source") = ScaleSource::range,
           py::arg("attitude_wxyz") = py::none(), py::arg("acceleration") = py::none(),
           py::arg("imu_stamps_ns") = py::none(), py::arg("imu") = py::none(),
           "imu: rows (angular rate, rad/s; specific force, m/s^2), (N, 6), in the body, each "
           "valid\n"
           "from the previous stamp to its own; policy fused only.\n"
           "height_m: above the ground; for height_source range the distance along the body's -z.\n"
           "acceleration: (linear, world, m/s^2; angular, body, rad/s^2), (6,); mode paper only.")
      .def_readonly("mean_angular_rate_in_body_rad_s",
                    &SensorReadings::mean_angular_rate_in_body_rad_s,
                    "Gyroscope, mean over the interval, (3,), rad/s, or None.")
      .def_readonly("height_m", &SensorReadings::height_m, "Height, m, or None.")
      .def_readonly("height_source", &SensorReadings::height_source, "range or barometer.")
      .def_readonly("attitude_wxyz", &SensorReadings::attitude,
                    "World from body, quaternion (w, x, y, z), or None.")
      .def_readonly("acceleration", &SensorReadings::acceleration,
                    "Linear in the world, m/s^2, angular in the body, rad/s^2, (6,), or None.")
      .def_property_readonly("imu_stamps_ns", &imu_stamps, "Stamps of the IMU readings, (N,), ns.")
      .def_property_readonly(
          "imu", &imu_rows, "Angular rate, rad/s, and specific force, m/s^2, in the body, (N, 6).");
}

}  // namespace

void bind_sensors(py::module_& m) {
  bind_initial_state(m);
  bind_readings(m);
  py::class_<SensorLog>(m, "SensorLog", "Readings of a whole flight, on the clock of the images.")
      .def(py::init(&make_log), py::kw_only(), py::arg("imu_stamps_ns") = py::none(),
           py::arg("imu") = py::none(), py::arg("height_stamps_ns") = py::none(),
           py::arg("height_m") = py::none(), py::arg("height_source") = ScaleSource::range,
           "imu: rows (angular rate, rad/s; specific force, m/s^2), (N, 6), in the body.\n"
           "height_m: (N,), above the ground; for height_source range along the body's -z.")
      .def("between", &readings_between, py::arg("before_ns"), py::arg("now_ns"),
           "Readings for the image at now_ns whose previous one is at before_ns: IMU clipped to "
           "the\n"
           "interval, height interpolated at now_ns; none in the gaps of a log.");
}

}  // namespace stillkite::python
