#include "io/setup/rotation_findings.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/angle.hpp"
#include "io/setup/axes_comparison.hpp"
#include "io/setup/block_statistics.hpp"

namespace stillkite {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr int kMinIntervals = 20;  // 2 s at least, two of each block
constexpr double kMinExplained = 0.6;
constexpr double kMinFound = 0.8;  // of a search over many offsets
constexpr double kMaxTilt_rad = 20 * kDegree;

std::string rotation_yaml(const Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() *= -1;
  q.coeffs() = (q.coeffs().array().abs() < 5e-5).select(0, q.coeffs());  // no "-0.0000"
  return fmt::format("[{:.4f}, {:.4f}, {:.4f}, {:.4f}]", q.w(), q.x(), q.y(), q.z());
}

// Columns of a left-handed permutation: "x = y, y = -x, z = z".
std::string columns_of(const Matrix3d& axes) {
  constexpr std::string_view kNames = "xyz";
  std::string out;
  for (int row = 0; row < 3; ++row) {
    Eigen::Index column = 0;
    axes.row(row).cwiseAbs().maxCoeff(&column);
    out += fmt::format("{}{} = {}{}", row == 0 ? "" : ", ", kNames[static_cast<std::size_t>(row)],
                       axes(row, column) < 0 ? "-" : "", kNames[static_cast<std::size_t>(column)]);
  }
  return out;
}

std::string rotation_text(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  const auto component = [](double x) { return std::abs(x) < 0.05 ? 0.0 : x; };
  return fmt::format("{:.0f} deg about ({:.1f}, {:.1f}, {:.1f})", turn.angle() / kDegree,
                     component(turn.axis().x()), component(turn.axis().y()),
                     component(turn.axis().z()));
}

// Axis of the images about which the camera would be rotated by 180 degrees: mirrored images have
// the same rotations, diag(-1, 1, 1) of an axial vector.
std::optional<std::string_view> mirror_of(const Matrix3d& axes_in_camera) {
  constexpr double kMaxError_rad = 15 * kDegree;
  const auto is_near = [&](const Vector3d& diagonal) {
    const Matrix3d D = diagonal.asDiagonal();
    return Eigen::AngleAxisd(Matrix3d(D.transpose() * axes_in_camera)).angle() < kMaxError_rad;
  };
  if (is_near({1, -1, -1})) return "left and right";
  if (is_near({-1, 1, -1})) return "top and bottom";
  return std::nullopt;
}

class Examination {
 public:
  explicit Examination(const RotationEvidence& evidence)
      : evidence_(evidence),
        gyro_(evidence.gyro),
        intervals_(merged_rotations(evidence.observed)) {}

  RotationResult run() {
    const Timestamp log_from = gyro_.stamps.front(), log_to = gyro_.stamps.back();
    overlaps_ = log_to >= evidence_.first && log_from <= evidence_.last;
    if (std::ssize(intervals_) < kMinIntervals || image_rate_rad_s() < kMinRotationRate_rad_s) {
      report_no_rotation();
      return std::move(result_);
    }
    choose_unit();
    choose_offset();
    choose_axes();
    refine_clock();
    report_alignment();
    report_focal_length();
    result_.is_consistent =
        !pairs_.empty() && worst_verdict(result_.findings) != SetupVerdict::wrong;
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::string question(std::string_view what) const {
    return fmt::format("{} {}", evidence_.section, what);
  }

  void add(SetupFinding finding) { result_.findings.push_back(std::move(finding)); }

  [[nodiscard]] double image_rate_rad_s() const {
    double sum = 0, time_s = 0;
    for (const ObservedRotation& interval : intervals_) {
      sum += interval.rotation_in_body_rad.squaredNorm();
      time_s += seconds_between(interval.from, interval.to);
    }
    const auto count = static_cast<double>(intervals_.size());
    return std::sqrt(sum / count) * count / time_s;
  }

  void report_no_rotation() {
    const std::string reason =
        std::ssize(intervals_) < kMinIntervals
            ? fmt::format("the images measure rotation in {} intervals of {} s, {} needed",
                          intervals_.size(), kMinRotationInterval_s, kMinIntervals)
            : fmt::format("the images rotate by {:.2f} deg/s, {:g} needed; choose source.start_s",
                          image_rate_rad_s() / kDegree, kMinRotationRate_rad_s / kDegree);
    for (const char* what : {"rates", "axes"}) add({.question = question(what), .text = reason});
    add({.question = "mount", .text = reason});
    if (overlaps_) {
      add({.question = question("clock"), .text = reason});
    } else {
      report_clock(start_to_start_s(), std::nullopt);
    }
    add({.question = "focal length", .text = reason});
  }

  // Offset of the log ahead of the images if both start at the same time.
  [[nodiscard]] double start_to_start_s() const {
    return seconds_between(evidence_.first, gyro_.stamps.front());
  }

  // rad/s or deg/s, with the axes that explain most.
  void choose_unit() {
    constexpr double kMinRatio = 20, kMaxRatio = 170;  // 57.3 by a factor of 3
    const GyroIntegral integral(gyro_);
    const RotationSums sums =
        rotation_sums(integral, intervals_, overlaps_ ? 0 : start_to_start_s());
    if (sums.count < kMinIntervals) {
      add({.question = question("rates"), .text = "the log does not cover the images"});
      return;
    }
    const Matrix3d axes = best_axes(sums);
    const double ratio = sums.gyro_rate_rad_s() / sums.image_rate_rad_s();
    const bool in_degrees = ratio > kMinRatio && ratio < kMaxRatio;
    SetupFinding finding{
        .question = question("rates"),
        .verdict = SetupVerdict::ok,
        .text = fmt::format("gyroscope {:.3g} rad/s, images {:.3g} rad/s (ratio {:.3g}, bounds 0.1 "
                            "and {:g})",
                            sums.gyro_rate_rad_s(), sums.image_rate_rad_s(), ratio, kMinRatio),
        .measured = SetupMeasurement{ratio, {}, kMinRatio, "ratio"}};
    if (in_degrees) {
      finding.verdict = SetupVerdict::wrong;
      finding.text += fmt::format(": deg/s instead of rad/s ({:.0f} % explained then)",
                                  100 * sums.explained_at_best_scale(axes));
      finding.remedy = fmt::format("multiply wx, wy, wz of the log by {:.7g}", kDegree);
      for (Vector3d& rate : gyro_.values) rate *= kDegree;
    } else if (ratio < 0.1) {
      finding.verdict = SetupVerdict::doubtful;
      finding.text += ": the gyroscope measures no rotation";
      finding.remedy = "check the sensor and the order of the columns: wx, wy, wz, ax, ay, az";
    } else if (ratio > kMaxRatio) {
      finding.verdict = SetupVerdict::doubtful;
      finding.remedy = "give the angular rates in rad/s";
    }
    add(finding);
  }

  // Zero if any axes explain the rotations without an offset; else by a search.
  void choose_offset() {
    constexpr std::array kRanges_s{5.0, 60.0};
    const GyroIntegral integral(gyro_);
    if (overlaps_) {
      const RotationSums sums = rotation_sums(integral, intervals_, 0);
      if (sums.count >= kMinIntervals &&
          sums.explained_at_best_scale(best_axes(sums)) > kMinExplained) {
        is_explained_ = true;
        return;
      }
    }
    const double centre_s = overlaps_ ? 0 : start_to_start_s();
    const int min_pairs = std::max(kMinIntervals, static_cast<int>(intervals_.size() / 2));
    offset_s_ = centre_s;
    for (const bool any_axes : {false, true}) {
      for (const double range_s : kRanges_s) {
        const ClockOffset found =
            clock_offset(integral, intervals_, min_pairs,
                         {.centre_s = centre_s, .range_s = range_s, .any_axes = any_axes});
        if (found.explained < kMinFound) continue;
        offset_s_ = found.offset_s;
        is_explained_ = true;
        return;
      }
    }
  }

  void choose_axes() {
    const GyroIntegral integral(gyro_);
    const RotationSums sums = rotation_sums(integral, intervals_, offset_s_);
    pairs_ = rotation_pairs(integral, intervals_, offset_s_);
    if (!is_explained_ || std::ssize(pairs_) < kMinIntervals) {
      add({.question = question("axes"),
           .text = fmt::format(
               "no axes, unit or clock offset explains {:.0f} % of the image "
               "rotation ({:.0f} % as configured)",
               100 * kMinExplained,
               100 * std::max(0.0, sums.explained_at_best_scale(Matrix3d::Identity())))});
      pairs_.clear();
      return;
    }
    result_.gyro_bias_rad_s = sums.bias_rad_s;
    axes_ = most_plausible_axes(sums);
    if (rotates_about_two_axes(sums)) {
      const Matrix3d rotation = best_rotation(sums);
      if (is_better(pairs_, rotation, axes_)) axes_ = rotation;
    }
    is_permuted_ = !axes_.isIdentity(1e-9) && is_better(pairs_, axes_, Matrix3d::Identity());
    if (!is_permuted_) axes_.setIdentity();
    explained_ = sums.explained_at_best_scale(axes_);
    if (explained_ < kMinExplained) {
      add({.question = question("axes"),
           .text = fmt::format("as configured they explain {:.0f} % of the image rotation (bound "
                               "{:.0f} %), and no others do",
                               100 * explained_, 100 * kMinExplained)});
      pairs_.clear();
      return;
    }
    if (is_permuted_) {
      report_axes(sums.explained_at_best_scale(Matrix3d::Identity()));
    } else {
      add({.question = question("axes"),
           .verdict = SetupVerdict::ok,
           .text = fmt::format("as configured they explain {:.0f} % of the image rotation (bound "
                               "{:.0f} %)",
                               100 * explained_, 100 * kMinExplained),
           .measured = SetupMeasurement{explained_, {}, kMinExplained, "ratio"}});
    }
  }

  // Of those that the rotation does not distinguish: the identity, else right-handed ones that
  // agree with gravity.
  [[nodiscard]] Matrix3d most_plausible_axes(const RotationSums& sums) const {
    double most = sums.explained_at_best_scale(Matrix3d::Identity());
    for (const Matrix3d& axes : signed_permutations()) {
      most = std::max(most, sums.explained_at_best_scale(axes));
    }
    Matrix3d best = Matrix3d::Identity();
    double least_cost = HUGE_VAL;
    for (const Matrix3d& axes : signed_permutations()) {
      if (sums.explained_at_best_scale(axes) < most - kSameExplained) continue;
      double cost = axes.isIdentity() ? 0 : 1;
      if (axes.determinant() < 0) cost += 10;
      if (evidence_.measured_up_in_body)
        cost += std::min(tilt_rad(axes), tilt_rad(Matrix3d::Identity()));
      if (cost >= least_cost) continue;
      least_cost = cost;
      best = axes;
    }
    return best;
  }

  // Angle between the specific force and the initial vertical with these axes of the sensor.
  [[nodiscard]] double tilt_rad(const Matrix3d& axes) const {
    return angle_between_rad(Vector3d(axes * *evidence_.measured_up_in_body),
                             evidence_.initial_up_in_body);
  }

  void report_axes(double explained_before) {
    const AxesGain better = axes_gain(pairs_, axes_, Matrix3d::Identity());
    const std::string statistic = fmt::format(
        "{:.0f} % of the image rotation explained, {:.0f} % as configured ({:.0f} sigma, bound "
        "{:g})",
        100 * explained_, 100 * std::max(0.0, explained_before), std::min(better.sigmas, 999.0),
        kMinSignificance);
    const SetupMeasurement measured{explained_, {}, kMinExplained, "ratio"};
    const auto finding = [&](std::string name, std::string text, std::string remedy) {
      add({.question = std::move(name),
           .verdict = SetupVerdict::wrong,
           .text = std::move(text) + "; " + statistic,
           .remedy = std::move(remedy),
           .measured = measured});
    };
    if (axes_.determinant() < 0) {
      const bool is_force_too = evidence_.measured_up_in_body && tilt_rad(axes_) < kMaxTilt_rad &&
                                tilt_rad(Matrix3d::Identity()) > kMaxTilt_rad;
      finding(question("axes"),
              fmt::format("left-handed: columns of the log swapped or inverted{}",
                          is_force_too ? ", those of the specific force too" : ""),
              fmt::format("body axes from the columns: {}", columns_of(axes_)));
      if (is_force_too) result_.body_from_configured = axes_;
      return;
    }
    const Matrix3d C = evidence_.body_from_camera.toRotationMatrix();
    const std::string imu_line =
        fmt::format("{}: {{rotation_wxyz: {}}}", evidence_.section,
                    rotation_yaml(axes_ * evidence_.body_from_sensor.toRotationMatrix()));
    const std::string mount_line =
        fmt::format("mount: {{rotation_wxyz: {}}}", rotation_yaml(axes_.transpose() * C));
    if (!evidence_.measured_up_in_body) {
      finding(question("axes"),
              fmt::format("rotated by {} against the camera", rotation_text(axes_)),
              imu_line + ", or " + mount_line);
      return;
    }
    const bool fits_before = tilt_rad(Matrix3d::Identity()) < kMaxTilt_rad;
    const bool fits_after = tilt_rad(axes_) < kMaxTilt_rad;
    if (fits_before && !fits_after) {
      report_mount(finding, C, mount_line);
    } else if (fits_before) {
      finding(question("axes"),
              fmt::format("camera and IMU differ by {}, about the vertical: gravity does not "
                          "distinguish them",
                          rotation_text(axes_)),
              imu_line + ", or " + mount_line);
    } else {
      if (fits_after) result_.body_from_configured = axes_;
      finding(question("axes"),
              fmt::format("rotated by {}{}", rotation_text(axes_),
                          fits_after ? ", which makes gravity vertical, too"
                                     : "; the direction of gravity does not agree either way"),
              imu_line);
    }
  }

  template <typename Report>
  void report_mount(const Report& finding, const Matrix3d& C, const std::string& mount_line) {
    const std::optional<std::string_view> mirror = mirror_of(C.transpose() * axes_ * C);
    const bool is_upside_down = tilt_rad(axes_) > 90 * kDegree;
    if (mirror && evidence_.has_ground_in_view && is_upside_down) {
      finding("mirrored images",
              fmt::format("{} are exchanged: with the ground in view, the camera cannot be rotated "
                          "by {}",
                          *mirror, rotation_text(axes_)),
              fmt::format("remove the mirroring: ffmpeg -i IN -vf {} OUT",
                          *mirror == "left and right" ? "hflip" : "vflip"));
      return;
    }
    finding(
        "mount",
        fmt::format("the camera is rotated by {}; the specific force agrees with the IMU's axes{}",
                    rotation_text(Matrix3d(axes_.transpose())),
                    mirror ? fmt::format(" (or {} of the images are exchanged)", *mirror) : ""),
        mount_line);
  }

  // Offset that remains with the axes found.
  void refine_clock() {
    constexpr double kRange_s = 0.5;
    if (pairs_.empty()) {
      if (!overlaps_) {
        report_clock(start_to_start_s(), std::nullopt);
      } else {
        add({.question = question("clock"), .text = "no axes explain the image rotation"});
      }
      return;
    }
    const double interval_s = median_interval_s(gyro_.stamps).value_or(HUGE_VAL);
    if (2 * interval_s > kMinRotationInterval_s) {
      add({.question = question("clock"),
           .text = fmt::format("{:.3g} readings/s do not resolve it", 1 / interval_s)});
      return;
    }
    std::vector<ObservedRotation> rotated = intervals_;
    for (ObservedRotation& rotation : rotated) {
      rotation.rotation_in_body_rad = axes_.transpose() * rotation.rotation_in_body_rad;
    }
    const ClockOffset clock = clock_offset(GyroIntegral(gyro_), rotated, kMinIntervals,
                                           {.centre_s = offset_s_, .range_s = kRange_s});
    report_clock(clock.offset_s, clock.sigma_s);
  }

  void report_clock(double offset_s, std::optional<double> sigma_s) {
    constexpr double kMaxOffset_s = 0.015, kMinOffsetSigmas = 6;  // as gyro_inconsistency
    constexpr double kLeapSeconds_s = 18, kGpsEpoch_s = 315964800;
    const bool is_wrong =
        !overlaps_ || (std::abs(offset_s) >= kMaxOffset_s &&
                       std::abs(offset_s) >= kMinOffsetSigmas * sigma_s.value_or(HUGE_VAL));
    const double to_add_s = evidence_.time_offset_s - offset_s;
    SetupFinding finding{.question = question("clock"),
                         .verdict = is_wrong                            ? SetupVerdict::wrong
                                    : std::abs(offset_s) < kMaxOffset_s ? SetupVerdict::ok
                                                                        : SetupVerdict::cannot_tell,
                         .measured = SetupMeasurement{offset_s, sigma_s, kMaxOffset_s, "s"}};
    const auto is_near = [&](double value_s, double tolerance_s) {
      return std::abs(std::abs(offset_s) - value_s) < tolerance_s;
    };
    const std::string_view hint =
        is_near(kLeapSeconds_s, 0.5)             ? " (18 s: GPS time and UTC)"
        : is_near(kGpsEpoch_s, 3600)             ? " (1980 to 1970: GPS time and Unix time)"
        : !overlaps_ && std::abs(offset_s) > 3e8 ? " (absolute time, GPS or Unix)"
                                                 : "";
    if (!overlaps_) {
      finding.text = fmt::format("no reading at any image: the log begins {:.1f} s {} the images{}",
                                 std::abs(start_to_start_s()),
                                 start_to_start_s() > 0 ? "after" : "before", hint);
      finding.text +=
          sigma_s ? fmt::format("; by the rotations {:+.3f} +- {:.3f} s", offset_s, *sigma_s)
                  : "; not measured by rotations: both are assumed to start together";
    } else {
      finding.text =
          fmt::format("log {:+.1f} +- {:.1f} ms ahead of the images{} (bound {:g} ms)",
                      1e3 * offset_s, 1e3 * sigma_s.value_or(0), hint, 1e3 * kMaxOffset_s);
    }
    if (is_wrong) {
      finding.remedy = fmt::format("{}: {{time_offset_s: {:.3f}}}", evidence_.section, to_add_s);
    }
    add(finding);
  }

  // Small rotation d of the camera against its mount: p = g + d x g.
  void report_alignment() {
    constexpr double kMaxAngle_rad = 3 * kDegree;
    if (pairs_.empty()) {
      add({.question = "mount", .text = "no axes explain the image rotation"});
      return;
    }
    if (is_permuted_) return;  // measured with the axes
    Matrix3d A = Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    for (const RotationPair& pair : pairs_) {
      const Vector3d& g = pair.gyro;
      A += g.squaredNorm() * Matrix3d::Identity() - g * g.transpose();
      b += g.cross(pair.images - g);
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(A);
    if (solver.eigenvalues()(0) < 0.02 * solver.eigenvalues()(2)) {
      add({.question = "mount",
           .text = fmt::format("the camera rotates about one axis only; choose source.start_s")});
      return;
    }
    const Vector3d d = A.ldlt().solve(b);
    double residual2 = 0;
    for (const RotationPair& pair : pairs_) {
      residual2 += (pair.images - pair.gyro - d.cross(pair.gyro)).squaredNorm();
    }
    const double variance = residual2 / (3 * static_cast<double>(pairs_.size()) - 6);
    const double sigma_rad =
        std::sqrt(variance * d.normalized().dot(A.ldlt().solve(d.normalized())));
    const bool is_wrong =
        d.norm() > kMaxAngle_rad && d.norm() - kMaxAngle_rad > kMinSignificance * sigma_rad;
    SetupFinding finding{
        .question = "mount",
        .verdict = is_wrong                    ? SetupVerdict::doubtful
                   : d.norm() <= kMaxAngle_rad ? SetupVerdict::ok
                                               : SetupVerdict::cannot_tell,
        .text =
            fmt::format("the camera is rotated by {:.1f} +- {:.1f} deg against the IMU (bound {:g} "
                        "deg)",
                        d.norm() / kDegree, sigma_rad / kDegree, kMaxAngle_rad / kDegree),
        .measured = SetupMeasurement{d.norm() / kDegree, sigma_rad / kDegree,
                                     kMaxAngle_rad / kDegree, "deg"}};
    if (is_wrong) {
      finding.remedy =
          fmt::format("mount: {{rotation_wxyz: {}}}",
                      rotation_yaml((so3_exp(-d) * evidence_.body_from_camera).toRotationMatrix()));
    }
    add(finding);
  }

  // Rotations about the image axes are proportional to the true over the configured focal length.
  void report_focal_length() {
    constexpr double kMaxError = 0.05, kMaxWrong = 0.15;
    if (pairs_.empty()) {
      add({.question = "focal length", .text = "no axes explain the image rotation"});
      return;
    }
    const Matrix3d camera_from_body = evidence_.body_from_camera.conjugate().toRotationMatrix();
    double energy = 0, whole = 0;
    std::vector<std::array<double, 2>> sums;  // p . g, g . g about the image axes
    for (const RotationPair& pair : pairs_) {
      const Vector3d p = camera_from_body * pair.images, g = camera_from_body * axes_ * pair.gyro;
      sums.push_back({p.head<2>().dot(g.head<2>()), g.head<2>().squaredNorm()});
      energy += sums.back()[1];
      whole += g.squaredNorm();
    }
    constexpr double kMinEnergy = 0.1;
    const double rate_rad_s =
        std::sqrt(energy / static_cast<double>(pairs_.size())) / kMinRotationInterval_s;
    if (energy < kMinEnergy * whole || rate_rad_s < kMinRotationRate_rad_s) {
      add({.question = "focal length",
           .text =
               fmt::format("rotation about the image axes {:.2f} deg/s, {:g} needed, and {:g} % "
                           "of the whole",
                           rate_rad_s / kDegree, kMinRotationRate_rad_s / kDegree,
                           100 * std::sqrt(kMinEnergy))});
      return;
    }
    const BlockEstimate ratio = block_jackknife(sums.size(), [&](const auto& excluded) {
      double pg = 0, gg = 0;
      for (std::size_t i = 0; i < sums.size(); ++i) {
        if (excluded(i)) continue;
        pg += sums[i][0];
        gg += sums[i][1];
      }
      return pg / gg;
    });
    const double error = std::abs(ratio.value - 1);
    const bool is_significant = error - kMaxError > kMinSignificance * ratio.sigma;
    const bool is_within = error <= kMaxError;
    SetupFinding finding{
        .question = "focal length",
        .verdict = is_within            ? SetupVerdict::ok
                   : !is_significant    ? SetupVerdict::cannot_tell
                   : error <= kMaxWrong ? SetupVerdict::doubtful
                                        : SetupVerdict::wrong,
        .text =
            fmt::format("{:.3f} +- {:.3f} of the calibrated one by the gyroscope (bound 1 +- {:g})",
                        ratio.value, ratio.sigma, kMaxError),
        .measured = SetupMeasurement{ratio.value, ratio.sigma, 1 + kMaxError, "ratio"}};
    if (is_significant) {
      finding.remedy = fmt::format(
          "calibrate at this resolution; focal_x_px and focal_y_px are {:.3f} times as long",
          ratio.value);
    }
    add(finding);
  }

  const RotationEvidence& evidence_;
  TimeSeries<Vector3d> gyro_;  // in rad/s
  std::vector<ObservedRotation> intervals_;
  RotationResult result_;
  bool overlaps_ = true;
  bool is_explained_ = false;
  bool is_permuted_ = false;
  double offset_s_ = 0;  // of the log ahead of the images
  Matrix3d axes_ = Matrix3d::Identity();
  double explained_ = 0;
  std::vector<RotationPair> pairs_;
};

}  // namespace

RotationResult rotation_findings(const RotationEvidence& evidence) {
  return Examination(evidence).run();
}

}  // namespace stillkite
