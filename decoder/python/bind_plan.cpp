// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <tagsmith/plan.hpp>

#include "decoder/python/bindings.hpp"

namespace py = pybind11;

namespace tagsmith::python {
namespace {

void bind_plan_parts(py::module_& module) {
  py::class_<WallShares>(module, "WallShares", "Shares of all poses, 0 to 1.")
      .def_readonly("both", &WallShares::both)
      .def_readonly("one", &WallShares::one)
      .def_readonly("none", &WallShares::none)
      .def("__repr__", shows("WallShares", {"both", "one", "none"}));
  py::class_<Stretch>(module, "Stretch", "A part of the drive, chainages.")
      .def_readonly("start", &Stretch::from)
      .def_readonly("end", &Stretch::to)
      .def("__repr__", shows("Stretch", {"start", "end"}));
  py::class_<SigmaRange>(module, "SigmaRange", "Standard deviations over the poses.")
      .def_readonly("median", &SigmaRange::median)
      .def_readonly("high", &SigmaRange::high)
      .def_readonly("worst", &SigmaRange::worst)
      .def("__repr__", shows("SigmaRange", {"median", "high", "worst"}));
  py::class_<CriticalTag>(module, "CriticalTag", "A tag that some poses cannot do without.")
      .def_readonly("tag", &CriticalTag::tag)
      .def_readonly("length", &CriticalTag::length)
      .def_readonly("longest_gap", &CriticalTag::longest_gap)
      .def("__repr__", shows("CriticalTag", {"tag", "length"}));
}

PlanSummary plan_drive(const Survey& survey, const Rig& rig, std::optional<double> start,
                       std::optional<double> end, double step, int lateral_offsets, int headings,
                       std::optional<double> speed, std::optional<double> corner_sigma_px,
                       int jobs) {
  const py::gil_scoped_release others_run;
  return plan(survey, rig,
              {start, end, step, lateral_offsets, headings, speed, corner_sigma_px, jobs});
}

}  // namespace

void bind_plan(py::module_& module) {
  bind_plan_parts(module);
  py::class_<PlanSummary>(module, "PlanSummary", "What a drive will read, and how well.")
      .def_readonly("read", &PlanSummary::read)
      .def_readonly("read_plain", &PlanSummary::read_plain)
      .def_readonly("covered_share", &PlanSummary::covered_share)
      .def_readonly("gaps", &PlanSummary::gaps)
      .def_readonly("plane_sigma", &PlanSummary::plane_sigma)
      .def_readonly("height_sigma", &PlanSummary::height_sigma)
      .def_readonly("heading_sigma", &PlanSummary::heading_sigma)
      .def_readonly("worst_plane_sigma", &PlanSummary::worst_plane_sigma)
      .def_readonly("speed_all", &PlanSummary::speed_all)
      .def_readonly("speed_most", &PlanSummary::speed_most)
      .def_readonly("unread_tags", &PlanSummary::unread_tags)
      .def_readonly("covered_share_one_lost", &PlanSummary::covered_share_one_lost)
      .def_readonly("critical_tags", &PlanSummary::critical_tags)
      .def("__repr__",
           shows("PlanSummary", {"covered_share", "gaps", "plane_sigma", "unread_tags"}));
  const PlanOptions usual;
  module.def("plan", &plan_drive, py::arg("survey"), py::arg("rig"), py::kw_only(),
             py::arg("start") = py::none(), py::arg("end") = py::none(),
             py::arg("step") = usual.step, py::arg("lateral_offsets") = usual.lateral_offsets,
             py::arg("headings") = usual.headings, py::arg("speed") = py::none(),
             py::arg("corner_sigma_px") = py::none(), py::arg("jobs") = usual.jobs,
             "What the cameras will read along the drive from chainage start to end (metres; None "
             "= all of it), and how well the vehicle will know its place.");
}

}  // namespace tagsmith::python
