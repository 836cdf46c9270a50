#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/overlay_video.hpp"
#include "app/run_record.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/results/run_recorder.hpp"
#include "io/video/frame_source.hpp"
#include "navigation/hover_pilot.hpp"
#include "navigation/inertial_finding.hpp"

namespace stillkite {

/// Run of one estimator over a recording: steps it on each frame, measures its time and writes its
/// rows.
class EstimatorRun {
 public:
  /// Throws InputError on an invalid configuration. Writes nothing.
  EstimatorRun(RunConfig config, const Frame& first);

  /// Creates the folder and opens the files. Throws InputError as prepare_output_folder.
  void write_to(const std::filesystem::path& folder, std::optional<std::int64_t> expected_frames);

  /// Precondition: write_to. Throws if the disk is full or the frame size changes.
  void step(const Frame& frame);

  /// Flushes all files under temporary names. Throws as step does; earlier rows can still be
  /// committed.
  void finish();

  /// Renames the files to their final names.
  void commit();

  /// With the navigator's effective configuration.
  [[nodiscard]] const RunConfig& config() const { return config_; }
  [[nodiscard]] const FlightInputs& inputs() const { return inputs_; }
  /// With initial.from_truth, unless the truth has no attitude.
  [[nodiscard]] bool starts_from_true_attitude() const {
    return config_.initial.from_truth && inputs_.truth.has_attitude;
  }
  /// In a gravity-aligned world, or in the truth's if the run starts from its attitude.
  [[nodiscard]] const RunRecord& record() const { return record_; }
  /// Gravity alignment of the last estimate.
  [[nodiscard]] const std::optional<GravityAlignment>& gravity_alignment() const {
    return gravity_alignment_;
  }
  [[nodiscard]] std::span<const float> frame_ms() const { return frame_ms_; }
  [[nodiscard]] std::optional<CommandCounts> commands() const;
  /// Differences of IMU and mount from their calibration.
  [[nodiscard]] std::vector<InertialFinding> inertial_findings() const {
    return pilot_.inertial_findings();
  }

 private:
  struct Files {
    RunRecorder estimates;
    std::optional<CommandRecorder> commands;
    std::optional<OverlayVideo> overlay;
  };

  FlightInputs inputs_;
  RunConfig config_;
  HoverPilot pilot_;
  RunRecord record_;
  std::optional<Files> files_;
  std::optional<Timestamp> previous_stamp_;
  std::optional<GravityAlignment> gravity_alignment_;
  std::vector<float> frame_ms_;
};

/// Outcome of a run. The results so far are written before a failure is rethrown.
struct RunOutcome {
  std::exception_ptr failure;
  std::optional<std::string> problem;  ///< message of the failure or of the source
};

/// Steps all estimators on each frame until the end, a failure or Ctrl-C. Their order rotates from
/// frame to frame, since later ones find the image in the cache.
[[nodiscard]] RunOutcome step_through(FrameSource& source, std::span<EstimatorRun> runs,
                                      const std::string& label);

/// Flushes all files before any is renamed over an earlier result. Stores the first failure in
/// `outcome`.
void finish_files(std::span<EstimatorRun> runs, RunOutcome& outcome);

/// Throws InputError if navigator.readout_s is set but image rows are not sensor rows.
void check_row_times(const FrameSource& source, const RunConfig& config);

}  // namespace stillkite
