// SPDX-License-Identifier: Apache-2.0
// Pictures, prints and what people write.
#include <memory>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "decoder/python/bindings.hpp"

namespace py = pybind11;

namespace tagsmith::python {
namespace {

// The picture as an array that owns the samples, without a copy.
py::object picture_array(const std::filesystem::path& path) {
  auto image = [&] {
    const py::gil_scoped_release others_run;
    return std::make_unique<Image>(load_image(path));
  }();
  const std::vector<py::ssize_t> shape{image->height, image->width};
  const std::uint8_t* samples = image->samples.data();
  const py::capsule owner(image.release(), [](void* owned) { delete static_cast<Image*>(owned); });
  return py::array_t<std::uint8_t>(shape, samples, owner);
}

std::vector<VerifiedFile> verify_files(const Survey& survey,
                                       const std::vector<std::filesystem::path>& paths,
                                       const py::object& also, std::optional<double> scan_dpi,
                                       int jobs) {
  const VerifyOptions options{surveys_from("also", also), scan_dpi, jobs};
  const py::gil_scoped_release others_run;
  return verify(survey, paths, options);
}

void bind_findings(py::module_& module) {
  py::class_<FileFinding>(module, "FileFinding", "What is wrong or unlikely in a file.")
      .def_readonly("rule", &FileFinding::rule)
      .def_property_readonly("severity",
                             [](const FileFinding& one) {
                               return one.severity == Severity::error ? "error" : "warning";
                             })
      .def_readonly("file", &FileFinding::file)
      .def_readonly("line", &FileFinding::line)
      .def_readonly("column", &FileFinding::column)
      .def_readonly("message", &FileFinding::message)
      .def_readonly("remedy", &FileFinding::remedy)
      .def("__repr__", shows("FileFinding", {"rule", "severity", "file", "line", "message"}));
}

void bind_verified(py::module_& module) {
  py::class_<VerifiedTag>(module, "VerifiedTag", "A tag in a verified file.")
      .def_readonly("tag", &VerifiedTag::tag)
      .def_readonly("digits", &VerifiedTag::digits)
      .def_property_readonly("status", [](const VerifiedTag& one) { return to_string(one.status); })
      .def_readonly("rule", &VerifiedTag::rule)
      .def_readonly("message", &VerifiedTag::message)
      .def_property_readonly("corners", as_array(&VerifiedTag::corners))
      .def_readonly("page", &VerifiedTag::page)
      .def_readonly("grade", &VerifiedTag::grade)
      .def("__repr__", shows("VerifiedTag", {"tag", "status", "message", "grade"}));
  py::class_<VerifiedFile>(module, "VerifiedFile", "What verify() says of one file.")
      .def_readonly("file", &VerifiedFile::file)
      .def_readonly("tags", &VerifiedFile::tags)
      .def_readonly("findings", &VerifiedFile::findings)
      .def_readonly("notes", &VerifiedFile::notes)
      .def_readonly("readable", &VerifiedFile::readable)
      .def_readonly("stale", &VerifiedFile::stale)
      .def_property_readonly("is_ok", &VerifiedFile::is_ok)
      .def("__repr__", shows("VerifiedFile", {"file", "is_ok", "tags", "findings"}));
}

}  // namespace

void bind_files(py::module_& module) {
  bind_findings(module);
  bind_verified(module);
  module.def("load_image", &picture_array, py::arg("path"),
             "The picture as a uint8 array of shape (height, width): luma as stored, not turned.");
  module.def("validate", &validate, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
             "All findings on a survey, rig or template file; none = all is well.");
  module.def("verify", &verify_files, py::arg("survey"), py::arg("paths"), py::kw_only(),
             py::arg("also") = py::none(), py::arg("scan_dpi") = py::none(), py::arg("jobs") = 0,
             "Photos and print files against the survey that they should show, in order.");
  module.def("print_tag", &print_tag, py::arg("survey"), py::arg("tag"), py::arg("path"),
             py::call_guard<py::gil_scoped_release>(),
             "Writes the page of one tag at true scale: .pdf, .svg or .png.");
}

}  // namespace tagsmith::python
