#pragma once

#include <pybind11/pybind11.h>

namespace stillkite::python {

// Parts of the module, one source each. A part uses the types of those above it.

void bind_geometry(pybind11::module_& m);
void bind_configuration(pybind11::module_& m);
void bind_sensors(pybind11::module_& m);
void bind_estimate(pybind11::module_& m);
void bind_navigator(pybind11::module_& m);
void bind_hold(pybind11::module_& m);
void bind_evaluation(pybind11::module_& m);
void bind_simulation(pybind11::module_& m);

}  // namespace stillkite::python
