#include "navigation/navigator.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/casters.hpp"
#include "python/configuration.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

// The interpreter lock is released during a step: calls of several threads wait for each other.
struct LockedNavigator {
  explicit LockedNavigator(Navigator&& unlocked) : navigator(std::move(unlocked)) {}

  Navigator navigator;
  std::mutex mutex;
};

std::unique_ptr<LockedNavigator> make_navigator(const Camera& camera,
                                                const RigidTransform& body_from_camera,
                                                const InitialState& initial,
                                                const py::object& source,
                                                const std::optional<py::array>& valid_pixels) {
  const RunConfig config = run_config_of(source);
  std::optional<ImageView> mask;
  if (valid_pixels) mask = image_view(*valid_pixels, "valid_pixels");
  return std::make_unique<LockedNavigator>(
      Navigator(camera, body_from_camera, config.navigator, initial, config.estimator, mask));
}

Estimate step_navigator(LockedNavigator& self, const py::array& image, Timestamp stamp,
                        const SensorReadings& readings, double stamp_sigma_s) {
  const ImageView view = image_view(image, "image");
  const py::gil_scoped_release released;
  const std::scoped_lock lock(self.mutex);
  return self.navigator.step(view, stamp, readings, stamp_sigma_s);
}

}  // namespace

void bind_navigator(py::module_& m) {
  py::class_<LockedNavigator>(
      m, "Navigator",
      "Visual navigation with one camera: pose and velocity of the body from each image and\n"
      "optional sensor readings. One object per flight.")
      .def(py::init(&make_navigator), py::arg("camera"), py::arg("body_from_camera"),
           py::arg("initial"), py::arg("config") = py::none(), py::arg("valid_pixels") = py::none(),
           "initial: body pose at the first image; its camera must be above the ground, z > 0.\n"
           "config: Config, or what Config takes; None: defaults.\n"
           "valid_pixels: mask (height, width), uint8, 0 where a pixel does not show the scene.\n"
           "Raises InputError on an invalid camera, mask, initial state or configuration.")
      .def(
          "step", &step_navigator, py::arg("image"), py::arg("stamp_ns"),
          py::arg("readings") = SensorReadings(), py::arg("stamp_sigma_s") = 0.0,
          "Estimates the state at an image.\n\n"
          "image: grey levels (height, width), uint8, contiguous rows; read where they are, so do\n"
          "not change them during the call. stamp_ns: exposure of the middle row, ns. readings:\n"
          "sensors since the previous image. stamp_sigma_s: jitter of the stamp, s.\n"
          "An unusable image does not raise: its verdict names the cause. Other threads run "
          "during\n"
          "the call. Raises InputError on another shape, dtype or size than the camera's.");
}

}  // namespace stillkite::python
