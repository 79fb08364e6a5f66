// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/fix.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tagsmith::detail {
namespace {

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

const char* to_string(Unchecked::Kind kind) {
  using enum Unchecked::Kind;
  switch (kind) {
    case plate_place:
      return "plate_place";
    case wall_places:
      return "wall_places";
    case plate_size:
      return "plate_size";
    case mounting:
      return "mounting";
    case lens:
      return "lens";
    case all_lenses:
      return "all_lenses";
    case range:
      return "range";
    case vehicle_height:
      return "vehicle_height";
    case all_mountings:
      return "all_mountings";
    case moment:
      return "moment";
    case survey_frame:
      return "survey_frame";
  }
  return "";
}

std::string to_string(const Unchecked& unchecked) {
  using enum Unchecked::Kind;
  switch (unchecked.kind) {
    case plate_place:
      return "the place of " + unchecked.name;
    case wall_places:
      return "the width of the tunnel or the spacing of the plates";
    case plate_size:
      return "the size of the plates";
    case mounting:
      return "the mounting of camera " + unchecked.name;
    case lens:
      return "the lens of camera " + unchecked.name;
    case all_lenses:
      return "the focal length of all cameras";
    case range:
      return "the range " + unchecked.name;
    case vehicle_height:
      return "the height of the vehicle";
    case all_mountings:
      return "the mounting of all cameras together";
    case moment:
      return "the moment of all photos";
    case survey_frame:
      return "the place of the survey as a whole";
  }
  return {};
}

std::string status_of(const Fix& fix) { return fix.position_in_grid ? "ok" : "no_position"; }

Fix if_confirmed(Fix fix) {
  if (!fix.position_in_grid || fix.confirmations > 0) return fix;
  Fix none;
  none.id = fix.id;
  none.method = fix.method;
  none.survey = fix.survey;
  none.tags = fix.tags;
  none.dropped = fix.dropped;
  none.reason = fix.tags.empty()
                    ? "predicted from the motion, which nothing confirms"
                    : fmt::format("nothing confirms what {} says: a wrong plate would go unnoticed",
                                  fmt::join(fix.tags, " "));
  return none;
}

std::optional<FixError> error_of(const Fix& fix, const Measurement& measurement) {
  if (!fix.position_in_grid || !measurement.truth_in_grid) return std::nullopt;
  const Eigen::Vector3d error = *fix.position_in_grid - *measurement.truth_in_grid;
  return FixError{std::hypot(error.x(), error.y()), std::abs(error.z())};
}

FixSummary summarize(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements) {
  assert(fixes.size() == measurements.size());
  FixSummary summary;
  std::vector<double> planes;
  std::vector<double> heights;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    ++summary.count;
    if (fixes[i].position_in_grid) ++summary.located;
    if (fixes[i].position_in_grid && fixes[i].confirmations > 0) ++summary.confirmed;
    const std::optional<FixError> error = error_of(fixes[i], measurements[i]);
    if (!error) continue;
    planes.push_back(error->plane);
    heights.push_back(error->height);
  }
  if (planes.empty()) return summary;
  std::ranges::sort(planes);
  std::ranges::sort(heights);
  summary.mean_error = FixError{mean_of(planes), mean_of(heights)};
  // Nearest rank: the least value that 95 % do not exceed.
  const std::size_t rank = (95 * planes.size() + 99) / 100;
  summary.error95 = FixError{planes[rank - 1], heights[rank - 1]};
  summary.max_error = FixError{planes.back(), heights.back()};
  return summary;
}

}  // namespace tagsmith::detail
