// SPDX-License-Identifier: Apache-2.0
#include <tagsmith/plan.hpp>

#include "decoder/api/data.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/plan_summary.hpp"

namespace tagsmith {
namespace {

using detail::check_number;

void check_odd(const std::string& name, int count) {
  check_number(name, count, 1, 101);
  if (count % 2 == 0) detail::throw_invalid(name + " is even, expected an odd number");
}

detail::PlanOptions options_from(const PlanOptions& options) {
  constexpr double kFarthest = 1e6;
  if (options.from) check_number("from", *options.from, -kFarthest, kFarthest);
  if (options.to) check_number("to", *options.to, -kFarthest, kFarthest);
  check_number("step", options.step, 1e-4, 1000);
  check_odd("lateral_offsets", options.lateral_offsets);
  check_odd("headings", options.headings);
  if (options.speed) check_number("speed", *options.speed, 0, 100);
  if (options.corner_sigma_px) check_number("corner_sigma_px", *options.corner_sigma_px, 1e-4, 100);
  check_number("jobs", options.jobs, 0, 100'000);
  detail::PlanOptions plan;
  plan.from = options.from;
  plan.to = options.to;
  plan.step = options.step;
  plan.lateral_offsets = options.lateral_offsets;
  plan.headings = options.headings;
  plan.speed = options.speed;
  plan.corner_sigma_px = options.corner_sigma_px;
  plan.jobs = options.jobs;
  return plan;
}

WallShares shares_from(const detail::WallShare& share) {
  return {share.both, share.one, share.none};
}

Stretch stretch_from(const detail::Stretch& stretch) { return {stretch.from, stretch.to}; }

std::optional<SigmaRange> range_from(const std::optional<detail::SigmaRange>& range) {
  if (!range) return std::nullopt;
  return SigmaRange{range->median, range->high, range->worst};
}

PlanSummary summary_from(const detail::PlanSummary& plan, const detail::Survey& survey) {
  PlanSummary summary;
  summary.read = shares_from(plan.read);
  summary.read_plain = shares_from(plan.read_plain);
  summary.covered_share = plan.covered_share;
  for (const detail::Stretch& gap : plan.gaps) summary.gaps.push_back(stretch_from(gap));
  summary.plane_sigma = range_from(plan.nominal_plane);
  summary.height_sigma = range_from(plan.nominal_height);
  summary.heading_sigma = range_from(plan.nominal_heading);
  summary.worst_plane_sigma = range_from(plan.worst_plane);
  summary.speed_all = plan.speed_all;
  summary.speed_most = plan.speed_most;
  for (const std::size_t tag : plan.unread_tags) {
    summary.unread_tags.push_back(survey.tags[tag].name);
  }
  summary.covered_share_one_lost = plan.covered_share_one_lost;
  for (const detail::CriticalTag& one : plan.critical_tags) {
    summary.critical_tags.push_back(
        {survey.tags[one.tag].name, one.length, stretch_from(one.longest_gap)});
  }
  return summary;
}

}  // namespace

PlanSummary plan(const Survey& survey, const Rig& rig, const PlanOptions& options) {
  const detail::Survey& planned = survey.data().survey;
  const auto drive = detail::plan_drive(planned, rig.data().rig, options_from(options));
  if (!drive) throw Error(ErrorCode::failed, drive.error().message);
  return summary_from(summarize(*drive), planned);
}

}  // namespace tagsmith
