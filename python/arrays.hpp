#pragma once

#include <pybind11/numpy.h>

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "geometry/image_view.hpp"
#include "geometry/time.hpp"

namespace stillkite::python {

/// View of an array's pixels, no copy. Throws InputError with the remedy unless the array is uint8,
/// 2-D, with contiguous rows from top to bottom. `name`: of the argument, for the message.
[[nodiscard]] ImageView image_view(const pybind11::array& image, const std::string& name);

/// Array of the pixels of a CV_8UC1 image, which it keeps alive; no copy.
[[nodiscard]] pybind11::array array_of(const cv::Mat& grey);

/// Rows of a table, C order. Converts other numbers to double. Throws InputError unless the shape
/// is (rows, columns); `columns` 0: one dimension.
using Table = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;
void require_shape(const pybind11::array& array, const std::string& name, pybind11::ssize_t rows,
                   pybind11::ssize_t columns);

/// Stamps, ns, of a 1-D array of integers. Throws InputError on other types: seconds as floats.
[[nodiscard]] std::vector<Timestamp> stamps_of(const pybind11::array& stamps_ns,
                                               const std::string& name);
[[nodiscard]] pybind11::array_t<std::int64_t> array_of(std::span<const Timestamp> stamps);

}  // namespace stillkite::python
