// The module stillkite._stillkite; python/stillkite/__init__.py exports its names.
#include <pybind11/pybind11.h>

#include "geometry/fields.hpp"
#include "python/bindings.hpp"

PYBIND11_MODULE(_stillkite, m) {
  pybind11::register_exception<stillkite::InputError>(m, "InputError", PyExc_ValueError)
      .attr("__doc__") = "Wrong argument, key, value or file; the message states the remedy.";
  stillkite::python::bind_geometry(m);
  stillkite::python::bind_configuration(m);
  stillkite::python::bind_sensors(m);
  stillkite::python::bind_estimate(m);
  stillkite::python::bind_navigator(m);
  stillkite::python::bind_hold(m);
  stillkite::python::bind_evaluation(m);
  stillkite::python::bind_simulation(m);
  m.attr("__version__") = STILLKITE_VERSION;
}
