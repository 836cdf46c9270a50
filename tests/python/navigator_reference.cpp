// Estimates and times of the navigator in C++, for the tests and the benchmark of the Python
// module. Usage: navigator_reference FLIGHT.yaml POLICY. Each line of standard input is one flight
// through all rendered images: `estimates` prints them, `times` the processor time of each, ns.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "io/config/config_binding.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/sensor_log.hpp"
#include "navigation/navigator.hpp"
#include "simulation/flight/simulate.hpp"

using namespace stillkite;

namespace {

SensorLog sensor_log(const FlightRecord& record) {
  SensorLog log;
  for (const ImuReading& reading : record.imu) {
    log.imu.stamps.push_back(reading.stamp);
    log.imu.values.emplace_back();
    log.imu.values.back() << reading.angular_rate_in_body_rad_s,
        reading.specific_force_in_body_m_s2;
  }
  log.imu.max_gap_s = max_gap_s(log.imu.stamps);
  for (const RangeReading& reading : record.range) {
    log.height_m.stamps.push_back(reading.stamp);
    log.height_m.values.push_back(reading.range_m);
  }
  log.height_m.max_gap_s = max_gap_s(log.height_m.stamps);
  return log;
}

struct Flight {
  FlightRecord record;
  std::vector<cv::Mat> images{};
  std::vector<Timestamp> stamps{};
  std::vector<SensorReadings> readings{};
};

Flight render(const std::string& file) {
  const auto config = bind_config<SimulationConfig>(read_config(file, {}));
  Flight flight{.record = record_flight(config)};
  const SensorLog log = sensor_log(flight.record);
  render_flight(config, {}, [&](const Frame& frame) {
    const Timestamp before = flight.stamps.empty() ? frame.stamp : flight.stamps.back();
    flight.images.push_back(frame.grey);
    flight.stamps.push_back(frame.stamp);
    flight.readings.push_back(readings_between(log, before, frame.stamp));
  });
  return flight;
}

Navigator make_navigator(const Flight& flight, const std::string& policy) {
  const RunConfig config = load_run_config(std::nullopt, {"estimator.policy=" + policy});
  return {flight.record.camera,
          flight.record.body_from_camera,
          config.navigator,
          {flight.record.truth.front().state.world_from_body, ScaleSource::initial_height},
          config.estimator};
}

Estimate step(Navigator& navigator, const Flight& flight, std::size_t i) {
  const cv::Mat& grey = flight.images[i];
  return navigator.step({grey.data, grey.cols, grey.rows, static_cast<std::ptrdiff_t>(grey.step)},
                        flight.stamps[i], flight.readings[i]);
}

// Rows of a matrix, exact.
template <typename Derived>
void print(const std::string& name, const Eigen::DenseBase<Derived>& values) {
  fmt::print(" {}=", name);
  for (const auto& row : values.derived().rowwise()) {
    for (const double value : row) fmt::print("{:a},", value);
  }
}

void print(const std::string& name, const Eigen::Quaterniond& q) {
  print(name, Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
}

void print(const Estimate& e) {
  fmt::print("{} {} {}", e.stamp.ns, name_of(e.verdict), name_of(e.source));
  print("world_from_body_wxyz", e.world_from_body);
  print("attitude_covariance_rad2", e.attitude_covariance_rad2);
  print("angular_rate_in_camera_rad_s", e.angular_rate_in_camera_rad_s);
  print("angular_rate_covariance_rad2_s2", e.angular_rate_covariance_rad2_s2);
  if (e.metric) {
    print("metric.position_in_world_m", e.metric->position_in_world_m);
    print("metric.position_covariance_m2", e.metric->position_covariance_m2);
    print("metric.velocity_in_world_m_s", e.metric->velocity_in_world_m_s);
    print("metric.velocity_in_camera_m_s", e.metric->velocity_in_camera_m_s);
    print("metric.velocity_covariance_m2_s2", e.metric->velocity_covariance_m2_s2);
  }
  if (e.relative) {
    print("relative.position_in_world_heights", e.relative->position_in_world_heights);
    print("relative.velocity_in_world_heights_s", e.relative->velocity_in_world_heights_s);
  }
  if (e.reference) {
    print("reference.reference_from_camera_wxyz", e.reference->reference_from_camera);
    print("reference.rotation_covariance_rad2", e.reference->rotation_covariance_rad2);
    print("reference.displacement_covariance", e.reference->displacement_covariance);
  }
  fmt::print("\n");
}

long long processor_ns() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

void print_times(const Flight& flight, const std::string& policy) {
  Navigator navigator = make_navigator(flight, policy);
  for (std::size_t i = 0; i < flight.images.size(); ++i) {
    const long long start_ns = processor_ns();
    step(navigator, flight, i);
    fmt::print("{} ", processor_ns() - start_ns);
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: navigator_reference FLIGHT.yaml POLICY\n", stderr), 2;
  const Flight flight = render(argv[1]);
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "times") {
      print_times(flight, argv[2]);
    } else {
      Navigator navigator = make_navigator(flight, argv[2]);
      for (std::size_t i = 0; i < flight.images.size(); ++i) print(step(navigator, flight, i));
    }
    std::fflush(stdout);
  }
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "navigator_reference: %s\n", error.what()), 1;
}
