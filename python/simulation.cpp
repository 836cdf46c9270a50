#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/config/config_binding.hpp"
#include "io/config/config_printing.hpp"
#include "io/dataset/sensor_log.hpp"
#include "navigation/sensor_readings.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"
#include "python/configuration.hpp"
#include "python/trajectory.hpp"
#include "simulation/flight/simulate.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

// Keys of `stillkite simulate`, whose section output names files.
struct FlightDocument {
  SimulationConfig simulation{};
  ConfigNode output{};

  static void fields(auto& self, auto&& field) {
    SimulationConfig::fields(self.simulation, field);
    field("output", self.output, "output files of the command; ignored");
  }
};

struct SimulatedFlight {
  SimulatedFlight(const SimulationConfig& keys, const cv::Mat& texture)
      : config(keys), record(record_flight(keys)), images(keys, texture) {}

  SimulationConfig config;
  FlightRecord record;
  FlightImages images;
};

cv::Mat photograph_of(const SimulationConfig& config, const std::optional<py::array>& photograph) {
  if (config.ground.photograph && !photograph) {
    throw InputError("ground.photograph: " + config.ground.photograph->string() +
                     "; pass its grey levels as photograph instead");
  }
  if (!photograph) return {};
  const ImageView view = image_view(*photograph, "photograph");
  cv::Mat pixels(view.height, view.width, CV_8UC1);
  for (int row = 0; row < view.height; ++row) {
    std::copy_n(view.data + row * view.stride, view.width, pixels.ptr(row));
  }
  return pixels;
}

std::unique_ptr<SimulatedFlight> make_flight(const py::object& source,
                                             const std::vector<std::string>& overrides,
                                             const std::optional<py::array>& photograph) {
  const SimulationConfig config =
      bind_config<FlightDocument>(document_of(source, overrides)).simulation;
  return std::make_unique<SimulatedFlight>(config, photograph_of(config, photograph));
}

py::array image(const SimulatedFlight& flight, py::ssize_t index) {
  const std::int64_t count = flight.images.count();
  if (index < 0) index += count;
  if (index < 0 || index >= count) {
    throw py::index_error(fmt::format("image {} of {}", index, count));
  }
  const cv::Mat grey = [&] {
    const py::gil_scoped_release released;
    return flight.images.render(index).grey;
  }();
  return array_of(grey);
}

PoseSeries truth(const SimulatedFlight& flight) {
  PoseSeries series;
  for (const StampedState& state : flight.record.truth) {
    series.poses.push_back({state.stamp, state.state.world_from_body});
  }
  return series;
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> velocities(
    const SimulatedFlight& flight) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> rows(flight.record.truth.size(), 3);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows.row(i) = flight.record.truth[static_cast<std::size_t>(i)].state.velocity_in_world_m_s;
  }
  return rows;
}

SensorLog sensors(const SimulatedFlight& flight, bool imu, bool range) {
  SensorLog log;
  if (imu) {
    for (const ImuReading& reading : flight.record.imu) {
      Vector6d value;
      value << reading.angular_rate_in_body_rad_s, reading.specific_force_in_body_m_s2;
      log.imu.stamps.push_back(reading.stamp);
      log.imu.values.push_back(value);
    }
    log.imu.max_gap_s = max_gap_s(log.imu.stamps);
  }
  if (range) {
    for (const RangeReading& reading : flight.record.range) {
      log.height_m.stamps.push_back(reading.stamp);
      log.height_m.values.push_back(reading.range_m);
    }
    log.height_m.max_gap_s = max_gap_s(log.height_m.stamps);
  }
  return log;
}

}  // namespace

void bind_simulation(py::module_& m) {
  py::class_<SimulatedFlight>(m, "SimulatedFlight",
                              "Rendered images and sensor readings of a flight, with ground truth.")
      .def(py::init(&make_flight), py::arg("source") = py::none(),
           py::arg("overrides") = std::vector<std::string>(), py::kw_only(),
           py::arg("photograph") = py::none(),
           "source, overrides: as for Config, keys of `stillkite simulate --print`. photograph:\n"
           "ground from above, grey levels (height, width), uint8; None: procedural.")
      .def("__len__", [](const SimulatedFlight& flight) { return flight.images.count(); })
      .def("image", &image, py::arg("index"),
           "Renders an image: grey levels (height, width), uint8. The same index gives the same\n"
           "image. Other threads run during the call.")
      .def("sensors", &sensors, py::kw_only(), py::arg("imu") = true, py::arg("range") = true,
           "Readings of the IMU and of the range finder.")
      .def_property_readonly(
          "stamps_ns",
          [](const SimulatedFlight& flight) { return array_of(flight.images.stamps()); },
          "Stamps of the images, (N,), ns, with the errors of the section clock.")
      .def_property_readonly(
          "camera", [](const SimulatedFlight& flight) { return flight.record.camera; },
          "Calibrated camera.")
      .def_property_readonly(
          "body_from_camera",
          [](const SimulatedFlight& flight) { return flight.record.body_from_camera; },
          "Mount of the camera.")
      .def_property_readonly(
          "initial",
          [](const SimulatedFlight& flight) {
            return InitialState{
                .world_from_body = flight.record.truth.front().state.world_from_body,
                .scale = ScaleSource::initial_height};
          },
          "True pose at the first image, height in metres.")
      .def_property_readonly("truth", &truth, "True poses at the images.")
      .def_property_readonly("velocities_in_world_m_s", &velocities,
                             "True velocities of the body in the world, (N, 3), m/s.")
      .def("__str__", [](const SimulatedFlight& flight) { return print_config(flight.config); });
}

}  // namespace stillkite::python
