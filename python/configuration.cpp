#include "python/configuration.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <filesystem>

#include "io/config/config_binding.hpp"
#include "io/config/config_printing.hpp"
#include "io/config/renamed_keys.hpp"
#include "python/bindings.hpp"

namespace py = pybind11;

namespace stillkite::python {
namespace {

constexpr const char* kOrigin = "configuration";

bool is_path(const py::handle& value) {
  return py::hasattr(value, "__fspath__");
}

std::string text_of_path(const py::handle& path) {
  return py::str(py::module_::import("os").attr("fspath")(path));
}

ConfigNode scalar(std::string text, bool quoted) {
  return {.kind = ConfigNode::Kind::scalar,
          .text = std::move(text),
          .quoted = quoted,
          .origin = kOrigin,
          .base_folder = std::filesystem::current_path()};
}

ConfigNode node_of(const py::handle& value, const std::string& key);

ConfigNode map_of(const py::dict& values, const std::string& prefix) {
  ConfigNode map{.kind = ConfigNode::Kind::map, .origin = kOrigin};
  for (const auto& [name, value] : values) {
    const std::string key = py::str(name);
    map.entries.emplace_back(key, node_of(value, prefix + key));
  }
  return map;
}

ConfigNode list_of(const py::handle& values, const std::string& key) {
  ConfigNode list{.kind = ConfigNode::Kind::list, .origin = kOrigin};
  for (const py::handle& value : values) list.items.push_back(node_of(value, key));
  return list;
}

ConfigNode node_of(const py::handle& value, const std::string& key) {
  if (value.is_none()) return {.kind = ConfigNode::Kind::null, .origin = kOrigin};
  if (py::isinstance<py::bool_>(value)) return scalar(value.cast<bool>() ? "true" : "false", false);
  if (py::isinstance<py::int_>(value)) return scalar(py::str(value), false);
  if (py::isinstance<py::float_>(value)) return scalar(print_number(value.cast<double>()), false);
  if (py::isinstance<py::str>(value)) return scalar(value.cast<std::string>(), true);
  if (is_path(value)) return scalar(text_of_path(value), true);
  if (py::isinstance<py::dict>(value)) {
    return map_of(py::reinterpret_borrow<py::dict>(value), key + '.');
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    return list_of(value, key);
  }
  if (py::hasattr(value, "tolist")) return node_of(value.attr("tolist")(), key);  // numpy
  throw py::type_error(
      fmt::format("{}: {}; expected a number, text, path, bool, None, list or dict", key,
                  py::str(py::type::handle_of(value)).cast<std::string>()));
}

// Old keys are reported as warnings of the module.
ConfigNode with_current_keys(ConfigNode root) {
  std::vector<std::string> notices = move_renamed_keys(root, "", false);
  for (std::string& notice : drop_removed_keys(root, "")) notices.push_back(std::move(notice));
  for (const std::string& notice : notices) {
    if (PyErr_WarnEx(PyExc_DeprecationWarning, notice.c_str(), 1) != 0) {
      throw py::error_already_set();
    }
  }
  return root;
}

RunConfig make_config(const py::object& source, const std::vector<std::string>& overrides) {
  return bind_config<RunConfig>(document_of(source, overrides));
}

}  // namespace

ConfigNode document_of(const py::object& source, const std::vector<std::string>& overrides) {
  if (is_path(source)) return read_config(text_of_path(source), overrides);
  ConfigNode root{.kind = ConfigNode::Kind::map};
  if (py::isinstance<py::str>(source)) {
    root = with_current_keys(
        parse_yaml(source.cast<std::string>(), kOrigin, std::filesystem::current_path()));
  } else if (py::isinstance<py::dict>(source)) {
    root = with_current_keys(map_of(source, ""));
  } else if (!source.is_none()) {
    throw py::type_error("configuration: expected YAML text, a dict, a path or None, got " +
                         py::str(py::type::handle_of(source)).cast<std::string>());
  }
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  return root;
}

RunConfig run_config_of(const py::object& source) {
  if (py::isinstance<RunConfig>(source)) return source.cast<RunConfig>();
  return make_config(source, {});
}

void bind_configuration(py::module_& m) {
  py::class_<RunConfig>(
      m, "Config",
      "Configuration of a run: keys, ranges and defaults of `stillkite config`.\n\n"
      "Navigator uses the sections estimator, navigator, reference, choice and fusion;\n"
      "HoldController and HoverPilot also hold. str(config) is the YAML text of all keys.")
      .def(py::init(&make_config), py::arg("source") = py::none(),
           py::arg("overrides") = std::vector<std::string>(),
           "source: YAML text, dict, path of a YAML file (pathlib.Path), or None: defaults.\n"
           "overrides: 'key.path=value', as --set of the command. Raises InputError on an unknown\n"
           "key and a value out of range.")
      .def("__str__", &print_config<RunConfig>)
      .def_property_readonly(
          "policy",
          [](const RunConfig& config) { return std::string(name_of(config.estimator.policy)); },
          "Estimator whose result is returned: flow, reference, best or fused.");
}

}  // namespace stillkite::python
