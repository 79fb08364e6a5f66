// SPDX-License-Identifier: Apache-2.0
// A plan in words, as JSON, and as a web page.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/plan_summary.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A plan and its input.
struct PlannedDrive {
  const Survey& survey;
  const Rig& rig;
  const DrivePlan& plan;
  const PlanSummary& summary;
};

// A finding: the requirement, and the plan's answer.
struct PlanAnswer {
  std::string question;
  std::string answer;
};

// The answers in the order in which people ask, for the report and the page.
std::vector<PlanAnswer> plan_answers(const PlannedDrive& drive);

// What was planned: drive, envelope, speed, number of poses.
std::string plan_heading(const PlannedDrive& drive);

// What survey and rig do not state and the plan assumes, in sentences.
std::vector<std::string> plan_assumptions(const PlannedDrive& drive);

// Several lines, ended by a line feed.
std::string plan_report(const PlannedDrive& drive);

// One JSON object on one line (docs/formats.md).
std::string plan_json(const PlannedDrive& drive);

// Answers, map and profile as one page: HTML with its styles, data and script inside; opens without
// a network, on a phone as well.
std::string plan_page(const PlannedDrive& drive);

}  // namespace tagsmith::detail
