#include "python/arrays.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/fields.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

std::string shape_text(const py::array& array) {
  return fmt::format("({})", fmt::join(array.shape(), array.shape() + array.ndim(), ", "));
}

}  // namespace

ImageView image_view(const py::array& image, const std::string& name) {
  if (image.dtype().kind() != 'u' || image.itemsize() != 1) {
    throw InputError(fmt::format("{}: dtype {}; pass grey levels of 0 to 255 as numpy.uint8", name,
                                 py::str(image.dtype()).cast<std::string>()));
  }
  if (image.ndim() != 2) {
    throw InputError(
        fmt::format("{}: shape {}; pass one grey channel (height, width), for example "
                    "cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)",
                    name, shape_text(image)));
  }
  const auto [height, width] = std::pair(image.shape(0), image.shape(1));
  if (width > 1 && image.strides(1) != 1) {
    throw InputError(
        fmt::format("{}: pixels of a row are {} bytes apart; pass numpy.ascontiguousarray(image)",
                    name, image.strides(1)));
  }
  if (height > 1 && image.strides(0) < width) {
    throw InputError(
        fmt::format("{}: rows of {} pixels are {} bytes apart; pass numpy.ascontiguousarray(image)",
                    name, width, image.strides(0)));
  }
  return {static_cast<const std::uint8_t*>(image.data()), static_cast<int>(width),
          static_cast<int>(height), height > 1 ? image.strides(0) : width};
}

py::array array_of(const cv::Mat& grey) {
  // the header shares the pixels
  const auto* const kept = new cv::Mat(grey);
  const py::capsule owner(kept, [](void* image) { delete static_cast<cv::Mat*>(image); });
  const std::vector<py::ssize_t> shape{grey.rows, grey.cols};
  const std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(grey.step), 1};
  return py::array(py::dtype::of<std::uint8_t>(), shape, strides, grey.data, owner);
}

void require_shape(const py::array& array, const std::string& name, py::ssize_t rows,
                   py::ssize_t columns) {
  const bool is_right =
      columns == 0 ? array.ndim() == 1 && array.shape(0) == rows
                   : array.ndim() == 2 && array.shape(0) == rows && array.shape(1) == columns;
  if (is_right) return;
  throw InputError(fmt::format(
      "{}: shape {}; expected {}", name, shape_text(array),
      columns == 0 ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, columns)));
}

std::vector<Timestamp> stamps_of(const py::array& stamps_ns, const std::string& name) {
  if (stamps_ns.dtype().kind() != 'i' && stamps_ns.dtype().kind() != 'u' && stamps_ns.size() > 0) {
    throw InputError(fmt::format(
        "{}: dtype {}; pass integer nanoseconds, for example (seconds * 1e9).astype(numpy.int64)",
        name, py::str(stamps_ns.dtype()).cast<std::string>()));
  }
  require_shape(stamps_ns, name, stamps_ns.size(), 0);
  const auto values =
      py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(stamps_ns);
  std::vector<Timestamp> stamps(static_cast<std::size_t>(values.size()));
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i].ns = values.at(static_cast<py::ssize_t>(i));
    if (i > 0 && stamps[i] <= stamps[i - 1]) {
      throw InputError(fmt::format("{}: row {} ({} ns) is not after row {} ({} ns); sort the rows",
                                   name, i, stamps[i].ns, i - 1, stamps[i - 1].ns));
    }
  }
  return stamps;
}

py::array_t<std::int64_t> array_of(std::span<const Timestamp> stamps) {
  py::array_t<std::int64_t> array(static_cast<py::ssize_t>(stamps.size()));
  for (std::size_t i = 0; i < stamps.size(); ++i) array.mutable_data()[i] = stamps[i].ns;
  return array;
}

}  // namespace stillkite::python
