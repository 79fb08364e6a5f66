// SPDX-License-Identifier: Apache-2.0
// Surveys, rigs and the plate's geometry.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <tagsmith/drawing.hpp>
#include <tagsmith/rig.hpp>

#include "decoder/python/bindings.hpp"

namespace py = pybind11;

namespace tagsmith::python {
namespace {

void bind_plate(py::module_& module) {
  py::class_<PlateTemplate>(module, "PlateTemplate", "A plate's dimensions, metres.")
      .def_readonly("name", &PlateTemplate::name)
      .def_readonly("plate_length", &PlateTemplate::plate_length)
      .def_readonly("plate_height", &PlateTemplate::plate_height)
      .def_readonly("frame_inner_length", &PlateTemplate::frame_inner_length)
      .def_readonly("frame_inner_height", &PlateTemplate::frame_inner_height)
      .def_readonly("frame_stroke", &PlateTemplate::frame_stroke)
      .def_readonly("white_on_black", &PlateTemplate::white_on_black)
      .def("__repr__", shows("PlateTemplate", {"name", "plate_length", "plate_height"}));
  py::class_<TagDrawing>(module, "TagDrawing",
                         "What is printed, in metres from corner P: x to the right, y down. "
                         "Rectangles are x, y, width, height.")
      .def_property_readonly("plate", as_array(&TagDrawing::plate))
      .def_property_readonly("frame_outer", as_array(&TagDrawing::frame_outer))
      .def_property_readonly("frame_inner", as_array(&TagDrawing::frame_inner))
      .def_property_readonly("bars", as_array(&TagDrawing::bars))
      .def_readonly("module", &TagDrawing::module)
      .def("__repr__", shows("TagDrawing", {"plate", "module"}));
  module.def(
      "draw_tag",
      [](const std::string& digits, const py::object& plate) {
        return draw_tag(plate_from(plate), digits);
      },
      py::arg("digits"), py::arg("plate") = py::none(),
      "The geometry of the tag with these twelve digits on a plate: a PlateTemplate or a Survey, "
      "whose plate it is.");
}

void bind_survey_class(py::module_& module) {
  py::class_<SurveyTag>(module, "SurveyTag", "A tag where it hangs; metres of the survey's grid.")
      .def_readonly("name", &SurveyTag::name)
      .def_readonly("digits", &SurveyTag::digits)
      .def_property_readonly("side", [](const SurveyTag& tag) { return to_string(tag.side); })
      .def_property_readonly("corner_p", as_array(&SurveyTag::corner_p))
      .def_property_readonly("coded_position", as_array(&SurveyTag::coded_position))
      .def_readonly("chainage", &SurveyTag::chainage)
      .def_readonly("sigma", &SurveyTag::sigma)
      .def_readonly("surveyed", &SurveyTag::surveyed)
      .def("__repr__", shows("SurveyTag", {"name", "digits", "side", "corner_p"}));
  py::class_<Survey>(module, "Survey", "A surveyed tunnel and the tags in it; immutable.")
      .def_static("load", &load_survey, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
                  "Reads a survey file (YAML); Error lists all that is wrong with it.")
      .def_property_readonly("name", &Survey::name)
      .def_property_readonly("plate", &Survey::plate)
      .def_property_readonly("tags", &Survey::tags)
      .def("find", &Survey::find, py::arg("name_or_digits"),
           "The tag of this name or with these digits, or None.")
      .def("__len__", [](const Survey& survey) { return survey.tags().size(); })
      .def("__repr__", [](const Survey& survey) {
        return "Survey(name='" + survey.name() + "', " + std::to_string(survey.tags().size()) +
               " tags)";
      });
}

void bind_rig(py::module_& module) {
  py::class_<CameraModel>(module, "CameraModel", "A camera's intrinsics, pixels.")
      .def_readonly("width", &CameraModel::width)
      .def_readonly("height", &CameraModel::height)
      .def_readonly("fx", &CameraModel::fx)
      .def_readonly("fy", &CameraModel::fy)
      .def_readonly("cx", &CameraModel::cx)
      .def_readonly("cy", &CameraModel::cy)
      .def_readonly("distortion", &CameraModel::distortion)
      .def_property_readonly("lens",
                             [](const CameraModel& model) {
                               return model.lens == LensModel::fisheye ? "fisheye" : "perspective";
                             })
      .def("__repr__", shows("CameraModel", {"width", "height", "fx", "fy", "cx", "cy", "lens"}));
  py::class_<RigCamera>(module, "RigCamera", "A camera of a rig.")
      .def_readonly("name", &RigCamera::name)
      .def_readonly("model", &RigCamera::model)
      .def_property_readonly(
          "rotation",
          [](const RigCamera& camera) {
            return python::array_of(std::optional(camera.vehicle_from_camera.rotation));
          },
          "Of x_vehicle = rotation @ x_camera + position.")
      .def_property_readonly("position",
                             [](const RigCamera& camera) {
                               return python::array_of(camera.vehicle_from_camera.translation);
                             })
      .def("__repr__", shows("RigCamera", {"name", "model"}));
  py::class_<Rig>(module, "Rig", "A vehicle's cameras and range sensors; immutable.")
      .def_static("load", &load_rig, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
                  "Reads a rig file (YAML); Error lists all that is wrong with it.")
      .def_property_readonly("name", &Rig::name)
      .def_property_readonly("cameras", &Rig::cameras)
      .def_property_readonly("ranges",
                             [](const Rig& rig) {
                               std::vector<std::string> names;
                               for (const RigRange& range : rig.description().ranges) {
                                 names.push_back(range.name);
                               }
                               return names;
                             })
      .def("__repr__", shows("Rig", {"name", "ranges"}));
}

}  // namespace

void bind_survey(py::module_& module) {
  bind_plate(module);
  bind_survey_class(module);
  bind_rig(module);
}

}  // namespace tagsmith::python
