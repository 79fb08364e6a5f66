// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/plan_report.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity: null stands for "none".
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

// To the micrometre: profiles are long.
Json rounded(double value) {
  return std::isfinite(value) ? Json(with_decimals(value, 6)) : Json(nullptr);
}

Json json_of(const WallShare& share) {
  return {{"both", share.both}, {"one", share.one}, {"none", share.none}};
}

Json json_of(const Stretch& stretch) { return Json::array({stretch.from, stretch.to}); }

Json json_of(const SigmaRange& range) {
  return {{"median", range.median}, {"p95", range.high}, {"max", range.worst}};
}

Json json_of(const ReadingDistances& distances) {
  return {{"min", distances.least}, {"median", distances.median}, {"max", distances.most}};
}

template <class T>
Json json_of(const std::optional<T>& value) {
  return value ? json_of(*value) : Json(nullptr);
}

Json json_in_degrees(const std::optional<SigmaRange>& range) {
  if (!range) return nullptr;
  return json_of(SigmaRange{degrees(range->median), degrees(range->high), degrees(range->worst)});
}

Json accuracy(const PlanSummary& summary) {
  return {{"plane", json_of(summary.nominal_plane)},
          {"height", json_of(summary.nominal_height)},
          {"heading_deg", json_in_degrees(summary.nominal_heading)},
          {"plane_any_pose", json_of(summary.worst_plane)},
          {"plane_one_tag_lost", json_of(summary.one_lost_plane)},
          {"worst_stretch", json_of(summary.worst_stretch)},
          {"worst_stretch_plane", summary.worst_stretch_sigma}};
}

Json paper(const std::optional<PaperSummary>& paper) {
  if (!paper) return nullptr;
  return {{"pair_share", paper->share},
          {"magnification", paper->magnification},
          {"no_solution_share", paper->no_solution_share},
          {"plane", json_of(paper->plane)},
          {"height", json_of(paper->height)}};
}

Json one_tag_lost(const PlannedDrive& drive) {
  Json tags = Json::array();
  for (const CriticalTag& critical : drive.summary.critical_tags) {
    tags.push_back({{"tag", drive.survey.tags[critical.tag].name},
                    {"length", critical.length},
                    {"gap", json_of(critical.longest_gap)}});
  }
  return {{"covered_share", drive.summary.covered_share_one_lost}, {"indispensable", tags}};
}

Json json_of(const TagView& view) {
  return {{"distance", rounded(view.distance)},
          {"module_px", rounded(view.module_px)},
          {"incidence_deg", rounded(degrees(view.incidence))}};
}

Json tags(const PlannedDrive& drive) {
  Json list = Json::array();
  for (std::size_t i = 0; i < drive.plan.tags.size(); ++i) {
    const TagUse& use = drive.plan.tags[i];
    Json tag{{"tag", drive.survey.tags[i].name}, {"read", use.is_read}};
    tag["from"] = use.is_read ? Json(use.first.chainage) : Json(nullptr);
    tag["to"] = use.is_read ? Json(use.last.chainage) : Json(nullptr);
    tag["first_distance"] = use.is_read ? Json(use.first.distance) : Json(nullptr);
    tag["first_read"] = use.is_read ? json_of(use.first) : Json(nullptr);
    tag["last_read"] = use.is_read ? json_of(use.last) : Json(nullptr);
    list.push_back(tag);
  }
  return list;
}

Json profile_json(const DrivePlan& plan) {
  const auto list = [&](const auto& value) { return json_list(plan.columns, value); };
  return {{"chainage", list([](const auto& c) { return rounded(c.chainage); })},
          {"read_both", list([](const auto& c) { return Json(c.read.both); })},
          {"read_one", list([](const auto& c) { return Json(c.read.one); })},
          {"least_tags", list([](const auto& c) { return Json(c.least_tags); })},
          {"plane", list([](const auto& c) { return rounded(c.nominal.plane); })},
          {"along", list([](const auto& c) { return rounded(c.nominal.along); })},
          {"across", list([](const auto& c) { return rounded(c.nominal.across); })},
          {"height", list([](const auto& c) { return rounded(c.nominal.height); })},
          {"heading_deg", list([](const auto& c) { return rounded(degrees(c.nominal.heading)); })},
          {"plane_any_pose", list([](const auto& c) { return rounded(c.worst.plane); })},
          {"paper_plane", list([](const auto& c) { return rounded(c.paper.sigma.plane); })}};
}

}  // namespace

std::string plan_json(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  const DrivePlan& plan = drive.plan;
  const VehicleEnvelope envelope = drive.rig.envelope.value_or(VehicleEnvelope{});
  Json json;
  json["survey"] = drive.survey.name;
  json["rig"] = drive.rig.name;
  json["from"] = plan.columns.front().chainage;
  json["to"] = plan.columns.back().chainage;
  json["step"] = plan.options.step;
  json["poses_per_step"] = plan.poses_per_column;
  json["envelope"] = {{"lateral", envelope.lateral},
                      {"yaw_deg", degrees(envelope.yaw)},
                      {"roll_deg", degrees(envelope.roll)},
                      {"pitch_deg", degrees(envelope.pitch)}};
  json["speed"] = plan.speed;
  json["assumed"] = assumptions(std::span(&drive.survey, 1), drive.rig);
  json["coverage"] = {{"seen", json_of(summary.seen)},
                      {"read_without_code_book", json_of(summary.read_plain)},
                      {"read", json_of(summary.read)}};
  json["covered_share"] = summary.covered_share;
  json["both_walls_share"] = summary.wall_pair_share;
  json["confirmed_share"] = summary.confirmed_share;
  json["gaps"] = json_list(summary.gaps, [](const Stretch& gap) { return json_of(gap); });
  json["longest_gap"] = json_of(summary.longest_gap);
  json["accuracy"] = plan.options.accuracy ? accuracy(summary) : Json(nullptr);
  json["paper"] = paper(summary.paper);
  json["first_reading"] = json_of(summary.first_reading);
  json["one_tag_lost"] = one_tag_lost(drive);
  json["travel_during_exposure"] = {{"all", number(summary.travel_all)},
                                    {"p99", number(summary.travel_most)}};
  json["fastest_speed"] = {{"all", number(summary.speed_all)}, {"p99", number(summary.speed_most)}};
  json["longest_exposure"] = {
      {"all", plan.speed > 0 ? number(summary.travel_all / plan.speed) : Json(nullptr)},
      {"p99", plan.speed > 0 ? number(summary.travel_most / plan.speed) : Json(nullptr)}};
  json["tags"] = tags(drive);
  json["profile"] = profile_json(plan);
  return json_text(json);
}

}  // namespace tagsmith::detail
