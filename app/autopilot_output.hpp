#pragma once

#include <optional>

#include "live/link/autopilot_link.hpp"
#include "live/live_config.hpp"
#include "live/mavlink/verdict_monitor.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Sends the configured messages of each estimate to the autopilot.
class AutopilotOutput {
 public:
  /// `max_gap_s`: gap without a measurement after which reset_counter counts.
  AutopilotOutput(AutopilotLink& link, const MavlinkOutputConfig& config, double max_gap_s)
      : link_(link), config_(config), resets_(max_gap_s) {}

  /// Only texts are sent without a source of scale, and for a frame that is not measured.
  void send(const NavigationEstimate& estimate, const RigidTransform& body_from_camera,
            double focal_length_px);

  /// Text for the operator if images have been missing for a second.
  void report_missing_images(double silence_s);

 private:
  AutopilotLink& link_;
  MavlinkOutputConfig config_;
  mavlink::ResetCounter resets_;
  mavlink::VerdictMonitor verdicts_;
  std::optional<Timestamp> last_;
};

}  // namespace stillkite
