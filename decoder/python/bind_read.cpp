// SPDX-License-Identifier: Apache-2.0
// Reading and grading.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <tagsmith/grade.hpp>
#include <tagsmith/read.hpp>

#include "decoder/python/bindings.hpp"

namespace py = pybind11;

namespace tagsmith::python {
namespace {

Frameless frameless_from(const std::string& name) {
  if (name == "never") return Frameless::never;
  if (name == "fallback") return Frameless::fallback;
  if (name == "always") return Frameless::always;
  throw py::value_error("frameless is '" + name + "', expected 'never', 'fallback' or 'always'");
}

std::optional<CheckDigit> check_digit_from(const std::optional<std::string>& name) {
  if (!name) return std::nullopt;
  if (*name == "sum10") return CheckDigit::sum10;
  if (*name == "gs1") return CheckDigit::gs1;
  throw py::value_error("check_digit is '" + *name + "', expected 'sum10' or 'gs1'");
}

std::optional<CameraModel> camera_from(const py::object& camera) {
  if (camera.is_none()) return std::nullopt;
  if (py::isinstance<RigCamera>(camera)) return py::cast<RigCamera>(camera).model;
  if (!py::isinstance<CameraModel>(camera)) {
    refuse_type("camera", camera, "a CameraModel or a RigCamera, as of Rig.cameras");
  }
  return py::cast<CameraModel>(camera);
}

ReadResult read_picture(const py::object& image, const py::object& survey, const py::object& camera,
                        const std::optional<std::string>& check_digit, const std::string& frameless,
                        std::optional<double> min_confidence, bool white_on_black) {
  const ReadOptions options{
      surveys_from("survey", survey), camera_from(camera), check_digit_from(check_digit),
      frameless_from(frameless),      min_confidence,      white_on_black};
  const Picture picture = picture_from(image);
  const py::gil_scoped_release others_run;
  return read(picture.view, options);
}

void bind_tags(py::module_& module) {
  py::class_<Tag>(module, "Tag", "A tag that was read and is believed.")
      .def_readonly("digits", &Tag::digits)
      .def_readonly("sum10_holds", &Tag::sum10_holds)
      .def_readonly("gs1_holds", &Tag::gs1_holds)
      .def_property_readonly("position", as_array(&Tag::position),
                             "That the digits say; metres of the grid.")
      .def_readonly("survey", &Tag::survey, "That has the tag; empty = none does.")
      .def_readonly("name", &Tag::name)
      .def_property_readonly("corners", as_array(&Tag::corners),
                             "P, F, lower right, Q of the feature frame: 4 x 2 pixels.")
      .def_property_readonly("corner_covariance", as_array(&Tag::corner_covariance),
                             "8 x 8, pixels squared; None = not estimated.")
      .def_readonly("module_px", &Tag::module_px)
      .def_readonly("confidence", &Tag::confidence)
      .def_property_readonly("method", [](const Tag& tag) { return to_string(tag.method); })
      .def("__repr__",
           shows("Tag", {"digits", "name", "survey", "corners", "module_px", "method"}));
  py::class_<FramelessTag>(module, "FramelessTag", "A symbol without a frame: nothing to measure.")
      .def_readonly("digits", &FramelessTag::digits)
      .def_readonly("sum10_holds", &FramelessTag::sum10_holds)
      .def_readonly("gs1_holds", &FramelessTag::gs1_holds)
      .def_property_readonly("position", as_array(&FramelessTag::position))
      .def_readonly("survey", &FramelessTag::survey)
      .def_readonly("name", &FramelessTag::name)
      .def_property_readonly("bars", as_array(&FramelessTag::bars))
      .def_readonly("module_px", &FramelessTag::module_px)
      .def_readonly("confidence", &FramelessTag::confidence)
      .def("__repr__", shows("FramelessTag", {"digits", "name", "survey", "bars"}));
}

void bind_results(py::module_& module) {
  py::class_<Refusal>(module, "Refusal", "Something like a tag that was not read, and why.")
      .def_property_readonly("reason", [](const Refusal& one) { return to_string(one.reason); })
      .def_readonly("text", &Refusal::text)
      .def_readonly("has_frame", &Refusal::has_frame)
      .def_property_readonly("corners", as_array(&Refusal::corners))
      .def_readonly("measured", &Refusal::measured)
      .def_readonly("limit", &Refusal::limit)
      .def("__repr__", shows("Refusal", {"reason", "text"}));
  py::class_<ReadResult>(module, "ReadResult", "What was read in a picture, and what was refused.")
      .def_readonly("tags", &ReadResult::tags)
      .def_readonly("frameless", &ReadResult::frameless)
      .def_readonly("refusals", &ReadResult::refusals)
      .def("__repr__", shows("ReadResult", {"tags", "frameless", "refusals"}));
}

void bind_grade(py::module_& module) {
  py::class_<GradeParameter>(module, "GradeParameter", "What was graded, 4 (best) to 0.")
      .def_readonly("name", &GradeParameter::name)
      .def_readonly("grade", &GradeParameter::grade)
      .def_readonly("value", &GradeParameter::value)
      .def("__repr__", shows("GradeParameter", {"name", "grade", "value"}));
  py::class_<Grade>(module, "Grade", "Print quality in the manner of ISO/IEC 15416.")
      .def_readonly("grade", &Grade::grade)
      .def_readonly("worst", &Grade::worst)
      .def_readonly("parameters", &Grade::parameters)
      .def("__repr__", shows("Grade", {"grade", "worst"}));
  module.def(
      "grade",
      [](const py::object& image, const py::object& corners, const py::object& plate) {
        const Corners points = corners_from(corners);
        const PlateTemplate dimensions = plate_from(plate);
        const Picture picture = picture_from(image);
        const py::gil_scoped_release others_run;
        return grade(picture.view, points, dimensions);
      },
      py::arg("image"), py::arg("corners"), py::arg("plate") = py::none(),
      "The print quality of the tag with these corners (Tag.corners) in a picture.");
}

}  // namespace

void bind_read(py::module_& module) {
  bind_tags(module);
  bind_results(module);
  bind_grade(module);
  module.def(
      "read", &read_picture, py::arg("image"), py::kw_only(), py::arg("survey") = py::none(),
      py::arg("camera") = py::none(), py::arg("check_digit") = py::none(),
      py::arg("frameless") = "never", py::arg("min_confidence") = py::none(),
      py::arg("white_on_black") = false,
      "All tags in a picture: a uint8 array of shape (height, width), which is not copied, "
      "or a path.\n\n"
      "survey: a Survey or several; only their tags are read, and smaller ones too.\n"
      "camera: the CameraModel or RigCamera that took it; makes corners exact.\n"
      "check_digit: 'sum10' or 'gs1', that a tag must have; None = either, or the surveys'.\n"
      "frameless: 'never', 'fallback' or 'always', when to read symbols without a frame.\n"
      "white_on_black: the plates are white on black, where no survey says so.");
}

}  // namespace tagsmith::python
