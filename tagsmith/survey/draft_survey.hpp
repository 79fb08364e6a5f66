// SPDX-License-Identifier: Apache-2.0
// Survey and rig files to begin with.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/fit_tunnel.hpp"
#include "tagsmith/survey/point_list.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A straight drive with ten pairs, every key explained; reads without findings.
std::string survey_to_edit(const std::string& name);

// Two side cameras and an ultrasonic range, every key explained.
std::string rig_to_edit(const std::string& name);

struct SurveyDraft {
  std::string name;
  std::string source;  // of the points, for the comment
  std::string template_name;
  TagTemplate tag;  // of that name
  Grid grid;
  PositionCode code;
  TunnelFit fit;
  std::vector<SurveyedPoint> points;  // their tags become `placed`
};

// The tags among the points that have no name, numbered on each wall in the order of their
// chainages, from the first free pair on.
void number_tags(std::vector<SurveyedPoint>& points, const TunnelFit& fit);

// A code for these positions: centimetres (or the next coarser of 2, 5, 10 ... where eleven digits
// do not reach), from a whole metre below them.
Result<PositionCode> code_for(const std::vector<SurveyedPoint>& points, CheckDigit check);

// The survey file of a draft. Positions of P are those of the list, to the micrometre.
std::string draft_survey(const SurveyDraft& draft);

}  // namespace tagsmith::detail
