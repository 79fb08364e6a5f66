// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/check_tags.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kTouching = 1e-3;  // metres that plates may share with each other or the rock

// How the code could represent the positions of all tags on this axis.
std::string range_remedy(const PositionCode& code, const std::vector<SourcedTag>& tags, int axis) {
  Eigen::AlignedBox3d box;
  for (const SourcedTag& entry : tags) box.extend(entry.tag.p_in_grid);
  const double extent = box.sizes()[axis];
  const auto [low, high] = coded_range(code, axis);
  const std::string name = kAxisNames[axis];
  if (extent < high - low) {
    return "an origin of " + format_number(std::floor(box.min()[axis])) + " for " + name +
           " (code.origin) brings all tags into range, before any plate is printed; where plates "
           "hang, keep the origin that they were printed with, and make the new stretch a survey "
           "of its own";
  }
  return "the tags span " + length_text(extent) + " along " + name + ": more digits for " + name +
         " (code.digits) or a coarser code.resolution";
}

std::string range_message(const PositionCode& code, const PlacedTag& tag, int axis) {
  const auto [low, high] = coded_range(code, axis);
  return "tag " + tag.name + ": " + kAxisNames[axis] + " of P is " +
         length_text(tag.p_in_grid[axis]) + ", the code says " + format_number(low) + " to " +
         format_number(high) + " m";
}

int faulty_axis(const PositionCode& code, const PlacedTag& tag) {
  const Eigen::Vector3d& p = tag.p_in_grid;
  return axis_out_of_range(code, {p.x(), p.y(), p.z()}).value_or(0);
}

// Findings of one rule about the regular tags, combined: they come from one line of the file, and
// one finding with their number is clearer than a thousand.
class SeriesFindings {
 public:
  // Those of one kind at one place are combined.
  void add(const char* kind, Place place, const PlacedTag& tag, std::string message) {
    Group& group = groups_[kind];
    if (group.count++ == 0) group.message = std::move(message);
    group.place = place;
    group.last = tag.name;
  }

  void log_all(const std::string& code, const std::string& hint, FindingLog& log,
               Severity severity = Severity::error) const {
    for (const auto& [kind, group] : groups_) {
      std::string message = group.message;
      if (group.count > 1) {
        message += "; " + std::to_string(group.count) + " tags in all, the last is " + group.last;
      }
      if (severity == Severity::error) {
        log.error(group.place, code, message, hint);
      } else {
        log.warning(group.place, code, message, hint);
      }
    }
  }

 private:
  struct Group {
    int count = 0;
    Place place;
    std::string message;  // about the first tag
    std::string last;
  };
  std::map<std::string, Group> groups_;
};

// The space that a plate takes on its wall.
struct PlateExtent {
  double start = 0;  // chainage
  double middle = 0;
  double end = 0;
  double bottom = 0;  // z in the grid
  double top = 0;
  double floor = 0;  // greatest z of the floor and least z of the roof along the plate
  double roof = 0;
};

PlateExtent plate_extent(const Tunnel& tunnel, const Rectangle& plate, const PlacedTag& tag) {
  const auto chainage = [&](double x, double y) {
    const Eigen::Vector3d point = tag.world_from_plate * Eigen::Vector3d(x, y, 0);
    return tunnel.centerline.locate(point.head<2>()).chainage;
  };
  const auto floor = [&](double at) { return tunnel.centerline.at(at).position.z(); };
  const double far_x = plate.x + plate.width;
  const double far_y = plate.y + plate.height;
  PlateExtent extent;
  if (tag.attitude) {
    std::tie(extent.start, extent.end) =
        std::minmax({chainage(plate.x, plate.y), chainage(far_x, plate.y), chainage(plate.x, far_y),
                     chainage(far_x, far_y)});
    const double middle = (tag.world_from_plate *
                           Eigen::Vector3d(plate.x + plate.width / 2, (plate.y + far_y) / 2, 0))
                              .z();
    const double reach = (std::abs(tag.world_from_plate.rotation(2, 0)) * plate.width +
                          std::abs(tag.world_from_plate.rotation(2, 1)) * plate.height) /
                         2;
    extent.top = middle + reach;
    extent.bottom = middle - reach;
  } else {
    std::tie(extent.start, extent.end) = std::minmax({chainage(plate.x, 0), chainage(far_x, 0)});
    extent.top = tag.p_in_grid.z() - plate.y;
    extent.bottom = extent.top - plate.height;
  }
  extent.middle = chainage(plate.x + plate.width / 2, 0);
  extent.floor = std::max(floor(extent.start), floor(extent.end));
  extent.roof = std::min(floor(extent.start), floor(extent.end)) +
                tunnel.height.least(extent.start, extent.end);
  return extent;
}

struct WallFault {
  const char* kind = nullptr;
  Place place;  // of the key to change, for regular tags
  std::string message;
};

// By how much the plate extends beyond the tunnel; an empty list when it does not.
std::vector<WallFault> room_faults(const Survey& survey, const PlacedTag& tag,
                                   const PlateExtent& extent, const SeriesPlaces& series) {
  std::vector<WallFault> faults;
  const std::string plate = "the plate of tag " + tag.name;
  const double length = survey.tunnel.centerline.length();
  if (extent.middle < -kTouching) {
    faults.push_back({"before", series.first,
                      plate + " has its middle at chainage " + length_text(extent.middle) +
                          ", before the tunnel's start at 0 m"});
  }
  if (extent.middle > length + kTouching) {
    faults.push_back({"beyond", series.count,
                      plate + " has its middle at chainage " + length_text(extent.middle) +
                          ", beyond the tunnel's end at " + length_text(length)});
  }
  if (extent.bottom < extent.floor - kTouching) {
    faults.push_back({"floor", series.height,
                      plate + " reaches down to z = " + length_text(extent.bottom) +
                          ", the floor is at " + length_text(extent.floor)});
  }
  if (extent.top > extent.roof + kTouching) {
    faults.push_back({"roof", series.height,
                      plate + " reaches up to z = " + length_text(extent.top) +
                          ", the roof is at " + length_text(extent.roof)});
  }
  return faults;
}

// Whether the middle of the frame of a surveyed tag lies on the wall that its side says.
void check_on_wall(const Survey& survey, const SourcedTag& entry, const CenterlineAddress& middle,
                   FindingLog& log) {
  const Tunnel& tunnel = survey.tunnel;
  const PlacedTag& tag = entry.tag;
  const std::string subject = "tag " + tag.name + ": the middle of its frame lies ";
  const char* kRemedy = "check p, the walls that `tunnel` says, and the center line";
  const double behind = behind_wall(tunnel, tag.side, middle);
  const double into_rock = behind - tunnel.stand_off;
  const double across = tag.side == Side::left ? middle.offset : -middle.offset;
  if (across >= 0) {
    log.error(entry.place, "wrong-side",
              subject + length_text(across) + " beyond the center line on the other side, " +
                  "expected on the " + to_string(tag.side) + " wall of the drive",
              "check side, the order of x and y, and grid.x_axis");
  } else if (into_rock > kOffWall) {
    log.error(entry.place, "off-wall",
              subject + length_text(into_rock) + " behind the " + to_string(tag.side) +
                  " wall, expected at most " + length_text(kOffWall),
              kRemedy);
  } else if (std::abs(behind) > kOffWall &&
             !is_turned_from_wall(tunnel, survey.tag_template, tag)) {
    log.warning(entry.place, "off-wall",
                subject + length_text(std::abs(behind)) +
                    (behind < 0 ? " in front of" : " behind") + " the plane of the " +
                    to_string(tag.side) + " plates, expected at most " + length_text(kOffWall),
                kRemedy);
  }
}

// Whether a plate with an attitude of its own faces the rock.
void check_faces_room(const Survey& survey, const SourcedTag& entry, FindingLog& log) {
  if (!entry.tag.attitude) return;
  constexpr double kAhead = 0.3;  // metres in front of the plate's middle
  const TagTemplate& tag = survey.tag_template;
  const Eigen::Vector3d ahead =
      entry.tag.world_from_plate *
      Eigen::Vector3d(tag.frame_inner_length / 2, tag.frame_inner_height / 2, -kAhead);
  const CenterlineAddress address = survey.tunnel.centerline.locate(ahead.head<2>());
  for (const Side side : {Side::left, Side::right}) {
    const double behind = behind_wall(survey.tunnel, side, address) - survey.tunnel.stand_off;
    if (behind <= 0) continue;
    log.warning(entry.place, "faces-rock",
                "tag " + entry.tag.name + " looks at the " + to_string(side) +
                    " wall: " + length_text(kAhead) + " in front of the plate is " +
                    length_text(behind) + " in the rock",
                "facing is the direction that the plate's face looks to, from +y towards +x of the "
                "grid; away from its wall when left out");
  }
}

// Whether a plate on a wall leans as no wall does that a plate hangs on.
void check_tilt(const Survey& survey, const SourcedTag& entry, FindingLog& log) {
  constexpr double kSteep = radians(30);  // shoulders of arched drives, at the height of plates
  const PlacedTag& tag = entry.tag;
  if (!tag.attitude || std::abs(tag.attitude->tilt) <= kSteep ||
      is_turned_from_wall(survey.tunnel, survey.tag_template, tag)) {
    return;
  }
  log.warning(entry.place, "steep-tilt",
              fmt::format("tag {} leans {} degrees out of the vertical, expected at most {} on a "
                          "wall",
                          tag.name, format_number(degrees(std::abs(tag.attitude->tilt)), 1),
                          format_number(degrees(kSteep), 0)),
              "tilt is 0 for a plate that hangs plumb, positive where its upper edge leans out of "
              "the wall");
}

// The place of the middle of the frame's upper edge.
CenterlineAddress middle_of(const Survey& survey, const PlacedTag& tag) {
  const Eigen::Vector3d middle =
      tag.world_from_plate * Eigen::Vector3d(survey.tag_template.frame_inner_length / 2, 0, 0);
  return survey.tunnel.centerline.locate(middle.head<2>());
}

// The wall's steps behind a plate; empty when none is relevant.
std::string step_behind(const Tunnel& tunnel, const PlacedTag& tag, const PlateExtent& extent) {
  constexpr double kStep = 0.02;  // metres that a plate's fixings can bridge
  const ChainageProfile& wall = wall_of(tunnel, tag.side);
  if (wall.is_constant()) return {};
  const double step = wall.steps(extent.start, extent.end);
  if (step <= kStep) return {};
  return "the plate of tag " + tag.name + ", chainage " + format_number(extent.start, 3) + " to " +
         length_text(extent.end) + ", hangs over a step of " + length_text(step) + " of the " +
         to_string(tag.side) + " wall";
}

struct WallPlate {
  PlateExtent extent;
  const SourcedTag* source = nullptr;
};

void log_overlap(const SourcedTag& a, const SourcedTag& b, Place spacing, SeriesFindings& series,
                 FindingLog& log) {
  const SourcedTag& later = b.tag.surveyed ? b : a;
  const SourcedTag& other = &later == &a ? b : a;
  const std::string message = "the plates of tags " + later.tag.name + " and " + other.tag.name +
                              " overlap on the " + to_string(later.tag.side) + " wall";
  if (!later.tag.surveyed) {
    series.add(later.tag.side == Side::left ? "left" : "right", spacing, later.tag, message);
  } else {
    log.error(later.place, "overlap", message, "check both positions");
  }
}

// Sweeps along the wall. Of the plates that the sweep line crosses, those kept share no height, so
// that a new one must be compared with its neighbours in height only.
void check_overlaps(std::vector<WallPlate> plates, Place spacing, SeriesFindings& series,
                    FindingLog& log) {
  std::ranges::sort(plates, {}, [](const WallPlate& plate) { return plate.extent.start; });
  std::map<double, const WallPlate*> open_by_bottom;
  std::set<std::pair<double, double>> open_by_end;  // (end, bottom)
  for (const WallPlate& plate : plates) {
    const PlateExtent& extent = plate.extent;
    while (!open_by_end.empty() && open_by_end.begin()->first <= extent.start + kTouching) {
      open_by_bottom.erase(open_by_end.begin()->second);
      open_by_end.erase(open_by_end.begin());
    }
    const auto above = open_by_bottom.lower_bound(extent.bottom);
    const WallPlate* other = nullptr;
    if (above != open_by_bottom.end() && above->first < extent.top - kTouching) {
      other = above->second;
    } else if (above != open_by_bottom.begin() &&
               std::prev(above)->second->extent.top > extent.bottom + kTouching) {
      other = std::prev(above)->second;
    }
    if (other != nullptr) {
      log_overlap(*other->source, *plate.source, spacing, series, log);
    } else if (open_by_bottom.emplace(extent.bottom, &plate).second) {
      open_by_end.emplace(extent.end, extent.bottom);
    }
  }
}

}  // namespace

std::string length_text(double metres) { return format_number(metres, 3) + " m"; }

void check_code_range(const Survey& survey, const std::vector<SourcedTag>& tags, Place code_place,
                      FindingLog& log) {
  std::array<SeriesFindings, 3> series;
  std::array<std::string, 3> remedies;
  for (int axis = 0; axis < 3; ++axis) {
    remedies[static_cast<std::size_t>(axis)] = range_remedy(survey.code, tags, axis);
  }
  for (const SourcedTag& entry : tags) {
    if (entry.coded) continue;
    const int axis = faulty_axis(survey.code, entry.tag);
    const std::string& remedy = remedies[static_cast<std::size_t>(axis)];
    const std::string message = range_message(survey.code, entry.tag, axis);
    if (entry.tag.surveyed) {
      log.error(entry.place, "code-range", message, remedy);
    } else {
      series[static_cast<std::size_t>(axis)].add("", code_place, entry.tag, message);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    series[axis].log_all("code-range", remedies[axis], log);
  }
}

void check_codes(const Survey& survey, const std::vector<SourcedTag>& tags, Place code_place,
                 FindingLog& log) {
  constexpr double kBearable = 0.005;  // metres: half the usual resolution of a centimetre
  SeriesFindings series;
  std::map<Digits, const SourcedTag*> by_digits;
  const SourcedTag* worst = nullptr;
  double greatest = 0;
  for (const SourcedTag& entry : tags) {
    if (!entry.coded) continue;
    const auto [first, is_new] = by_digits.emplace(entry.tag.digits, &entry);
    if (!is_new) {
      const std::string message = "tags " + first->second->tag.name + " and " + entry.tag.name +
                                  " have the same code " + to_string(entry.tag.digits);
      if (!entry.tag.surveyed) {
        series.add("", code_place, entry.tag, message);
      } else {
        log.error(entry.place, "code-collision", message, "check p and digits of both");
      }
    }
    const double rounding =
        (entry.tag.coded_in_grid - entry.tag.p_in_grid).lpNorm<Eigen::Infinity>();
    if (entry.printed_digits || rounding <= greatest) continue;
    greatest = rounding;
    worst = &entry;
  }
  series.log_all("code-collision", "a finer code.resolution tells them apart", log);
  constexpr double kRounding = 1e-6;
  if (greatest > std::max(kBearable, 2 * survey.sigma) + kRounding) {
    log.warning(code_place, "coarse-code",
                "the code rounds positions by up to " + length_text(greatest) + " (tag " +
                    worst->tag.name + "), more than " +
                    length_text(std::max(kBearable, 2 * survey.sigma)),
                "whoever reads the tags without this survey gets the rounded position; a finer "
                "code.resolution rounds less");
  }
}

void check_walls(const Survey& survey, const std::vector<SourcedTag>& tags,
                 const SeriesPlaces& series, FindingLog& log) {
  const Rectangle plate = draw_tag(survey.tag_template, Digits{}).plate;
  const char* kStepHint = "move the tag off the step, or give it a support that bridges it";
  SeriesFindings sticking_out;
  SeriesFindings over_steps;
  std::array<std::vector<WallPlate>, 2> walls;
  for (const SourcedTag& entry : tags) {
    const PlateExtent extent = plate_extent(survey.tunnel, plate, entry.tag);
    for (WallFault& fault : room_faults(survey, entry.tag, extent, series)) {
      if (entry.tag.surveyed) {
        log.error(entry.place, "outside-tunnel", fault.message, "check p, tunnel and the template");
      } else {
        sticking_out.add(fault.kind, fault.place, entry.tag, std::move(fault.message));
      }
    }
    std::string step = step_behind(survey.tunnel, entry.tag, extent);
    bool stands_free = false;
    if (entry.tag.surveyed) {
      const CenterlineAddress middle = middle_of(survey, entry.tag);
      stands_free = has_own_attitude(survey, entry.tag) &&
                    behind_wall(survey.tunnel, entry.tag.side, middle) < -kOffWall;
      check_on_wall(survey, entry, middle, log);
      check_faces_room(survey, entry, log);
      check_tilt(survey, entry, log);
      if (!step.empty() && !stands_free) log.warning(entry.place, "wall-step", step, kStepHint);
    } else {
      if (!step.empty()) over_steps.add("", entry.place, entry.tag, std::move(step));
    }
    if (!stands_free) walls[entry.tag.side == Side::left ? 0 : 1].push_back({extent, &entry});
  }
  sticking_out.log_all("outside-tunnel",
                       "fewer pairs, another first or height, or a longer or higher tunnel", log);
  over_steps.log_all("wall-step", kStepHint, log, Severity::warning);
  SeriesFindings overlaps;
  for (std::vector<WallPlate>& wall : walls) {
    check_overlaps(std::move(wall), series.spacing, overlaps, log);
  }
  overlaps.log_all("overlap", "a wider spacing", log);
}

}  // namespace tagsmith::detail
