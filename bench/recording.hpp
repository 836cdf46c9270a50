#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "estimation/twist.hpp"
#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/sensor_log.hpp"

namespace stillkite::bench {

struct RecordedImage {
  Timestamp stamp;
  cv::Mat grey;  ///< CV_8UC1, shared between recordings
};

/// Images, sensors and truth of one flight. Each series but the images may be empty.
struct Recording {
  Camera camera;
  RigidTransform body_from_camera;
  std::vector<RecordedImage> images;
  std::vector<StampedPose> poses;              ///< true world_from_body, ground at z = 0
  std::vector<StampedTwist> twists_in_camera;  ///< true mean over the interval that ends at stamp
  TimeSeries<Vector6d> imu;                    ///< angular rate, specific force; in the body
  ImuNoiseConfig imu_noise;
};

/// Reads images, calibration, truth and IMU of a run. Throws InputError as `stillkite run`.
[[nodiscard]] Recording read_recording(const RunConfig& config);

/// Images between two shares of the duration, 0 to 1, with the truth and the IMU of that time.
[[nodiscard]] Recording part_of(const Recording& recording, double from_ratio, double to_ratio);

}  // namespace stillkite::bench
