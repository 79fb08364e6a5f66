// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/check_tags.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "tagsmith/base/text.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {
namespace {

constexpr const char* kAxisNames[] = {"x", "y", "z"};
constexpr double kTouching = 1e-3;  // metres that plates may share with each other or the rock

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Extent extent_of(const std::vector<SourcedTag>& tags, int axis) {
  Extent extent;
  for (const SourcedTag& entry : tags) {
    extent.low = std::min(extent.low, entry.tag.p_in_grid[axis]);
    extent.high = std::max(extent.high, entry.tag.p_in_grid[axis]);
  }
  return extent;
}

std::string metres(double value) { return format_number(value, 3) + " m"; }

// How the code could say the positions of all tags on this axis.
std::string range_remedy(const PositionCode& code, const std::vector<SourcedTag>& tags, int axis) {
  const Extent extent = extent_of(tags, axis);
  const auto [low, high] = coded_range(code, axis);
  const std::string name = kAxisNames[axis];
  if (extent.high - extent.low < high - low) {
    return "an origin of " + format_number(std::floor(extent.low)) + " for " + name +
           " (code.origin) brings all tags into range";
  }
  return "the tags span " + metres(extent.high - extent.low) + " along " + name +
         ": more digits for " + name + " (code.digits) or a coarser code.resolution";
}

std::string range_message(const PositionCode& code, const PlacedTag& tag, int axis) {
  const auto [low, high] = coded_range(code, axis);
  return "tag " + tag.name + ": " + kAxisNames[axis] + " of P is " + metres(tag.p_in_grid[axis]) +
         ", the code says " + format_number(low) + " to " + format_number(high) + " m";
}

int faulty_axis(const PositionCode& code, const PlacedTag& tag) {
  const Eigen::Vector3d& p = tag.p_in_grid;
  return axis_out_of_range(code, {p.x(), p.y(), p.z()}).value_or(0);
}

// Findings of one rule about the regular tags, gathered: they come from one line of the file, and
// one finding that counts them says more than a thousand.
class SeriesFindings {
 public:
  void add(const std::string& kind, const PlacedTag& tag, std::string message) {
    Group& group = groups_[kind];
    if (group.count++ == 0) group.message = std::move(message);
    group.last = tag.name;
  }

  void log_all(Place place, const std::string& code, const std::string& hint,
               FindingLog& log) const {
    for (const auto& [kind, group] : groups_) {
      std::string message = group.message;
      if (group.count > 1) {
        message += "; " + std::to_string(group.count) + " tags in all, the last is " + group.last;
      }
      log.error(place, code, message, hint);
    }
  }

 private:
  struct Group {
    int count = 0;
    std::string message;  // about the first tag
    std::string last;
  };
  std::map<std::string, Group> groups_;
};

// The room of a plate on its wall.
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
  const auto chainage = [&](double x) {
    const Eigen::Vector3d point = tag.world_from_plate * Eigen::Vector3d(x, 0, 0);
    return tunnel.centerline.locate(point.head<2>()).chainage;
  };
  const auto floor = [&](double at) { return tunnel.centerline.at(at).position.z(); };
  PlateExtent extent;
  std::tie(extent.start, extent.end) =
      std::minmax({chainage(plate.x), chainage(plate.x + plate.width)});
  extent.middle = chainage(plate.x + plate.width / 2);
  extent.top = tag.p_in_grid.z() - plate.y;
  extent.bottom = extent.top - plate.height;
  extent.floor = std::max(floor(extent.start), floor(extent.end));
  extent.roof = std::min(floor(extent.start), floor(extent.end)) + tunnel.height;
  return extent;
}

struct WallFault {
  const char* kind = nullptr;
  std::string message;
};

// How the plate sticks out of the tunnel; an empty list when it does not.
std::vector<WallFault> room_faults(const Survey& survey, const PlacedTag& tag,
                                   const PlateExtent& extent) {
  std::vector<WallFault> faults;
  const std::string plate = "the plate of tag " + tag.name;
  const double length = survey.tunnel.centerline.length();
  if (extent.middle < -kTouching) {
    faults.push_back({"before", plate + " has its middle at chainage " + metres(extent.middle) +
                                    ", before the tunnel's start at 0 m"});
  }
  if (extent.middle > length + kTouching) {
    faults.push_back({"beyond", plate + " has its middle at chainage " + metres(extent.middle) +
                                    ", beyond the tunnel's end at " + metres(length)});
  }
  if (extent.bottom < extent.floor - kTouching) {
    faults.push_back({"floor", plate + " reaches down to z = " + metres(extent.bottom) +
                                   ", the floor is at " + metres(extent.floor)});
  }
  if (extent.top > extent.roof + kTouching) {
    faults.push_back({"roof", plate + " reaches up to z = " + metres(extent.top) +
                                  ", the roof is at " + metres(extent.roof)});
  }
  return faults;
}

// Whether a surveyed P lies on the wall that its side says.
void check_on_wall(const Survey& survey, const SourcedTag& entry, FindingLog& log) {
  constexpr double kOffWall = 0.1;  // metres; walls are rough, surveys are not
  const PlacedTag& tag = entry.tag;
  const Eigen::Vector3d middle =
      tag.world_from_plate * Eigen::Vector3d(survey.tag_template.frame_inner_length / 2, 0, 0);
  const double offset = survey.tunnel.centerline.locate(middle.head<2>()).offset;
  const double towards_wall = tag.side == Side::right ? offset : -offset;
  const double behind = towards_wall - survey.tunnel.width / 2;
  const std::string subject = "tag " + tag.name + ": P lies ";
  if (towards_wall <= 0) {
    log.error(entry.place, "wrong-side",
              subject + metres(-towards_wall) + " beyond the center line on the other side, " +
                  "expected on the " + to_string(tag.side) + " wall of the drive",
              "check side, the order of x and y, and grid.x_axis");
  } else if (behind > kOffWall) {
    log.error(entry.place, "off-wall",
              subject + metres(behind) + " behind the " + to_string(tag.side) +
                  " wall, expected at most " + metres(kOffWall),
              "check p, tunnel.width and the center line");
  } else if (behind < -kOffWall) {
    log.warning(entry.place, "off-wall",
                subject + metres(-behind) + " in front of the " + to_string(tag.side) +
                    " wall, expected at most " + metres(kOffWall),
                "check p, tunnel.width and the center line");
  }
}

struct WallPlate {
  PlateExtent extent;
  const SourcedTag* source = nullptr;
};

void log_overlap(const SourcedTag& a, const SourcedTag& b, SeriesFindings& series,
                 FindingLog& log) {
  const SourcedTag& later = b.tag.surveyed ? b : a;
  const SourcedTag& other = &later == &a ? b : a;
  const std::string message = "the plates of tags " + later.tag.name + " and " + other.tag.name +
                              " overlap on the " + to_string(later.tag.side) + " wall";
  if (!later.tag.surveyed) {
    series.add(to_string(later.tag.side), later.tag, message);
  } else {
    log.error(later.place, "overlap", message, "check both positions");
  }
}

// Sweeps along the wall. Of the plates that the sweep line crosses, those kept share no height, so
// that a new one needs to be compared with its neighbours in height only.
void check_overlaps(std::vector<WallPlate> plates, SeriesFindings& series, FindingLog& log) {
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
      log_overlap(*other->source, *plate.source, series, log);
    } else if (open_by_bottom.emplace(extent.bottom, &plate).second) {
      open_by_end.emplace(extent.end, extent.bottom);
    }
  }
}

}  // namespace

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
      series[static_cast<std::size_t>(axis)].add("", entry.tag, message);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    series[axis].log_all(code_place, "code-range", remedies[axis], log);
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
        series.add("", entry.tag, message);
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
  series.log_all(code_place, "code-collision", "a finer code.resolution tells them apart", log);
  constexpr double kRounding = 1e-6;
  if (greatest > std::max(kBearable, 2 * survey.sigma) + kRounding) {
    log.warning(code_place, "coarse-code",
                "the code rounds positions by up to " + metres(greatest) + " (tag " +
                    worst->tag.name + "), more than " +
                    metres(std::max(kBearable, 2 * survey.sigma)),
                "whoever reads the tags without this survey gets the rounded position; a finer "
                "code.resolution rounds less");
  }
}

void check_walls(const Survey& survey, const std::vector<SourcedTag>& tags, FindingLog& log) {
  const Rectangle plate = draw_tag(survey.tag_template, Digits{}).plate;
  SeriesFindings sticking_out;
  std::array<std::vector<WallPlate>, 2> walls;
  Place series_place;
  for (const SourcedTag& entry : tags) {
    const PlateExtent extent = plate_extent(survey.tunnel, plate, entry.tag);
    walls[entry.tag.side == Side::left ? 0 : 1].push_back({extent, &entry});
    for (WallFault& fault : room_faults(survey, entry.tag, extent)) {
      if (entry.tag.surveyed) {
        log.error(entry.place, "outside-tunnel", fault.message, "check p, tunnel and the template");
      } else {
        sticking_out.add(fault.kind, entry.tag, std::move(fault.message));
      }
    }
    if (entry.tag.surveyed) {
      check_on_wall(survey, entry, log);
    } else {
      series_place = entry.place;
    }
  }
  sticking_out.log_all(series_place, "outside-tunnel",
                       "fewer pairs, another first or height, or a longer or higher tunnel", log);
  SeriesFindings overlaps;
  for (std::vector<WallPlate>& wall : walls) check_overlaps(std::move(wall), overlaps, log);
  overlaps.log_all(series_place, "overlap", "a wider spacing", log);
}

}  // namespace tagsmith
