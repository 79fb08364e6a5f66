// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/fix.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/observation_model.hpp"

namespace tagsmith::detail {

// ---- Fixes.

namespace {

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// The name of a kind of mistake in JSON, and its name in a sentence, where the name of the object
// concerned follows.
struct KindWords {
  const char* kind;
  const char* mistake;
};

// In the order of the kinds.
constexpr auto kKindWords = std::to_array<KindWords>({
    {"plate_place", "the place of "},
    {"wall_places", "the width of the tunnel or the spacing of the plates"},
    {"wall_shift", "a common shift of the plates of one wall: "},
    {"wall_turn", "a common lean or slope of the plates"},
    {"plate_size", "the size of the plates"},
    {"mounting", "the mounting of camera "},
    {"lens", "the lens of camera "},
    {"all_lenses", "the lenses of all cameras"},
    {"rolling_shutter", "a rolling shutter of cameras whose readout is not stated"},
    {"range", "the range "},
    {"vehicle_height", "the height of the vehicle"},
    {"all_mountings", "the mounting of all cameras together"},
    {"moment", "the moment of all photos"},
    {"survey_frame", "the place of the survey as a whole"},
});
static_assert(kKindWords.size() == static_cast<std::size_t>(Unchecked::Kind::survey_frame) + 1);

const KindWords& words_of(Unchecked::Kind kind) {
  return kKindWords[static_cast<std::size_t>(kind)];
}

}  // namespace

const char* to_string(Unchecked::Kind kind) { return words_of(kind).kind; }

std::string to_string(const Unchecked& unchecked) {
  const bool of_one_wall = unchecked.kind == Unchecked::Kind::wall_turn && !unchecked.name.empty();
  return words_of(unchecked.kind).mistake + (of_one_wall ? " of one wall: " : std::string()) +
         unchecked.name;
}

std::string status_of(const Fix& fix) { return fix.position_in_grid ? "ok" : "no_position"; }

std::string tag_of_survey(const std::string& survey, const std::string& tag) {
  return survey + "/" + tag;
}

std::vector<std::string> unique_tags(const Fix& fix) {
  std::vector<std::string> tags;
  for (const std::string& tag : fix.tags) {
    tags.push_back(tag.find('/') != std::string::npos ? tag : tag_of_survey(fix.survey, tag));
  }
  return tags;
}

const Survey& survey_of(const Fix& fix, const std::vector<Survey>& surveys) {
  const auto found = std::ranges::find(surveys, fix.survey, &Survey::name);
  return found == surveys.end() ? surveys.front() : *found;
}

Pose world_from_vehicle(const Fix& fix, const Grid& grid) {
  return world_from_vehicle({world_from_grid(grid, *fix.position_in_grid),
                             world_heading_from_grid(grid, fix.attitude->heading),
                             fix.attitude->pitch, fix.attitude->roll});
}

std::string note_of_doubt(const std::string& why) { return "do not rely on this position: " + why; }

Fix doubted(Fix fix, std::string why) {
  if (!fix.position_in_grid) return fix;
  fix.doubt = std::move(why);
  fix.confirmations = 0;
  fix.notes.push_back(note_of_doubt(fix.doubt));
  return fix;
}

Fix if_confirmed(Fix fix) {
  if (!fix.position_in_grid || fix.confirmations > 0) return fix;
  Fix none;
  none.id = fix.id;
  none.method = fix.method;
  none.survey = fix.survey;
  none.tags = fix.tags;
  none.dropped = fix.dropped;
  none.reason = !fix.doubt.empty() ? fix.doubt
                : fix.tags.empty()
                    ? "predicted from the motion, which nothing confirms"
                    : fmt::format("nothing confirms what {} says: {}", fmt::join(fix.tags, " "),
                                  fix.unconfirmed.empty() ? "a wrong plate would go unnoticed"
                                                          : fix.unconfirmed);
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

// ---- Solutions in the rock.

std::string outside_tunnel(const Tunnel& tunnel, const Eigen::Vector3d& position_in_world) {
  const CenterlineAddress address = tunnel.centerline.locate(position_in_world.head<2>());
  const double above_floor =
      position_in_world.z() - tunnel.centerline.at(address.chainage).position.z();
  if (above_floor < 0) {
    return fmt::format("the solution lies {:.3f} m below the floor", -above_floor);
  }
  const double roof = tunnel.height.at(address.chainage);
  if (above_floor > roof) {
    return fmt::format("the solution lies {:.3f} m above the roof", above_floor - roof);
  }
  const Side side = address.offset < 0 ? Side::left : Side::right;
  const double beyond_wall = behind_wall(tunnel, side, address);
  if (beyond_wall > 0) {
    return fmt::format("the solution lies {:.3f} m behind the {} wall's plates", beyond_wall,
                       to_string(side));
  }
  return {};
}

}  // namespace tagsmith::detail
