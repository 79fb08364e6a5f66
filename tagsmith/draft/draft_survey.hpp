// SPDX-License-Identifier: Apache-2.0
// Survey and rig files to start from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/draft/fit_tunnel.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/finding_log.hpp"
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
  std::optional<TagSeries> series;    // proposed, where no plate hangs yet
  std::optional<double> angle_sigma;  // as the list states it, radians
  bool of_export = false;             // the points are those of a survey, computed or not
};

// A layout to propose, metres.
struct LayoutWish {
  double height = 0;            // of P above the floor
  double spacing = 0;           // clear gap between neighbouring plates of one wall
  std::optional<double> first;  // chainage of the first left P
  std::optional<double> to;     // chainage up to which a left P may lie
};

// As many regular pairs as fit; without `first` and `to` from the begin of the surveyed walls to
// their end. Fails when not one pair fits.
Result<TagSeries> propose_series(const Tunnel& tunnel, const TagTemplate& tag,
                                 const LayoutWish& wish);

// Logs a warning where a bent shape is fitted to hardly more points across the drive than it needs:
// an error of one of them becomes a bend then, and shows nowhere. Elsewhere for each point that the
// fit follows alone.
void check_shape(const SurveyDraft& draft, FindingLog& log);

// Logs a warning for proposed plates where no point of the list shows their wall: beyond its first
// and last points, and where these are more than three times as far apart as usual.
void check_proposed(const SurveyDraft& draft, FindingLog& log);

// The tags among the points that have no name, numbered on each wall in the order of their
// chainages, from the first free pair on.
void number_tags(std::vector<SurveyedPoint>& points, const TunnelFit& fit);

// P of every tag of the draft, in the grid: surveyed ones, then those of the series.
std::vector<Eigen::Vector3d> tag_positions(const SurveyDraft& draft);

// A code for these positions (one at least): centimetres (or the next coarser of 2, 5, 10 ... where
// eleven digits do not reach), from a whole metre below them.
Result<PositionCode> code_for(const std::vector<Eigen::Vector3d>& positions, CheckDigit check);

// A part of a draft that was split.
struct DraftPart {
  SurveyDraft draft;  // its chainages begin anew
  double from = 0;    // chainages of the whole
  double to = 0;
};

// The draft in as few parts along the drive as have codes of one centimetre, named NAME-1, NAME-2
// and so on; pairs stay together, and no two tags of all parts have one code. Surveyed tags keep
// their names; a series begins anew in each part. Fails when a single pair spans too much, when no
// code distinguishes a part from the others, and where the list states digits.
Result<std::vector<DraftPart>> split_draft(const SurveyDraft& draft);

// The survey file of a draft. Positions of P are those of the list, to the micrometre.
std::string draft_survey(const SurveyDraft& draft);

}  // namespace tagsmith::detail
