// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/lint_tags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/expected_place.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {
namespace {

// ---- the whole grid ----

// The survey as it would be if its grid's x axis pointed to the other side.
Survey mirrored(const Survey& survey) {
  Survey other = survey;
  other.grid.x_axis_left = !survey.grid.x_axis_left;
  const Centerline& line = survey.tunnel.centerline;
  const CenterlinePoint start = line.at(0);
  const Eigen::Vector3d start_in_grid = grid_from_world(survey.grid, start.position);
  const double heading_in_grid = grid_heading_from_world(survey.grid, start.heading);
  other.tunnel.centerline =
      Centerline(world_from_grid(other.grid, start_in_grid),
                 world_heading_from_grid(other.grid, heading_in_grid), line.elements());
  return other;
}

// The share of the surveyed tags that lie at the wall their side says.
double share_at_walls(const Survey& survey, const std::vector<const SourcedTag*>& tags,
                      bool axes_exchanged) {
  constexpr double kAtWall = 0.3;  // metres
  const auto at_wall = [&](const SourcedTag* entry) {
    Eigen::Vector3d p = entry->tag.p_in_grid;
    if (axes_exchanged) std::swap(p.x(), p.y());
    const PlateAddress address = plate_address(survey, entry->tag.side, p);
    return std::abs(address.behind_wall) < kAtWall && address.chainage > -1 &&
           address.chainage < survey.tunnel.centerline.length() + 1;
  };
  return static_cast<double>(std::ranges::count_if(tags, at_wall)) /
         static_cast<double>(tags.size());
}

// ---- single tags ----

// A tag's finding with the coordinates that may have been meant.
void log_odd(const Survey& survey, const SourcedTag& entry, const ExpectedPlace& expected,
             const std::string& code, const std::string& message, const std::string& hint,
             FindingLog& log) {
  const std::optional<std::string> slip = likely_slip(survey, entry.tag, expected);
  log.warning(entry.place, code, "tag " + entry.tag.name + ": " + message, slip.value_or(hint));
}

// True when the tag hangs where it is expected.
bool lint_place(const Survey& survey, const SourcedTag& entry, const ExpectedPlace& expected,
                FindingLog& log) {
  const PlateAddress address = plate_address(survey, entry.tag.side, entry.tag.p_in_grid);
  const std::string source = entry.tag.design_in_grid ? "the design" : "the neighbours";
  if (!fits_along(address, expected)) {
    log_odd(survey, entry, expected, "spacing-outlier",
            fmt::format("the plate's middle is at chainage {}, by {} expected at {}",
                        length_text(address.chainage), source, length_text(expected.chainage)),
            "check p, and the number in the tag's name", log);
    return false;
  }
  if (!fits_in_height(address, expected)) {
    log_odd(survey, entry, expected, "height-outlier",
            fmt::format("P is {} above the floor, by {} expected at {}",
                        length_text(address.height), source, length_text(expected.height)),
            "check z of p, the grade of the center line, and that p is the corner P", log);
    return false;
  }
  if (std::abs(address.behind_wall) > kOffWall) {
    if (const auto slip = likely_slip(survey, entry.tag, expected)) {
      log.warning(entry.place, "likely-slip", "tag " + entry.tag.name + " is off its wall", *slip);
    }
  }
  return true;
}

bool is_turned(const Survey& survey, const PlacedTag& tag) {
  return is_turned_from_wall(survey.tunnel, survey.tag_template, tag);
}

// Tags of a wall that differ from the others, by their pair.
std::map<int, bool> lint_wall(const Survey& survey, const std::vector<const SourcedTag*>& wall,
                              FindingLog& log) {
  std::map<int, bool> odd;
  const std::vector<std::optional<ExpectedPlace>> places = expected_places(survey, wall);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    if (!places[i] || !wall[i]->tag.surveyed || is_turned(survey, wall[i]->tag)) continue;
    odd[wall[i]->tag.pair] = !lint_place(survey, *wall[i], *places[i], log);
  }
  return odd;
}

struct Pair {
  const SourcedTag* right;
  double shift;     // of the right plate beyond the left one, along the drive
  double expected;  // by the design
};

void lint_pairs(const Survey& survey, const std::vector<Pair>& pairs, FindingLog& log) {
  constexpr std::size_t kLeastPairs = 5;
  const bool designed = survey.series && survey.series->pairs > 0;
  if (!designed && pairs.size() < kLeastPairs) return;
  std::vector<double> shifts;
  for (const Pair& pair : pairs) shifts.push_back(pair.shift);
  const double usual = median(shifts);
  const auto expected_of = [&](const Pair& pair) { return designed ? pair.expected : usual; };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    shifts[i] = std::abs(shifts[i] - expected_of(pairs[i]));
  }
  const double tolerance = std::max(kLeastTolerance, kScatterTolerance * median(std::move(shifts)));
  for (const Pair& pair : pairs) {
    const double expected = expected_of(pair);
    if (std::abs(pair.shift - expected) <= tolerance) continue;
    const PlacedTag& tag = pair.right->tag;
    log.warning(
        pair.right->place, "pair-shift",
        fmt::format("tag {} stands {} further along the drive than {}, expected {}", tag.name,
                    length_text(pair.shift), tag_name(tag.pair, Side::left), length_text(expected)),
        "plates of a pair face each other, or stand apart as tags.theta says; check both");
  }
}

double middle_chainage(const Survey& survey, const PlacedTag& tag) {
  return plate_address(survey, tag.side, tag.p_in_grid).chainage;
}

// ---- codes ----

// Digits that print and light confuse, counted as one: 1 and 7, 2 and 8.
Digits look(Digits digits) {
  for (std::uint8_t& digit : digits) {
    if (digit == 7) digit = 1;
    if (digit == 8) digit = 2;
  }
  return digits;
}

}  // namespace

bool check_grid(const Survey& survey, const std::vector<SourcedTag>& tags, Place placed,
                FindingLog& log) {
  constexpr std::size_t kLeastTags = 4;
  constexpr double kFew = 0.2;
  constexpr double kMost = 0.8;
  std::vector<const SourcedTag*> surveyed;
  for (const SourcedTag& entry : tags) {
    if (entry.tag.surveyed) surveyed.push_back(&entry);
  }
  if (surveyed.size() < kLeastTags || share_at_walls(survey, surveyed, false) > kFew) return false;
  const Survey other = mirrored(survey);
  const bool exchanged = share_at_walls(survey, surveyed, true) >= kMost;
  const bool mirror = share_at_walls(other, surveyed, false) >= kMost;
  const bool both = share_at_walls(other, surveyed, true) >= kMost;
  const std::string subject =
      fmt::format("hardly any of the {} placed tags lies at its wall, ", surveyed.size());
  const std::string axis = other.grid.x_axis_left ? "left" : "right";
  if (exchanged || both) {
    log.error(placed, "exchanged-axes", subject + "with x and y exchanged they do",
              "the lists of some instruments give north before east: write p as [x, y, z]" +
                  std::string(exchanged ? "" : ", with grid.x_axis: " + axis));
  } else if (mirror) {
    log.error(placed, "mirrored-grid", subject + "the mirror image fits",
              "grid.x_axis: " + axis + ", or left and right are exchanged in the list");
  }
  return exchanged || mirror || both;
}

void lint_places(const Survey& survey, const std::vector<SourcedTag>& tags, FindingLog& log) {
  if (std::ranges::none_of(tags, [](const SourcedTag& entry) { return entry.tag.surveyed; })) {
    return;
  }
  std::array<std::vector<const SourcedTag*>, 2> walls;
  for (const SourcedTag& entry : tags) {
    walls[entry.tag.side == Side::left ? 0 : 1].push_back(&entry);
  }
  std::map<int, bool> odd_left = lint_wall(survey, walls[0], log);
  std::map<int, bool> odd_right = lint_wall(survey, walls[1], log);
  std::map<int, const SourcedTag*> left;
  for (const SourcedTag* entry : walls[0]) left.emplace(entry->tag.pair, entry);
  std::vector<Pair> pairs;
  for (const SourcedTag* right : walls[1]) {
    const auto found = left.find(right->tag.pair);
    if (found == left.end() || odd_left[right->tag.pair] || odd_right[right->tag.pair]) continue;
    if (!right->tag.surveyed && !found->second->tag.surveyed) continue;
    if (is_turned(survey, right->tag) || is_turned(survey, found->second->tag)) continue;
    const double abreast = middle_chainage(survey, found->second->tag);
    pairs.push_back(
        {right, middle_chainage(survey, right->tag) - abreast, right_plate_shift(survey, abreast)});
  }
  lint_pairs(survey, pairs, log);
}

void lint_codes(const Survey& survey, const std::vector<SourcedTag>& tags, Place code_place,
                FindingLog& log) {
  constexpr double kInSight = 20;  // metres: tags that one picture may show, or a gate accepts
  std::map<Digits, std::vector<const SourcedTag*>> alike;
  Eigen::Vector3d highest = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
  Eigen::Vector3d lowest = -highest;
  for (const SourcedTag& entry : tags) {
    if (!entry.coded) continue;
    highest = highest.cwiseMax(entry.tag.coded_in_grid);
    lowest = lowest.cwiseMin(entry.tag.coded_in_grid);
    alike[look(entry.tag.digits)].push_back(&entry);
  }
  int count = 0;
  std::string example;
  for (const auto& [digits, group] : alike) {
    for (std::size_t i = 1; i < group.size(); ++i) {
      const PlacedTag& a = group[i - 1]->tag;
      const PlacedTag& b = group[i]->tag;
      if (a.digits == b.digits || (a.p_in_grid - b.p_in_grid).norm() > kInSight) continue;
      if (count++ == 0) {
        example = fmt::format("tags {} ({}) and {} ({})", a.name, to_string(a.digits), b.name,
                              to_string(b.digits));
      }
    }
  }
  if (count > 0) {
    log.warning(code_place, "alike-codes",
                example + " differ by 1 and 7 or 2 and 8 alone" +
                    (count > 1 ? fmt::format("; {} such neighbours in all", count) : ""),
                fmt::format("these digits are the ones that blur confuses; another code.origin{} "
                            "tells the tags apart",
                            survey.code.check == CheckDigit::gs1 ? "" : ", or check_digit: gs1,"));
  }
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kNearEnd = 0.05;  // of the range
    const auto [low, high] = coded_range(survey.code, axis);
    if (!(highest[axis] > lowest[axis]) || highest[axis] < high - kNearEnd * (high - low)) continue;
    log.warning(code_place, "code-range-end",
                fmt::format("{} of the tags reaches {}, the code ends at {}", kAxisNames[axis],
                            length_text(highest[axis]), length_text(high)),
                "the next section will not fit: more digits for this axis (code.digits), or "
                "another code.origin for the next section");
  }
}

void lint_series(const Survey& survey, Place tags_place, FindingLog& log) {
  constexpr double kLeastPairAngle = radians(4);  // an error of d is 14-fold along the drive
  if (survey.series && survey.series->pairs > 0) {
    const double theta = survey.series->pair_angle.value_or(
        std::atan2(survey.tag_template.frame_inner_length, greatest_width(survey.tunnel)));
    if (theta < kLeastPairAngle) {
      log.warning(
          tags_place, "small-theta",
          fmt::format("theta is {} degrees: localize --method paper turns an error of the "
                      "measured distance into one {} times as large along the drive",
                      format_number(degrees(theta), 2), format_number(1 / std::tan(theta), 0)),
          "set tags.theta to 10 or more, or localize by --method joint only");
    }
  }
  const TagTemplate& tag = survey.tag_template;
  const TagText text{{tag_name(0, Side::left)}};
  if (tag.label.shown && draw_tag(tag, Digits{}, text).label.empty()) {
    log.warning(
        tags_place, "no-label-room",
        "the plate of template " + tag.name + " has no room for a label outside the feature frame",
        "a larger plate or a smaller frame; or label: { shown: false } in the template");
  }
}

void lint_walls(const Survey& survey, Place tags_place, FindingLog& log) {
  constexpr double kTimes = 3;
  const bool is_computed = survey.states_sigma && survey.sigma == 0;
  const double usual = usual_angle_sigma(survey);
  if (is_computed || usual <= std::max(kTimes * survey.angle_sigma, kUsualAngleSigma)) return;
  log.warning(
      tags_place, "rough-wall",
      fmt::format("the walls' direction under the plates scatters by {} degrees, "
                  "angle_sigma is {}",
                  format_number(degrees(usual), 1), format_number(degrees(survey.angle_sigma), 2)),
      fmt::format("angle_sigma: {}; or say how each plate hangs: facing",
                  format_number(degrees(usual), 1)));
}

}  // namespace tagsmith::detail
