// SPDX-License-Identifier: Apache-2.0
// Localization, batch and live.
#include <deque>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <tagsmith/localize.hpp>

#include "decoder/python/bindings.hpp"

namespace py = pybind11;

namespace tagsmith::python {
namespace {

// A measurement and the pictures that were loaded for it.
struct Seen {
  Measurement measurement;
  std::deque<Picture> pictures;
};

using Images = std::map<std::string, py::object>;

// Tags by camera: objects with digits, corners and perhaps corner_covariance, as Tag.
std::vector<SeenTag> tags_from(const Images& tags) {
  std::vector<SeenTag> seen;
  for (const auto& [camera, list] : tags) {
    for (const py::handle one : py::iter(list)) {
      const py::object digits = one.attr("digits");
      if (!py::isinstance<py::str>(digits)) refuse_type("digits", digits, "a str of twelve");
      SeenTag tag{camera, py::cast<std::string>(digits), corners_from(one.attr("corners")),
                  std::nullopt};
      const py::object covariance = py::getattr(one, "corner_covariance", py::none());
      if (!covariance.is_none()) tag.covariance = covariance_from(covariance);
      seen.push_back(std::move(tag));
    }
  }
  return seen;
}

Seen seen_from(const Images& images, const std::map<std::string, double>& ranges,
               const Images& tags, const std::string& id, std::optional<double> time) {
  Seen seen;
  seen.measurement = {id, {}, tags_from(tags), ranges, time};
  for (const auto& [camera, image] : images) {
    seen.pictures.push_back(picture_from(image));
    seen.measurement.images.push_back({camera, seen.pictures.back().view});
  }
  return seen;
}

Fix locate(const Localizer& localizer, const Images& images,
           const std::map<std::string, double>& ranges, const Images& tags, const std::string& id) {
  const Seen seen = seen_from(images, ranges, tags, id, std::nullopt);
  const py::gil_scoped_release others_run;
  return localizer.locate(seen.measurement);
}

Fix track(Localizer& localizer, double time, const Images& images,
          const std::map<std::string, double>& ranges, const Images& tags, const std::string& id) {
  const Seen seen = seen_from(images, ranges, tags, id, time);
  const py::gil_scoped_release others_run;
  return localizer.track(seen.measurement);
}

void bind_fix_parts(py::module_& module) {
  py::class_<Attitude>(module, "Attitude", "How the vehicle stands, radians.")
      .def_readonly("heading", &Attitude::heading)
      .def_readonly("pitch", &Attitude::pitch)
      .def_readonly("roll", &Attitude::roll)
      .def("__repr__", shows("Attitude", {"heading", "pitch", "roll"}));
  py::class_<Dropped>(module, "Dropped", "A tag or range that contradicts the position.")
      .def_readonly("name", &Dropped::name)
      .def_readonly("camera", &Dropped::camera)
      .def_readonly("reason", &Dropped::reason)
      .def("__repr__", shows("Dropped", {"name", "camera", "reason"}));
  py::class_<Unchecked>(module, "Unchecked", "A mistake that would go unnoticed.")
      .def_readonly("kind", &Unchecked::kind)
      .def_readonly("name", &Unchecked::name)
      .def_readonly("metres", &Unchecked::metres)
      .def("__repr__", shows("Unchecked", {"kind", "name", "metres"}));
}

void bind_fix(py::module_& module) {
  py::class_<Fix>(module, "Fix", "The vehicle's centre O at one measurement, in the survey's grid.")
      .def_readonly("id", &Fix::id)
      .def_property_readonly("position", as_array(&Fix::position),
                             "x, y, z in metres; None = there is none, and `reason` says why.")
      .def_property_readonly("covariance", as_array(&Fix::covariance))
      .def_readonly("attitude", &Fix::attitude)
      .def_property_readonly("pose_covariance", as_array(&Fix::pose_covariance),
                             "6 x 6: x, y, z, heading, pitch, roll.")
      .def_readonly("reason", &Fix::reason)
      .def_readonly("survey", &Fix::survey)
      .def_readonly("tags", &Fix::tags)
      .def_readonly("ranges", &Fix::ranges)
      .def_readonly("dropped", &Fix::dropped)
      .def_readonly("confirmations", &Fix::confirmations)
      .def_readonly("chi_square", &Fix::chi_square)
      .def_readonly("degrees_of_freedom", &Fix::degrees_of_freedom)
      .def_readonly("unchecked", &Fix::unchecked)
      .def_readonly("notes", &Fix::notes)
      .def("__repr__", shows("Fix", {"id", "position", "tags", "confirmations", "reason"}));
}

}  // namespace

void bind_localize(py::module_& module) {
  bind_fix_parts(module);
  bind_fix(module);
  py::class_<Localizer>(module, "Localizer",
                        "Locates measurements of a rig among the tags of one or more surveys.\n\n"
                        "images: by camera, a uint8 array of the camera's size or a path. tags: by "
                        "camera, what was read before (Tag). ranges: metres by sensor.")
      .def(py::init([](const py::object& surveys, const Rig& rig, bool confirmed_only) {
             return Localizer(surveys_from("surveys", surveys), rig, {confirmed_only});
           }),
           py::arg("surveys"), py::arg("rig"), py::kw_only(), py::arg("confirmed_only") = false)
      .def("locate", &locate, py::arg("images") = Images{}, py::kw_only(),
           py::arg("ranges") = std::map<std::string, double>{}, py::arg("tags") = Images{},
           py::arg("id") = "", "The position by this measurement alone.")
      .def("track", &track, py::arg("time"), py::arg("images") = Images{}, py::kw_only(),
           py::arg("ranges") = std::map<std::string, double>{}, py::arg("tags") = Images{},
           py::arg("id") = "",
           "The position while the vehicle drives, at a time in seconds: by the motion so far too. "
           "One thread at a time.")
      .def("reset", &Localizer::reset, "Forgets the motion.");
}

}  // namespace tagsmith::python
