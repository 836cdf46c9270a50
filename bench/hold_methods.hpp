#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/hover_views.hpp"
#include "bench/opencv_hold.hpp"
#include "flow/pyramid.hpp"
#include "navigation/hover_pilot.hpp"
#include "navigation/pilot_step.hpp"
#include "stabilization/hold_controller.hpp"

namespace stillkite::bench {

/// Input of every method at one instant of a hover.
struct HoverInstant {
  std::int64_t index = 0;
  View view;
  TetheredReadings tethered;  ///< without the IMU
  SensorReadings imu;
  RigidTransform reference_from_camera;  ///< truth
};

/// Median; 0 for an empty sample.
[[nodiscard]] double median_of(std::vector<double> values);

/// Results of one method.
struct MethodRow {
  std::string name;
  /// CPU time by stage; "cycle": whole frame, "start": frame of the initialization.
  std::map<std::string, std::vector<double>> ms;
  std::vector<double> rotation_deg, direction_deg, features;
  int estimates = 0, frames = 0;

  /// Adds the errors of one frame.
  void add(const MotionEstimate& motion, int tracked, const RigidTransform& truth);
  [[nodiscard]] double median_ms(const std::string& stage) const;
};

/// Hold paper: OpenCV calls and controller.
class OpenCvMethod {
 public:
  /// `method`: of findEssentialMat.
  OpenCvMethod(const std::string& name, int method);

  void run(const cv::Mat& reference, const HoverInstant& instant);
  [[nodiscard]] const MethodRow& row() const { return row_; }

 private:
  MethodRow row_;
  OpenCvHold hold_;
  HoldController controller_;
};

/// Configuration of Stillkite's pilot; only `Policy::fused` uses the IMU.
struct PilotSetup {
  ReferenceConfig reference{};
  Policy policy = Policy::reference;
  double height_m = 2;
};

/// Stillkite, warm: state kept from frame to frame.
class WarmPilot {
 public:
  WarmPilot(const std::string& name, const PilotSetup& setup) : row_{.name = name}, setup_(setup) {}

  void start(const cv::Mat& reference, double height_m);
  /// Frame of the initialization, excluded from the cycle times.
  void warm_up(const HoverInstant& instant);
  void run(const HoverInstant& instant);
  [[nodiscard]] const MethodRow& row() const { return row_; }

 private:
  PilotStep step(const HoverInstant& instant);

  MethodRow row_;
  PilotSetup setup_;
  std::optional<HoverPilot> pilot_;
  Pyramid pyramid_;
};

/// Stillkite, cold: new pilot for every frame.
class ColdPilot {
 public:
  ColdPilot(const std::string& name, const PilotSetup& setup) : row_{.name = name}, setup_(setup) {}

  void run(const cv::Mat& reference, const HoverInstant& instant);
  [[nodiscard]] const MethodRow& row() const { return row_; }

 private:
  MethodRow row_;
  PilotSetup setup_;
};

}  // namespace stillkite::bench
