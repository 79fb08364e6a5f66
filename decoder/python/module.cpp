// SPDX-License-Identifier: Apache-2.0
// The module tagsmith._tagsmith; package/__init__.py shows its names as tagsmith.NAME.
#include <cstddef>
#include <exception>
#include <utility>

#include <pybind11/pybind11.h>
#include <tagsmith/error.hpp>
#include <tagsmith/version.hpp>

#include "decoder/python/bindings.hpp"

namespace py = pybind11;

namespace {

// tagsmith.Error with the code as an attribute.
void bind_error(py::module_& module) {
  static py::exception<tagsmith::Error> error(module, "Error", PyExc_RuntimeError);
  error.doc() =
      "What the library cannot do, with the reason in words; `code` is the kind of reason:\n"
      "invalid_argument, file_missing, unreadable_file, invalid_file, unwritable_file or failed.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const tagsmith::Error& failure) {
      const py::object& type = error;
      const py::object value = type(failure.what());
      value.attr("code") = tagsmith::to_string(failure.code());
      PyErr_SetObject(error.ptr(), value.ptr());
    }
  });
}

// An object that no constructor or function of the module made, as of Tag.__new__(Tag), has no
// value; pybind11 would use memory that nothing was written to in its place.
void* refuse_missing_value(std::size_t) {
  throw py::type_error("the object has no value: its class was not constructed");
}

// What all classes have in common. Values are immutable, so that a copy is the value itself; a
// Localizer is none, it has the drive so far.
void complete_classes(const py::module_& module) {
  for (const auto& [name, type] : py::cast<py::dict>(module.attr("__dict__"))) {
    if (!py::isinstance<py::type>(type)) continue;
    py::detail::type_info* info =
        py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(type.ptr()));
    if (info == nullptr) continue;  // Error
    info->operator_new = refuse_missing_value;
    if (type.is(module.attr("Localizer"))) continue;
    py::setattr(type, "__copy__",
                py::cpp_function([](const py::object& self) { return self; }, py::name("__copy__"),
                                 py::is_method(type)));
    py::setattr(type, "__deepcopy__",
                py::cpp_function([](const py::object& self, const py::object&) { return self; },
                                 py::name("__deepcopy__"), py::is_method(type)));
  }
}

}  // namespace

PYBIND11_MODULE(_tagsmith, module) {
  module.doc() = "Position tags for mine tunnels: read, verify, localize.";
  module.attr("__version__") = tagsmith::version();
  bind_error(module);
  tagsmith::python::bind_survey(module);
  tagsmith::python::bind_read(module);
  tagsmith::python::bind_localize(module);
  tagsmith::python::bind_plan(module);
  tagsmith::python::bind_files(module);
  complete_classes(module);
}
