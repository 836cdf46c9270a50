#include "io/import/calibration_section.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "geometry/angle.hpp"
#include "io/dataset/calibration.hpp"

namespace stillkite {
namespace {

std::string camera_yaml(const CameraConfig& camera) {
  return fmt::format(
      "calibration:\n  camera:\n    width_px: {}\n    height_px: {}\n    focal_x_px: {:.9g}\n"
      "    focal_y_px: {:.9g}\n    centre_x_px: {:.9g}\n    centre_y_px: {:.9g}\n"
      "    distortion: {}\n    coefficients: [{:.9g}]\n",
      camera.width_px, camera.height_px, camera.focal_x_px, camera.focal_y_px, camera.centre_x_px,
      camera.centre_y_px, name_of(camera.distortion), fmt::join(camera.coefficients, ", "));
}

// Equidistant or distortion-free lens of a horizontal field of view.
CameraConfig nominal_camera(const ImageSize& size, double fov_deg, bool is_fisheye) {
  const double half_rad = fov_deg / 2 * kDegree;
  const double focal_px = (is_fisheye ? 0.5 / half_rad : 0.5 / std::tan(half_rad)) * size.width_px;
  return {.width_px = size.width_px,
          .height_px = size.height_px,
          .focal_x_px = focal_px,
          .focal_y_px = focal_px,
          .centre_x_px = 0.5 * (size.width_px - 1),
          .centre_y_px = 0.5 * (size.height_px - 1),
          .distortion = is_fisheye ? DistortionModel::equidistant : DistortionModel::none,
          .coefficients = std::vector<double>(is_fisheye ? 4 : 0)};
}

CameraConfig assumed_camera(const ImportedFlight& flight, const ImportOptions& options,
                            const ImageSize& size, std::vector<ImportNote>& notes) {
  constexpr double kUnknown_deg = 70;
  const char* source = "of an unknown camera (--horizontal-fov-deg)";
  double fov_deg = kUnknown_deg;
  bool is_fisheye = false;
  if (options.horizontal_fov_deg) {
    source = "as given";
    fov_deg = *options.horizontal_fov_deg;
  } else if (flight.horizontal_fov_deg) {
    source = "by the camera's nominal values";
    fov_deg = *flight.horizontal_fov_deg;
    is_fisheye = flight.is_fisheye;
  }
  add_note(notes, ImportNote::Kind::assumed,
           fmt::format("calibration: horizontal field of view {:.1f} deg {}, {} lens: scale errors "
                       "of 10 % and more; measure it (--calibration FILE)",
                       fov_deg, source, is_fisheye ? "equidistant" : "distortion-free"));
  return nominal_camera(size, fov_deg, is_fisheye);
}

template <typename Camera>
bool fits(const Camera& camera, const std::optional<ImageSize>& images) {
  return !images || (camera.width_px == images->width_px && camera.height_px == images->height_px);
}

}  // namespace

std::string calibration_section(const ImportedFlight& flight, const ImportOptions& options,
                                const std::optional<ImageSize>& images, const std::string& path,
                                std::vector<ImportNote>& notes) {
  if (options.calibration) {
    const Camera camera = read_calibration(*options.calibration).camera;
    if (!fits(camera, images)) {
      throw InputError(fmt::format(
          "{}: calibration of {}x{} images, but the recording has {}x{}; give the calibration of "
          "this resolution",
          options.calibration->string(), camera.width_px, camera.height_px, images->width_px,
          images->height_px));
    }
    add_note(notes, ImportNote::Kind::found, "calibration: " + options.calibration->string());
    return "calibration:\n  path: " + path + "\n";
  }
  if (flight.camera && !options.horizontal_fov_deg) {
    if (fits(*flight.camera, images)) {
      add_note(notes, ImportNote::Kind::found, "calibration: in the recording");
      return camera_yaml(*flight.camera);
    }
    add_note(notes, ImportNote::Kind::missing,
             fmt::format("calibration: that of the recording is for {}x{}, the images are {}x{}",
                         flight.camera->width_px, flight.camera->height_px, images->width_px,
                         images->height_px));
  }
  if (images) return camera_yaml(assumed_camera(flight, options, *images, notes));
  add_note(notes, ImportNote::Kind::missing,
           "calibration: --calibration FILE, or calibration.path in flight.yaml");
  return {};
}

}  // namespace stillkite
