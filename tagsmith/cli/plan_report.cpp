// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/plan_report.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {

// ---- In words.

namespace {

constexpr std::size_t kMostListed = 5;

std::string metres(double value) { return fmt::format("{:.2f} m", value); }

// Lengths from a tenth of a millimetre to metres.
std::string short_length(double value) {
  if (!std::isfinite(value)) return "none";
  return value < 0.1 ? fmt::format("{:.1f} mm", 1000 * value) : fmt::format("{:.2f} m", value);
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string stretch(const Stretch& part) {
  return fmt::format("{:.2f} to {:.2f} m", part.from, part.to);
}

constexpr const char* kNoPosition = "no position anywhere";

std::string sigma_text(const std::optional<SigmaRange>& range) {
  if (!range) return kNoPosition;
  return fmt::format("median {}, {} for 95 %, {} at worst", short_length(range->median),
                     short_length(range->high), short_length(range->worst));
}

std::string angle_text(const SigmaRange& range) {
  return fmt::format("median {:.3f} deg, {:.3f} deg at worst", degrees(range.median),
                     degrees(range.worst));
}

std::string gaps_text(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  if (summary.gaps.empty()) return "none: every pose has a position";
  const double last = drive.plan.columns.back().chainage;
  double all = 0;  // each up to the next pose, if there is one
  for (const Stretch& gap : summary.gaps) {
    all += std::min(gap.to + drive.plan.options.step, last) - gap.from;
  }
  return fmt::format("{}, {} in all; the longest {}", summary.gaps.size(), metres(all),
                     stretch(*summary.longest_gap));
}

std::string first_reading_text(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  std::string text =
      summary.first_reading
          ? fmt::format("{} to {} from the camera, median {}", metres(summary.first_reading->least),
                        metres(summary.first_reading->most), metres(summary.first_reading->median))
          : "no tag comes into reach on the way";
  if (summary.unread_tags.empty()) return text;
  text += fmt::format("; never read from the center line: {}", summary.unread_tags.size());
  for (std::size_t i = 0; i < std::min(kMostListed, summary.unread_tags.size()); ++i) {
    text += (i == 0 ? " (" : " ") + drive.survey.tags[summary.unread_tags[i]].name;
  }
  return text + (summary.unread_tags.size() > kMostListed ? " ...)" : ")");
}

std::string confirmed_text(const PlanSummary& summary) {
  return fmt::format(
      "a second tag, whole or cut by the picture's border, confirms the position along {} of the "
      "drive; whole tags alone along {}",
      percent(summary.confirmed_share), percent(summary.covered_share_one_lost));
}

std::string one_lost_text(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  const std::string share = percent(summary.covered_share_one_lost) +
                            " of the drive keeps a position after the loss of any one tag";
  if (summary.critical_tags.empty()) {
    return summary.covered_share_one_lost > 0 ? share + ": no tag is indispensable" : share;
  }
  const CriticalTag& worst = summary.critical_tags.front();
  return fmt::format(
      "{}; {} indispensable somewhere, most of all {}: without it "
      "{} more has gaps, the longest {}",
      share,
      summary.critical_tags.size() == 1 ? "1 tag is"
                                        : fmt::format("{} tags are", summary.critical_tags.size()),
      drive.survey.tags[worst.tag].name, metres(worst.length), stretch(worst.longest_gap));
}

bool has_exposure(const Rig& rig) {
  return std::ranges::all_of(rig.cameras,
                             [](const auto& camera) { return camera.exposure.has_value(); });
}

std::string limit_text(double all, double most, const char* unit, double scale) {
  const auto value = [&](double number) {
    return std::isfinite(number) ? fmt::format("{:.2f} {}", scale * number, unit) : "no limit";
  };
  return fmt::format("{} for every pose that has a position standing still, {} for 99 %",
                     value(all), value(most));
}

std::string speed_text(const PlannedDrive& drive) {
  if (!std::isfinite(drive.summary.travel_all)) return kNoPosition;
  if (!has_exposure(drive.rig)) {
    return "not known: not every camera of the rig states its exposure; during it the vehicle may "
           "move " +
           limit_text(drive.summary.travel_all, drive.summary.travel_most, "mm", 1000);
  }
  return limit_text(drive.summary.speed_all, drive.summary.speed_most, "m/s", 1);
}

std::string exposure_text(const PlannedDrive& drive) {
  if (!std::isfinite(drive.summary.travel_all)) return kNoPosition;
  if (drive.plan.speed <= 0) return "any, standing still; --speed plans for a speed";
  return fmt::format("at {:.2f} m/s at most {}", drive.plan.speed,
                     limit_text(drive.summary.travel_all / drive.plan.speed,
                                drive.summary.travel_most / drive.plan.speed, "ms", 1000));
}

std::string paper_text(const PaperSummary& paper) {
  const std::string errors =
      paper.plane
          ? fmt::format("errors in the plane of {}, in height of {} (medians); ",
                        short_length(paper.plane->median), short_length(paper.height->median))
          : std::string();
  return fmt::format(
      "a pair of tags along {} of the drive; 1/tan(theta) = {:.2f}: an error of d moves the place "
      "{:.2f} times as far along the tunnel; {}{} of measurements have no solution",
      percent(paper.share), paper.magnification, paper.magnification, errors,
      percent(paper.no_solution_share));
}

std::string coverage_row(const std::string& name, const WallShare& share) {
  return fmt::format("{:<22}{:>9}{:>12}{:>10}{:>9}\n", name, percent(share.both + share.one),
                     percent(share.both), percent(share.one), percent(share.none));
}

std::string view_text(const TagView& view) {
  return fmt::format("{:8.2f} {:8.2f} {:6.2f} {:6.1f}", view.chainage, view.distance,
                     view.module_px, degrees(view.incidence));
}

std::string tag_table_text(const PlannedDrive& drive) {
  constexpr std::size_t kMostRows = 40;
  const std::vector<TagUse>& uses = drive.plan.tags;
  if (uses.size() > kMostRows) {
    return fmt::format(
        "{} tags: how each is first and last read is in plan.html of --output, and in --json\n",
        uses.size());
  }
  constexpr const char* kHead = "      at distance     px  angle";
  std::string text = fmt::format("{:<8}{:<29}   {}\n{:<8}{}   {}\n", "tag", "first read",
                                 "last read", "", kHead, kHead);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    text += fmt::format("{:<8}{}\n", drive.survey.tags[i].name,
                        uses[i].is_read ? view_text(uses[i].first) + "   " + view_text(uses[i].last)
                                        : "never read");
  }
  return text +
         "From the center line: chainage of the vehicle and distance from the camera in metres, "
         "pixels a module, degrees to the plate's normal.\n";
}

}  // namespace

std::string plan_heading(const PlannedDrive& drive) {
  const DrivePlan& plan = drive.plan;
  const VehicleEnvelope envelope = drive.rig.envelope.value_or(VehicleEnvelope{});
  std::string text = fmt::format("{} with {}: chainage {:.2f} to {:.2f} m every {} m, {} each",
                                 drive.survey.name, drive.rig.name, plan.columns.front().chainage,
                                 plan.columns.back().chainage, format_number(plan.options.step, 4),
                                 counted(static_cast<std::size_t>(plan.poses_per_column), "pose"));
  const std::string at_speed =
      plan.speed > 0 ? fmt::format("at {} m/s", format_number(plan.speed, 3)) : "standing still";
  if (!drive.rig.envelope) {
    return text + " (the rig has no envelope: only the center line), " + at_speed;
  }
  if (plan.poses_per_column == 1) return text + " (only the center line), " + at_speed;
  text += fmt::format(" (up to {} m and {} deg to either side", format_number(envelope.lateral, 3),
                      format_number(degrees(envelope.yaw), 2));
  if (envelope.roll > 0)
    text += fmt::format(", roll {} deg", format_number(degrees(envelope.roll), 2));
  if (envelope.pitch > 0) {
    text += fmt::format(", pitch {} deg", format_number(degrees(envelope.pitch), 2));
  }
  return text + "), " + at_speed;
}

std::vector<std::string> plan_assumptions(const PlannedDrive& drive) {
  std::vector<std::string> all =
      assumptions(std::span(&drive.survey, 1), drive.rig, drive.plan.options.speed);
  const auto add = [&](const char* key, const auto& is_stated, const std::string& assumed) {
    std::vector<std::string> unstated;
    for (const RigCamera& camera : drive.rig.cameras) {
      if (!is_stated(camera)) unstated.push_back(camera.name);
    }
    if (unstated.empty()) return;
    all.push_back(fmt::format("rig {} states no {} of camera {}: {} assumed", drive.rig.name, key,
                              fmt::join(unstated, ", "), assumed));
  };
  add(
      "blur_px", [](const RigCamera& camera) { return camera.blur_px.has_value(); },
      format_number(kUsualBlurPx) + " pixel");
  if (const double speed = drive.plan.speed; speed > 0) {
    add(
        "exposure", [](const RigCamera& camera) { return camera.exposure.has_value(); },
        fmt::format("pictures as sharp at {} m/s as standing still", format_number(speed)));
  }
  return all;
}

std::vector<PlanAnswer> plan_answers(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  std::vector<PlanAnswer> answers;
  answers.push_back(
      {drive.plan.poses_per_column == 1 ? "center line" : "whole envelope",
       fmt::format("a position along {} of the drive, tags on both walls along {}",
                   percent(summary.covered_share), percent(summary.wall_pair_share))});
  answers.push_back({"gaps", gaps_text(drive)});
  answers.push_back({"position, plane", sigma_text(summary.nominal_plane)});
  if (summary.nominal_height) {
    answers.push_back({"position, height", sigma_text(summary.nominal_height)});
    answers.push_back({"heading", angle_text(*summary.nominal_heading)});
    answers.push_back({"plane, any pose", sigma_text(summary.worst_plane)});
  }
  if (summary.worst_stretch) {
    answers.push_back({"worst stretch", fmt::format("{}: plane {} at the worst pose",
                                                    stretch(*summary.worst_stretch),
                                                    short_length(summary.worst_stretch_sigma))});
  }
  answers.push_back({"a tag is first read", first_reading_text(drive)});
  answers.push_back({"confirmed", confirmed_text(summary)});
  answers.push_back({"one tag lost", one_lost_text(drive)});
  if (summary.one_lost_plane) {
    answers.push_back({"plane, one tag lost", sigma_text(summary.one_lost_plane)});
  }
  answers.push_back({"fastest speed", speed_text(drive)});
  answers.push_back({"exposure needed", exposure_text(drive)});
  if (summary.paper) answers.push_back({"the paper's method", paper_text(*summary.paper)});
  return answers;
}

std::string plan_report(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  std::string text = plan_heading(drive) + "\n\n";
  text += fmt::format("{:<22}{:>9}{:>12}{:>10}{:>9}\n", "share of the poses", "any tag",
                      "both walls", "one wall", "none");
  text += coverage_row("tag seen whole", summary.seen);
  text += coverage_row("read without survey", summary.read_plain);
  text += coverage_row("read with the survey", summary.read);
  text += "\n";
  for (const PlanAnswer& answer : plan_answers(drive)) {
    text += fmt::format("{:<20}{}\n", answer.question, answer.answer);
  }
  return text + "\n" + tag_table_text(drive);
}

// ---- As JSON.

namespace {

// To the micrometre: profiles are long.
Json rounded(double value) { return finite_or_null(with_decimals(value, 6)); }

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
          {"worst_stretch_plane",
           summary.worst_stretch ? Json(summary.worst_stretch_sigma) : Json(nullptr)}};
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
  json["assumed"] = plan_assumptions(drive);
  json["coverage"] = {{"seen", json_of(summary.seen)},
                      {"read_without_code_book", json_of(summary.read_plain)},
                      {"read", json_of(summary.read)}};
  json["covered_share"] = summary.covered_share;
  json["both_walls_share"] = summary.wall_pair_share;
  json["confirmed_share"] = summary.confirmed_share;
  json["gaps"] = json_list(summary.gaps, [](const Stretch& gap) { return json_of(gap); });
  json["longest_gap"] = json_of(summary.longest_gap);
  json["accuracy"] = accuracy(summary);
  json["paper"] = paper(summary.paper);
  json["first_reading"] = json_of(summary.first_reading);
  json["one_tag_lost"] = one_tag_lost(drive);
  json["travel_during_exposure"] = {{"all", finite_or_null(summary.travel_all)},
                                    {"p99", finite_or_null(summary.travel_most)}};
  json["fastest_speed"] = {{"all", finite_or_null(summary.speed_all)},
                           {"p99", finite_or_null(summary.speed_most)}};
  json["longest_exposure"] = {
      {"all", plan.speed > 0 ? finite_or_null(summary.travel_all / plan.speed) : Json(nullptr)},
      {"p99", plan.speed > 0 ? finite_or_null(summary.travel_most / plan.speed) : Json(nullptr)}};
  json["tags"] = tags(drive);
  json["profile"] = profile_json(plan);
  return json_text(json);
}

}  // namespace tagsmith::detail
