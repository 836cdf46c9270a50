#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/hover_views.hpp"
#include "bench/opencv_hold.hpp"
#include "flow/pyramid.hpp"
#include "navigation/hover_pilot.hpp"

namespace stillkite::bench {

/// What every contestant is handed of one instant of a hover.
struct HoverInstant {
  std::int64_t index = 0;
  View view;
  TetheredReadings tethered;  ///< without the IMU
  SensorReadings imu;
  RigidTransform reference_from_camera;  ///< the truth
};

/// 0 of none.
[[nodiscard]] double median_of(std::vector<double> values);

/// One way to a command, with what was measured of it.
struct ContestantRow {
  std::string name;
  std::map<std::string, std::vector<double>>
      ms;  ///< a stage; "cycle" the whole of a frame, "start" of one before those
  std::vector<double> rotation_deg, direction_deg, features;
  int answers = 0, frames = 0;

  void judge(const MotionEstimate& motion, int found, const RigidTransform& truth);
  [[nodiscard]] double median_ms(const std::string& stage) const;
};

/// The hold paper's steps in OpenCV calls.
class OpenCvContestant {
 public:
  /// `method`: of findEssentialMat.
  OpenCvContestant(const std::string& name, int method);

  void run(const cv::Mat& reference, const HoverInstant& instant);
  [[nodiscard]] const ContestantRow& row() const { return row_; }

 private:
  ContestantRow row_;
  OpenCvHold hold_;
  HoldController controller_;
};

/// What ours is set to; only the fusion reads the IMU.
struct PilotSetup {
  ReferenceConfig reference{};
  Policy policy = Policy::reference;
  double height_m = 2;
};

/// Ours, flying on from frame to frame.
class WarmPilot {
 public:
  WarmPilot(const std::string& name, const PilotSetup& setup) : row_{.name = name}, setup_(setup) {}

  void start(const cv::Mat& reference, double height_m);
  /// A frame of the start, which is none of the cycle's.
  void settle(const HoverInstant& instant);
  void run(const HoverInstant& instant);
  [[nodiscard]] const ContestantRow& row() const { return row_; }

 private:
  PilotStep step(const HoverInstant& instant);

  ContestantRow row_;
  PilotSetup setup_;
  std::optional<HoverPilot> pilot_;
  Pyramid pyramid_;
};

/// Ours, anew in every frame.
class ColdPilot {
 public:
  ColdPilot(const std::string& name, const PilotSetup& setup) : row_{.name = name}, setup_(setup) {}

  void run(const cv::Mat& reference, const HoverInstant& instant);
  [[nodiscard]] const ContestantRow& row() const { return row_; }

 private:
  ContestantRow row_;
  PilotSetup setup_;
};

}  // namespace stillkite::bench
