#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/overlay_video.hpp"
#include "io/flight_inputs.hpp"
#include "io/frame_source.hpp"
#include "io/run_recorder.hpp"
#include "io/run_summary.hpp"
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

  /// The files get their names.
  void commit();

  [[nodiscard]] const RunConfig& config() const { return config_; }
  [[nodiscard]] const FlightInputs& inputs() const { return inputs_; }
  [[nodiscard]] const std::vector<NavigationEstimate>& estimates() const;
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
  std::filesystem::path folder_;
  std::optional<Files> files_;
  std::optional<Timestamp> before_;
  std::vector<float> frame_ms_;
};

/// Steps all of them on each frame until the end or Ctrl-C. Their order turns with the frames: who
/// comes later finds the picture in the cache already. Gives the message of what ended it early, so
/// that what was estimated is written first.
[[nodiscard]] std::exception_ptr step_through(FrameSource& source, std::span<EstimatorRun> runs,
                                              const std::string& label);

/// What was wrong, in words.
[[nodiscard]] std::string message_of(const std::exception_ptr& failure);

/// One line where an estimator's lengths are no metres.
void tell_of_missing_scale(const FlightInputs& inputs);

/// One line for each sensor's log, and for a truth, that says nothing of much of the flight.
void tell_of_what_does_not_cover(const EstimatorRun& run);

}  // namespace stillkite
