#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/overlay_video.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/results/run_recorder.hpp"
#include "io/results/run_summary.hpp"
#include "io/video/frame_source.hpp"
#include "navigation/hover_pilot.hpp"

namespace stillkite {

/// One estimator's way through a recording: it steps on each frame, is timed, and its rows are
/// written as they come.
class EstimatorRun {
 public:
  /// Throws InputError where the configuration cannot work. Nothing is written yet.
  EstimatorRun(RunConfig config, const Frame& first);

  /// Makes the folder and opens the files of a run. Throws InputError as prepare_output_folder.
  void write_to(const std::filesystem::path& folder, std::optional<std::int64_t> expected_frames);

  /// After write_to. What step throws is a full disk, or a frame of another size.
  void step(const Frame& frame);

  /// All files are on the disk, and only their names are missing. Throws as step does; what was
  /// written before can still be committed.
  void finish();

  /// The files get their names.
  void commit();

  [[nodiscard]] const RunConfig& config() const { return config_; }
  [[nodiscard]] const FlightInputs& inputs() const { return inputs_; }
  /// In a world whose z is up, or the truth's where they start from the truth.
  [[nodiscard]] const std::vector<NavigationEstimate>& estimates() const;
  /// What the last one had found to be upright.
  [[nodiscard]] const std::optional<GravityAlignment>& upright() const { return upright_; }
  [[nodiscard]] std::span<const float> frame_ms() const { return frame_ms_; }
  [[nodiscard]] std::optional<CommandCounts> commands() const;

 private:
  struct Files {
    RunRecorder estimates;
    std::optional<CommandRecorder> commands;
    std::optional<OverlayVideo> overlay;
  };

  RunConfig config_;
  FlightInputs inputs_;
  HoverPilot pilot_;
  std::optional<Files> files_;
  std::optional<Timestamp> before_;
  std::optional<GravityAlignment> upright_;
  std::vector<float> frame_ms_;
};

/// How a recording ended; what was estimated is written before a failure is thrown on.
struct Ending {
  std::exception_ptr failure;
  std::optional<std::string> complaint;  ///< what was wrong with it or with the images, in words
};

/// Steps all of them on each frame until the end, a failure or Ctrl-C. Their order turns with the
/// frames: who comes later finds the image in the cache already.
[[nodiscard]] Ending step_through(FrameSource& source, std::span<EstimatorRun> runs,
                                  const std::string& label);

/// Before any of the files gets its name, and takes the place of an earlier call's, all of them are
/// on the disk; what fails is noted in the ending.
void finish_files(std::span<EstimatorRun> runs, Ending& ending);

/// Throws InputError where rows are told their times, but are not the sensor's rows.
void check_row_times(const FrameSource& source, const RunConfig& config);

/// A line where an estimator's lengths are no metres, where the camera sees no ground at the start,
/// where IMU readings are left out, and where a log is read that the estimator does not use; of
/// several estimators each line once.
void tell_of_doubtful_inputs(std::span<const EstimatorRun> runs);

/// One line where the images contradict the gyroscope, or else where the flight has shown that
/// the start's attitude was not as it was given.
void tell_of_contradictions(const EstimatorRun& run);

/// A line of what was wrong, of each sensor's log, and of a truth, that says nothing of much of the
/// flight, of what was fixed to the camera unmasked, and of where the results of a recording lie
/// that did not come to its end.
void tell_of_ending(const Ending& ending, std::span<const EstimatorRun> runs,
                    const std::filesystem::path& out);

}  // namespace stillkite
