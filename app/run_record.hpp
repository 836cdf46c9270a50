#pragma once

#include <vector>

#include "evaluation/evaluation.hpp"
#include "evaluation/reference_error.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/dataset/gyro_check.hpp"
#include "io/report/report_series.hpp"
#include "io/results/run_summary.hpp"

namespace stillkite {

/// Values of the frames that summary, report and warnings need after a run.
struct RunRecord {
  explicit RunRecord(const FlightInputs& inputs)
      : charts(!inputs.truth.poses.empty() || !inputs.truth.velocities.empty(),
               inputs.body_from_camera) {}

  void add(const NavigationEstimate& estimate, const FlightInputs& inputs);

  RunTally tally;
  ChartRecorder charts;
  std::vector<EvaluatedMotion> motions;  ///< empty without truth
  ReferenceErrors reference_errors;
  std::vector<ObservedRotation> rotations;  ///< by images alone; empty without gyroscope
};

}  // namespace stillkite
