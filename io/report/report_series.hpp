#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "io/report/decimation.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Named columns, NaN if absent. Names end in the unit.
using ReportSeries = DecimatedTable::Columns;

/// Interval of frames with the same verdict, in seconds from the first frame.
struct VerdictInterval {
  Verdict verdict;
  double start_s;
  double end_s;
};

/// True state at a frame; unknown parts are empty.
struct TrueState {
  std::optional<Eigen::Vector3d> position_m;
  std::optional<Eigen::Quaterniond> world_from_body;
  std::optional<Eigen::Vector3d> velocity_in_world_m_s;  ///< else differenced true positions
};

/// Time series of a run for its reports.
struct FlightCharts {
  ReportSeries columns;  ///< per frame, or minimum and maximum per block of frames
  ReportSeries norms;    ///< speeds and error magnitudes, as `columns`
  ReportSeries path;     ///< time and horizontal position, per frame or block
  std::vector<VerdictInterval> verdicts;
  std::size_t frames = 0;
  bool has_truth = false;
  bool is_metric = false;  ///< false: lengths are in initial heights
};

/// Records the charts of a run frame by frame, in bounded memory: time from the first frame, pose,
/// velocity in the world, their standard deviations, flow quality and stage times; with truth also
/// truth and errors (estimate - truth). Angles are unwrapped.
class ChartRecorder {
 public:
  explicit ChartRecorder(bool has_truth = false, const RigidTransform& body_from_camera = {});

  void add(const NavigationEstimate& estimate, const TrueState& truth = {});
  [[nodiscard]] FlightCharts charts() const;

 private:
  void add_state(const NavigationEstimate& estimate);
  void add_truth(const NavigationEstimate& estimate, const TrueState& truth);
  void add_quality(const NavigationEstimate& estimate);
  void add_vector(const char* name, const char* unit, const Eigen::Vector3d& value);
  void add_angles(const char* name, const Eigen::Vector3d& degrees);
  [[nodiscard]] Eigen::Vector3d true_velocity(Timestamp stamp, const TrueState& truth) const;

  bool has_truth_;
  RigidTransform body_from_camera_;
  DecimatedTable columns_, norms_;
  std::vector<VerdictInterval> verdicts_;
  std::optional<Timestamp> first_stamp_;
  Timestamp previous_stamp_;
  std::optional<Eigen::Vector3d> previous_true_position_m_;
  Eigen::Vector3d angles_deg_;
  ScaleSource scale_ = ScaleSource::none;
};

/// Intervals as JSON: [[verdict, start_s, end_s], ...].
[[nodiscard]] nlohmann::json verdict_intervals_json(const FlightCharts& charts);

}  // namespace stillkite
