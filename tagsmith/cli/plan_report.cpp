// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/plan_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
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

std::string sigma_text(const std::optional<SigmaRange>& range) {
  if (!range) return "no position anywhere";
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
  const double step = drive.plan.options.step;
  double all = 0;
  for (const Stretch& gap : summary.gaps) all += gap.length() + step;
  std::string text = fmt::format("{}, {} in all; the longest {}", summary.gaps.size(), metres(all),
                                 stretch(*summary.longest_gap));
  return text;
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
  return std::ranges::any_of(rig.cameras,
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
  if (!has_exposure(drive.rig)) {
    return "not known: the rig's cameras have no exposure; during it the vehicle may move " +
           limit_text(drive.summary.travel_all, drive.summary.travel_most, "mm", 1000);
  }
  return limit_text(drive.summary.speed_all, drive.summary.speed_most, "m/s", 1);
}

std::string exposure_text(const PlannedDrive& drive) {
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
  std::string text =
      fmt::format("{} with {}: chainage {:.2f} to {:.2f} m every {} m, {} pose{} each",
                  drive.survey.name, drive.rig.name, plan.columns.front().chainage,
                  plan.columns.back().chainage, format_number(plan.options.step, 4),
                  plan.poses_per_column, plan.poses_per_column == 1 ? "" : "s");
  if (!drive.rig.envelope) return text + " (the rig has no envelope: only the center line)";
  text += fmt::format(" (up to {} m and {} deg to either side", format_number(envelope.lateral, 3),
                      format_number(degrees(envelope.yaw), 2));
  if (envelope.roll > 0)
    text += fmt::format(", roll {} deg", format_number(degrees(envelope.roll), 2));
  if (envelope.pitch > 0) {
    text += fmt::format(", pitch {} deg", format_number(degrees(envelope.pitch), 2));
  }
  return text + fmt::format("), {}", plan.speed > 0
                                         ? fmt::format("at {} m/s", format_number(plan.speed, 3))
                                         : "standing still");
}

std::vector<PlanAnswer> plan_answers(const PlannedDrive& drive) {
  const PlanSummary& summary = drive.summary;
  std::vector<PlanAnswer> answers;
  answers.push_back(
      {"whole envelope",
       fmt::format("a position along {} of the drive, tags on both walls along {}",
                   percent(summary.covered_share), percent(summary.wall_pair_share))});
  answers.push_back({"gaps", gaps_text(drive)});
  if (drive.plan.options.accuracy) {
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

}  // namespace tagsmith::detail
