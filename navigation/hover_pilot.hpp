#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "navigation/navigator.hpp"
#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

struct InertialFinding;
struct PilotStep;

/// Sensor inputs of a tethered drone for one image.
struct TetheredReadings {
  Timestamp now;                        ///< time of the command, not before the exposure
  std::optional<TetherReading> tether;  ///< latest reading
  /// Attitude at the exposure (IMU, yaw zeroed at take-off); empty: `sensors.attitude`, else
  /// integrated from the images, initial yaw 0.
  std::optional<Eigen::Quaterniond> station_from_body;
  SensorReadings sensors;  ///< readings for the navigator
  /// Reason of operator or ground station to withhold the command.
  HoldReason withheld = HoldReason::none;
  /// Hold the pose of this image from now on, instead of the reference pose. Without effect unless
  /// its displacement is measured and metric, and in mode paper.
  bool hold_here = false;
};

/// Estimate and command of one image.
struct HoldStep {
  Estimate estimate;
  HoldDecision decision;
};

/// Position hold of a tethered drone: estimates the displacement from the reference pose and
/// computes the tether command that corrects it (docs/hold_control.md).
class HoverPilot {
 public:
  /// `body_from_camera`: mount of the gimbal, which keeps pitch and roll. `valid_pixels`: as for
  /// Navigator. Throws InputError as Navigator and HoldController do.
  HoverPilot(const Camera& camera, const RigidTransform& body_from_camera,
             const NavigatorConfig& navigator, const EstimatorConfig& estimator,
             const HoldConfig& hold, const InitialState& initial,
             const std::optional<ImageView>& valid_pixels = {});
  ~HoverPilot();
  HoverPilot(HoverPilot&&) noexcept;
  HoverPilot& operator=(HoverPilot&&) noexcept;

  /// Estimate and command from an image; pixels, stamp and errors as for Navigator::step.
  HoldStep step(const ImageView& image, Timestamp stamp, const TetheredReadings& readings,
                double stamp_sigma_s = 0);

  /// Internal, for the program `stillkite`: as Navigator::step(Frame); the pixels are shared.
  PilotStep step(const Frame& frame, const TetheredReadings& readings);

  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;
  [[nodiscard]] std::vector<InertialFinding> inertial_findings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
