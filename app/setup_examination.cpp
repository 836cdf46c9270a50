#include "app/setup_examination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "geometry/gravity.hpp"
#include "geometry/median.hpp"
#include "io/dataset/flight_camera.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/dataset/flight_sensors.hpp"
#include "io/dataset/initial_state.hpp"
#include "io/dataset/mask_file.hpp"
#include "io/dataset/sensor_checks.hpp"
#include "io/setup/camera_findings.hpp"
#include "io/setup/height_findings.hpp"
#include "io/setup/image_findings.hpp"
#include "io/setup/imu_findings.hpp"
#include "io/setup/rotation_findings.hpp"
#include "io/setup/scene_findings.hpp"
#include "io/video/frame_source.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"

namespace stillkite {
namespace {

constexpr double kMaxDuration_s = 30;
constexpr std::int64_t kMaxFrames = 900;
constexpr double kMinFlat = 0.8;  // ratio of frames that the flow measures, for its scale

/// What the images alone have measured.
struct ImageMotion {
  ImageStatistics statistics;
  std::vector<ImageGradients> gradients;
  FrameStamps stamps;
  std::vector<double> displacements_px;
  std::vector<FlowMotion> flow;
  std::vector<ObservedRotation> rotations;  // in body axes
  VerdictCounts flow_verdicts, reference_verdicts;
  ExpectedAccuracy accuracy;
  std::vector<double> velocity_sigmas;
};

class SetupExamination {
 public:
  explicit SetupExamination(const RunConfig& config) : config_(config) {}

  SetupReport run() {
    std::optional<FrameSource> source;
    if (!attempt("images", [&] { source.emplace(config_.source); })) return std::move(report_);
    first_ = source->first().stamp;
    examine_camera(source->first().grey.size());
    read_logs();
    step_through(*source);
    if (const auto problem = source->problem()) {
      add({.question = "images",
           .verdict = source->rejected() > 0 ? SetupVerdict::doubtful : SetupVerdict::ok,
           .text = *problem});
    }
    examine_images(source->first().grey.cols);
    examine_inertial();
    examine_height();
    examine_scene();
    examine_as_run(source->first());
    return std::move(report_);
  }

 private:
  void add(SetupFinding finding) { report_.findings.push_back(std::move(finding)); }

  // False if the action throws InputError: its message is a finding.
  bool attempt(const char* question, const std::function<void()>& action) {
    try {
      action();
      return true;
    } catch (const InputError& error) {
      add({.question = question, .verdict = SetupVerdict::wrong, .text = error.what()});
      return false;
    }
  }

  void examine_camera(const cv::Size& size) {
    attempt("mask", [&] { mask_ = read_mask(config_.calibration, size); });
    dataset_ = find_euroc_dataset(config_.source.path);
    attempt("calibration", [&] {
      const NamedCalibration named = configured_calibration(config_, dataset_);
      timeshift_s_ = named.calibration.timeshift_cam_imu_s;
      add(resolution_finding(named.calibration.camera, size.width, size.height));
      const std::optional<Camera> camera =
          scaled_to(named.calibration.camera, size.width, size.height);
      if (!camera) return;
      add(lens_finding(*camera, mask_.get(), named.origin));
      if (report_.findings.back().verdict == SetupVerdict::ok) camera_ = camera;
      body_from_camera_ = mount_of(config_.mount, named.calibration);
      if (const auto note = replaced_mount_note(config_.mount, named.calibration)) {
        add({.question = "mount of the calibration",
             .verdict = SetupVerdict::doubtful,
             .text = *note});
      }
    });
  }

  // Resets the sections of the configuration whose logs are invalid.
  void read_logs() {
    if (!attempt("truth", [&] { truth_ = read_ground_truth(config_.truth, dataset_); })) {
      config_.truth = {};
      config_.initial.from_truth = false;
    }
    const auto read = [&](const RunConfig& config) {
      sensors_ = read_sensors(config, timeshift_s_);
    };
    try {
      read(config_);
    } catch (const InputError&) {
      reset_invalid_logs();
      read(config_);
    }
    if (!attempt("initial state",
                 [&] { initial_ = initial_state(config_, truth_, sensors_, first_); })) {
      initial_.world_from_body.translation.z() = 1;
    }
  }

  void reset_invalid_logs() {
    RunConfig without = config_;
    without.gyro = {};
    without.imu = {};
    without.attitude = {};
    without.acceleration = {};
    without.height = {};
    const auto read_alone = [&](const char* name, auto member) {
      RunConfig alone = without;
      alone.*member = config_.*member;
      if (!attempt(name, [&] { static_cast<void>(read_sensors(alone, timeshift_s_)); })) {
        config_.*member = {};
      }
    };
    if (config_.gyro.path && config_.imu.path) {
      add({.question = "gyro log",
           .verdict = SetupVerdict::wrong,
           .text = "gyro.path and imu.path are both set; keep one"});
      config_.gyro = {};
    }
    read_alone("gyro log", &RunConfig::gyro);
    read_alone("imu log", &RunConfig::imu);
    read_alone("attitude log", &RunConfig::attitude);
    read_alone("acceleration log", &RunConfig::acceleration);
    read_alone("height log", &RunConfig::height);
  }

  [[nodiscard]] std::optional<Navigator> navigator(Policy policy) {
    std::optional<Navigator> out;
    if (camera_) {
      attempt("initial state", [&] {
        out.emplace(*camera_, body_from_camera_, config_.navigator, initial_,
                    EstimatorConfig{.policy = policy});
      });
    }
    return out;
  }

  void step_through(FrameSource& source) {
    std::optional<Navigator> flow = navigator(Policy::flow);
    std::optional<Navigator> reference = flow ? navigator(Policy::reference) : std::nullopt;
    const auto expected = source.expected();
    ProgressBar progress("check", std::min(expected.value_or(kMaxFrames), kMaxFrames));
    try {
      while (report_.frames < kMaxFrames) {
        if (interrupted()) throw Interrupted{};
        std::optional<Frame> frame = source.next();
        if (!frame || seconds_between(first_, frame->stamp) > kMaxDuration_s) break;
        frame->mask = mask_;
        add_images(*frame);
        if (flow) add_flow(flow->step(*frame));
        if (reference) add_reference(reference->step(*frame));
        last_ = frame->stamp;
        ++report_.frames;
        progress.step();
      }
    } catch (const InputError& error) {
      add({.question = "images", .verdict = SetupVerdict::wrong, .text = error.what()});
    }
    report_.duration_s = seconds_between(first_, last_);
  }

  void add_images(const Frame& frame) {
    constexpr int kSampledFrames = 10;  // every tenth
    if (report_.frames % kSampledFrames == 0) motion_.statistics.add(frame);
    motion_.gradients.push_back(ImageStatistics::gradients(frame));
    motion_.stamps.recorded.push_back(frame.recorded_stamp);
    motion_.stamps.filtered.push_back(frame.stamp);
  }

  void add_flow(const NavigationEstimate& estimate) {
    motion_.flow_verdicts.add(estimate.verdict);
    if (estimate.image_shift_px) {
      motion_.gradients.back().shift_px = *estimate.image_shift_px;
      motion_.displacements_px.push_back(estimate.image_shift_px->norm());
    }
    if (!is_measured(estimate.verdict)) return;
    const double sigma = std::sqrt(estimate.twist_covariance.topLeftCorner<3, 3>().trace() / 3);
    if (!motion_.flow.empty()) {
      motion_.accuracy.path_length +=
          (estimate.world_from_body.translation - motion_.flow.back().world_from_body.translation)
              .norm();
      motion_.velocity_sigmas.push_back(std::sqrt(3.0) * sigma);
    }
    motion_.accuracy.position_sigma =
        std::sqrt(estimate.pose_covariance.topLeftCorner<3, 3>().trace());
    motion_.flow.push_back({.stamp = estimate.stamp,
                            .world_from_body = estimate.world_from_body,
                            .velocity_in_world = estimate.velocity_in_world_m_s,
                            .velocity_sigma = sigma});
  }

  void add_reference(const NavigationEstimate& estimate) {
    motion_.reference_verdicts.add(estimate.verdict);
    const auto& report = estimate.reference;
    if (!report || !report->measured_rate_in_camera_rad_s || report_.frames == 0) return;
    motion_.rotations.push_back(
        {last_, estimate.stamp,
         seconds_between(last_, estimate.stamp) *
             (body_from_camera_.rotation * *report->measured_rate_in_camera_rad_s)});
  }

  void examine_images(int width_px) {
    add(sharpness_finding(motion_.statistics));
    add(exposure_finding(motion_.statistics));
    add(texture_finding(motion_.statistics));
    add(frame_rate_finding(motion_.stamps));
    add(displacement_finding(motion_.displacements_px, width_px));
    const double interval_s = report_.frames > 1 ? report_.duration_s / (report_.frames - 1) : 0;
    add(shutter_finding(motion_.gradients, interval_s));
  }

  void examine_inertial() {
    TimeSeries<Vector6d>& imu = sensors_.imu;
    if (!imu.stamps.empty()) examine_imu(imu);
    examine_log_coverage();
    TimeSeries<Eigen::Vector3d>& gyro = sensors_.angular_rate_in_body_rad_s;
    if (gyro.stamps.empty()) return;
    std::optional<UpDirection> up;
    if (!imu.stamps.empty()) up = up_direction(imu, first_, std::nullopt);
    const bool is_imu = !imu.stamps.empty();
    const AxesLogConfig& log = is_imu ? config_.imu : config_.gyro;
    const Eigen::Vector3d initial_up =
        initial_.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const RotationResult rotations = rotation_findings(
        {.gyro = gyro,
         .observed = motion_.rotations,
         .body_from_camera = body_from_camera_.rotation,
         .body_from_sensor = configured_body_from_sensor(log, is_imu ? "imu" : "gyro"),
         .time_offset_s = log.time_offset_s.value_or(-timeshift_s_.value_or(0)),
         .section = is_imu ? "imu" : "gyro",
         .measured_up_in_body = up ? std::optional(up->up_in_body) : std::nullopt,
         .initial_up_in_body = initial_up,
         .has_ground_in_view = motion_.flow_verdicts.measured_ratio() > 0.5,
         .first = first_,
         .last = last_});
    for (const SetupFinding& finding : rotations.findings) add(finding);
    is_imu_consistent_ = is_imu && rotations.is_consistent;
    if (!up) return;
    if (rotations.is_consistent) {
      if (const auto better = up_direction(imu, first_, rotations.gyro_bias_rad_s)) up = better;
    }
    up->up_in_body = rotations.body_from_configured * up->up_in_body;
    const bool by_truth = config_.initial.from_truth && truth_.has_attitude;
    add(initial_attitude_finding(*up, initial_.world_from_body.rotation,
                                 by_truth                ? "the truth"
                                 : config_.attitude.path ? "attitude.path"
                                                         : "initial.roll_deg, pitch_deg"));
  }

  // Unit and order of the columns are corrected for the questions that follow.
  void examine_imu(TimeSeries<Vector6d>& imu) {
    if (has_swapped_columns(imu)) {
      add({.question = "imu columns",
           .verdict = SetupVerdict::wrong,
           .text = "the first three columns have the magnitude of gravity, the last three do not",
           .remedy = "order the columns: wx, wy, wz, ax, ay, az"});
      imu = with_swapped_columns(imu);
      sensors_.angular_rate_in_body_rad_s.values.clear();
      for (const Vector6d& value : imu.values) {
        sensors_.angular_rate_in_body_rad_s.values.emplace_back(value.head<3>());
      }
    }
    const SetupFinding gravity = gravity_size_finding(imu);
    add(gravity);
    const auto unit = probable_force_unit(gravity.measured->value);
    if (gravity.verdict == SetupVerdict::wrong && unit) {
      for (Vector6d& value : imu.values) value.tail<3>() *= unit->factor;
    }
    const FusionConfig noise = with_imu_noise(config_.navigator.fusion, sensors_.imu_noise);
    add(imu_noise_finding(imu, {.gyro = noise.gyro_density, .accel = noise.accel_density}));
    if (const std::size_t rejected = sensors_.rejected_imu_readings; rejected > 0) {
      const double ratio =
          static_cast<double>(rejected) / static_cast<double>(rejected + imu.stamps.size());
      add({.question = "imu readings",
           .verdict = ratio > 0.01 ? SetupVerdict::doubtful : SetupVerdict::ok,
           .text = fmt::format("{} of {} rejected: zero, repeated, or outliers (bound 1 %)",
                               rejected, rejected + imu.stamps.size()),
           .measured = SetupMeasurement{ratio, {}, 0.01, "ratio"}});
    }
  }

  void examine_log_coverage() {
    SensorLog logs = sensors_;
    // without a common time: question of the clock
    const auto is_elsewhere = [&](const auto& series) {
      return !series.stamps.empty() &&
             (series.stamps.back() < first_ || series.stamps.front() > last_);
    };
    if (is_elsewhere(logs.imu)) logs.imu = {};
    if (is_elsewhere(logs.angular_rate_in_body_rad_s)) logs.angular_rate_in_body_rad_s = {};
    const std::vector<std::string> messages = coverage_warnings(logs, first_, last_);
    for (const std::string& message : messages) {
      const bool is_absent = message.find("no reading within") != std::string::npos;
      add({.question = "sensor logs",
           .verdict = is_absent ? SetupVerdict::wrong : SetupVerdict::doubtful,
           .text = message});
    }
    const auto& gyro = logs.angular_rate_in_body_rad_s;
    if (!messages.empty() || gyro.stamps.empty()) return;
    const double rate_hz = 1 / median_interval_s(gyro.stamps).value_or(HUGE_VAL);
    add({.question = "sensor logs",
         .verdict = SetupVerdict::ok,
         .text = fmt::format("cover the images without a gap, {} readings/s", std::lround(rate_hz)),
         .measured = SetupMeasurement{rate_hz, {}, 50, "1/s"}});
  }

  void examine_height() {
    const bool is_metric = initial_.scale != ScaleSource::none;
    const std::optional<double> height_m =
        is_metric ? std::optional(initial_.world_from_body.translation.z()) : std::nullopt;
    const bool is_flat = motion_.flow_verdicts.measured_ratio() >= kMinFlat;
    const std::span<const FlowMotion> flow =
        is_flat ? std::span<const FlowMotion>(motion_.flow) : std::span<const FlowMotion>();
    std::optional<BlockEstimate> scale;
    if (is_imu_consistent_) scale = inertial_scale(flow, sensors_.imu);
    if (scale) {
      add(height_finding(height_m, scale, "the accelerometer"));
    } else {
      add(height_finding(height_m, scale_of_truth(flow, truth_), "the truth's displacements"));
    }
    if (!sensors_.height_m.stamps.empty()) {
      add(height_sensor_finding(
          flow, sensors_,
          config_.initial.height_m || config_.initial.from_truth ? height_m : std::nullopt));
    }
  }

  void examine_scene() {
    if (camera_) {
      if (const auto message = no_ground_in_view(
              *camera_, initial_.world_from_body.rotation * body_from_camera_.rotation)) {
        const bool is_needed = config_.estimator.policy == Policy::flow;
        add({.question = "ground in view",
             .verdict = is_needed ? SetupVerdict::doubtful : SetupVerdict::ok,
             .text = *message});
      }
    }
    add(ground_finding(motion_.flow_verdicts));
    add(policy_finding(config_.estimator, motion_.flow_verdicts, motion_.reference_verdicts,
                       is_imu_consistent_));
    motion_.accuracy.duration_s = report_.duration_s;
    motion_.accuracy.initial_height = initial_.world_from_body.translation.z();
    motion_.accuracy.is_metric = initial_.scale != ScaleSource::none;
    if (!motion_.velocity_sigmas.empty()) {
      motion_.accuracy.velocity_sigma = upper_median(motion_.velocity_sigmas);
    }
    add(accuracy_finding(motion_.flow_verdicts, motion_.accuracy));
  }

  // What a run rejects is wrong, whatever has been found.
  void examine_as_run(const Frame& first) {
    if (worst_verdict(report_.findings) == SetupVerdict::wrong) return;
    attempt("inputs", [&] { static_cast<void>(read_flight_inputs(config_, first)); });
  }

  RunConfig config_;
  SetupReport report_;
  std::optional<EurocDataset> dataset_;
  std::shared_ptr<const ImageMask> mask_;
  std::optional<Camera> camera_;  // empty: not usable
  RigidTransform body_from_camera_;
  std::optional<double> timeshift_s_;
  GroundTruth truth_;
  SensorLog sensors_;
  InitialState initial_;
  Timestamp first_, last_;
  ImageMotion motion_;
  bool is_imu_consistent_ = false;
};

}  // namespace

SetupReport examine_setup(const RunConfig& config) {
  return SetupExamination(config).run();
}

}  // namespace stillkite
