// SPDX-License-Identifier: Apache-2.0
// The module tagsmith._tagsmith; package/__init__.py shows its names as tagsmith.NAME.
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
}
