// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <pugixml.hpp>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "tagsmith/base/result.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/draft/length_units.hpp"
#include "tagsmith/draft/point_formats.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/listed_survey.hpp"
#include "tagsmith/survey/xml_document.hpp"

namespace tagsmith::detail {

// ---- The heights of a designed alignment: grades, and vertical curves between them.

namespace {

// Where two grades meet. Lengths in the file's unit.
struct GradeChange {
  Eigen::Vector2d at{0, 0};  // station, height
  // Of a parabola, horizontally, before and behind the station; both 0: a corner.
  double before = 0;
  double behind = 0;
  // For a circular arc, whose length may be stated too.
  std::optional<double> radius{};
  std::optional<double> arc_length{};
};

// Stations and heights, rising in their stations, that chords join.
using VerticalProfile = std::vector<Eigen::Vector2d>;

using Eigen::Vector2d;

constexpr double kMostChords = 500;  // of one curve: limits the work

double grade_between(const Vector2d& from, const Vector2d& to) {
  return (to.y() - from.y()) / (to.x() - from.x());
}

int chords(double count) {
  return static_cast<int>(std::ceil(std::clamp(count, 1.0, kMostChords)));
}

// Two parabolas that meet above the change of grade with one tangent, with the stated lengths
// before and behind it; with equal lengths they are one.
VerticalProfile parabola(const GradeChange& change, double grade_before, double grade_behind,
                         double sag) {
  const auto& [at, before, behind, radius, length] = change;
  const double middle = before * behind * (grade_behind - grade_before) / (2 * (before + behind));
  const int count = chords(std::sqrt(std::abs(middle) / (4 * sag)));
  VerticalProfile points;
  for (int i = -count; i <= count; ++i) {
    const double share = std::abs(i) / static_cast<double>(count);  // of the way from the change
    const double along = share * (i < 0 ? -before : behind);
    const double tangent = at.y() + along * (i < 0 ? grade_before : grade_behind);
    points.emplace_back(at.x() + along, tangent + middle * (1 - share) * (1 - share));
  }
  return points;
}

Result<VerticalProfile> arc(const GradeChange& change, double grade_before, double grade_behind,
                            double sag) {
  constexpr double kSame = 0.01;
  const double radius = std::abs(*change.radius);
  const double from = std::atan(grade_before);
  const double turned = std::atan(grade_behind) - from;
  const double length = std::abs(turned) * radius;
  if (change.arc_length && std::abs(*change.arc_length - length) > kSame * length) {
    return fail("its length is " + format_number(*change.arc_length, 3) +
                ", but its radius makes " + format_number(length, 3));
  }
  const double side = turned < 0 ? -1 : 1;
  const double tangent = radius * std::tan(std::abs(turned) / 2);
  const Vector2d start = change.at - tangent * Vector2d(std::cos(from), std::sin(from));
  const Vector2d centre = start + side * radius * Vector2d(-std::sin(from), std::cos(from));
  const int count = chords(std::abs(turned) * std::sqrt(radius / (8 * sag)));
  VerticalProfile points;
  for (int i = 0; i <= count; ++i) {
    const double angle = from + turned * i / count;
    points.push_back(centre + side * radius * Vector2d(std::sin(angle), -std::cos(angle)));
  }
  return points;
}

// What the change of grade at the index adds to the profile.
Result<VerticalProfile> points_of(const std::vector<GradeChange>& changes, std::size_t index,
                                  double sag) {
  const GradeChange& change = changes[index];
  if (!change.radius && change.before + change.behind == 0) return VerticalProfile{change.at};
  if (index == 0 || index + 1 == changes.size()) {
    return fail("a vertical curve needs a point of the profile before and behind it");
  }
  const double before = grade_between(changes[index - 1].at, change.at);
  const double behind = grade_between(change.at, changes[index + 1].at);
  if (change.radius) return arc(change, before, behind, sag);
  return parabola(change, before, behind, sag);
}

// The changes of grade with their curves as chords that are off them by at most `sag`. Fails with
// words for the user where stations do not rise, curves overlap or begin beyond the profile, or an
// arc does not have its stated length.
Result<VerticalProfile> profile_of_grades(const std::vector<GradeChange>& changes, double sag) {
  constexpr double kSame = 1e-3;  // between the end of one curve and the begin of the next
  for (std::size_t i = 1; i < changes.size(); ++i) {
    if (changes[i].at.x() > changes[i - 1].at.x()) continue;
    return fail("station " + format_number(changes[i].at.x(), 3) + " does not lie behind " +
                format_number(changes[i - 1].at.x(), 3));
  }
  VerticalProfile profile;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const std::string place = "at station " + format_number(changes[i].at.x(), 3) + ": ";
    const Result<VerticalProfile> points = points_of(changes, i, sag);
    if (!points) return fail(place + points.error().message);
    if (!profile.empty() && points->front().x() < profile.back().x() - kSame) {
      return fail(place + "vertical curves overlap");
    }
    for (const Vector2d& point : *points) {
      if (profile.empty() || point.x() > profile.back().x()) profile.push_back(point);
    }
  }
  return profile;
}

// Whether the profile has a height there, to `slack`.
bool reaches(const VerticalProfile& profile, double station, double slack) {
  return !profile.empty() && station >= profile.front().x() - slack &&
         station <= profile.back().x() + slack;
}

// For a profile that has points; beyond its ends the height of its end.
double height_at(const VerticalProfile& profile, double station) {
  const auto next =
      std::ranges::find_if(profile, [&](const Vector2d& p) { return p.x() >= station; });
  if (next == profile.begin()) return profile.front().y();
  if (next == profile.end()) return profile.back().y();
  const Vector2d& before = *std::prev(next);
  return before.y() + (station - before.x()) * grade_between(before, *next);
}

// ---- The file.

// What all readers of a file's parts need.
struct LandXml {
  TextPlaces places;
  const std::vector<std::string>& ignore;  // names of alignments and profiles
  FindingLog& log;
  double metre = 1;  // in the file's unit

  int line_of(const pugi::xml_node& node) const { return places.at(node.offset_debug()).line; }

  // Returns nothing, for readers to return.
  std::nullopt_t error(const pugi::xml_node& node, std::string code, std::string message,
                       std::string hint = {}) const {
    return log.error({line_of(node), 0}, std::move(code), std::move(message), std::move(hint));
  }
};

// The numbers of a node's text; empty when one is none.
std::vector<double> numbers_of(const pugi::xml_node& node) {
  std::vector<double> numbers;
  for (const std::string& word : split_words(node.text().get())) {
    const auto number = parse_number(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// LandXML says north, east; here x is east.
std::optional<Vector2d> place_of(const pugi::xml_node& node) {
  const std::vector<double> numbers = numbers_of(node);
  if (numbers.size() < 2) return std::nullopt;
  return Vector2d(numbers[1], numbers[0]);
}

std::optional<double> number_at(const pugi::xml_node& node, const char* key) {
  return parse_number(node.attribute(key).value());
}

std::string description_of(const pugi::xml_node& point) {
  for (const pugi::xml_node& node : {point, point.parent()}) {
    for (const char* key : {"code", "desc", "name"}) {
      std::string text = node.attribute(key).value();
      if (node == point && key == std::string("name")) continue;
      if (!text.empty()) return text;
    }
  }
  return {};
}

// Metres; nothing for names that the standard does not have.
std::optional<double> metres_of_unit(const std::string& name) {
  static const std::map<std::string, double> kUnits{
      {"millimeter", 1e-3}, {"centimeter", 1e-2},
      {"meter", 1.0},       {"kilometer", 1e3},
      {"foot", kFoot},      {"inch", 0.0254},
      {"mile", 1609.344},   {"USSurveyFoot", kSurveyFoot}};
  const auto found = kUnits.find(name);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

// ---- The alignment: pieces of constant or evenly changing curvature.

struct Piece {
  Vector2d start{0, 0};
  Vector2d end{0, 0};
  double heading = 0;  // from +y towards +x
  Clothoid shape{};    // also a line or an arc; curvatures are 1/radius to the right
};

double heading_of(const Vector2d& way) { return std::atan2(way.x(), way.y()); }

// The piece as it runs, whose end need not be the one that the file says.
Centerline line_of(const Piece& piece) {
  return line_in_world({piece.start, piece.heading, {piece.shape}}, {});
}

// The radius at the key as a curvature; INF is straight.
double curvature_at(const pugi::xml_node& node, const char* key, double sign) {
  const auto radius = number_at(node, key);
  return radius && *radius != 0 ? sign / *radius : 0;
}

// 1 to the right, -1 to the left; nothing where the node does not say it.
std::optional<double> rotation_of(const pugi::xml_node& node) {
  const std::string rotation = node.attribute("rot").value();
  if (rotation == "cw") return 1;
  return rotation == "ccw" ? std::optional(-1.0) : std::nullopt;
}

std::optional<Piece> read_piece(const pugi::xml_node& node) {
  const std::string kind = node.name();
  const auto start = place_of(node.child("Start"));
  const auto end = place_of(node.child("End"));
  if (!start || !end || *start == *end) return std::nullopt;
  Piece piece{*start, *end, heading_of(*end - *start), {(*end - *start).norm(), 0, 0}};
  if (kind == "Line") return piece;
  const auto sign = rotation_of(node);
  if (!sign) return std::nullopt;
  if (kind == "Curve") {
    const auto centre = place_of(node.child("Center"));
    if (!centre) return std::nullopt;
    const Vector2d from = *start - *centre;
    const Vector2d to = *end - *centre;
    double turned = *sign * (heading_of(to) - heading_of(from));
    if (turned < 0) turned += 2 * std::numbers::pi;
    const double curvature = *sign / from.norm();
    piece.shape = {turned * from.norm(), curvature, curvature};
    piece.heading = heading_of(from) + *sign * std::numbers::pi / 2;
    return piece;
  }
  const auto corner = place_of(node.child("PI"));
  const std::string type = node.attribute("spiType").value();
  const auto length = number_at(node, "length");
  if (kind != "Spiral" || !corner || !length || *length <= 0 ||
      (!type.empty() && type != "clothoid")) {
    return std::nullopt;
  }
  piece.shape = {*length, curvature_at(node, "radiusStart", *sign),
                 curvature_at(node, "radiusEnd", *sign)};
  piece.heading = heading_of(*corner - *start);
  return piece;
}

// Whether an angle is that many radians: files write it in degrees, also as dd.mmss, in gon or in
// radians, and their units are often not those that they name.
bool is_angle(double given, double radians) {
  constexpr double kSame = 2e-3;
  const double whole = std::floor(given);
  const double minutes = std::floor(100 * (given - whole) + 1e-6);
  const double seconds = 1e4 * (given - whole) - 100 * minutes;
  const double sexagesimal = whole + minutes / 60 + seconds / 3600;
  const double degree = std::numbers::pi / 180;
  return std::ranges::any_of(
      std::array{given, given * degree, 0.9 * given * degree, sexagesimal * degree},
      [&](double each) { return std::abs(each - radians) <= kSame * std::max(1.0, radians); });
}

// Whether the piece ends where it says and has the stated length, radius and angle, as far as the
// node states them.
bool agrees(const pugi::xml_node& node, const Piece& piece, const Centerline& line, double metre) {
  constexpr double kGap = 0.02;    // metres, as elements may leave between them
  constexpr double kScale = 1e-3;  // of a length: on the ground and in the grid
  const auto is_length = [&](const char* key, double length) {
    const auto given = number_at(node, key);
    return !given || std::abs(*given - length) <= std::max(kGap * metre, kScale * length);
  };
  const auto& [length, from, to] = piece.shape;
  if ((line.at(length).position.head<2>() - piece.end).norm() > kGap * metre) return false;
  if (!is_length("length", length)) return false;
  if (from == 0 || from != to) return true;
  const auto delta = number_at(node, "delta");
  return is_length("radius", 1 / std::abs(from)) &&
         (!delta || is_angle(std::abs(*delta), length * std::abs(from)));
}

// ---- The profile.

// Nothing for a node that is no point of a profile, or does not have all numbers.
std::optional<GradeChange> read_grade_change(const pugi::xml_node& node) {
  const std::string kind = node.name();
  const std::vector<double> numbers = numbers_of(node);
  if (numbers.size() != 2) return std::nullopt;
  GradeChange change{{numbers[0], numbers[1]}};
  if (kind == "PVI") return change;
  const auto length = number_at(node, "length");
  if (kind == "CircCurve") {
    change.radius = number_at(node, "radius");
    change.arc_length = length;
    return change.radius && *change.radius != 0 ? std::optional(change) : std::nullopt;
  }
  if (kind != "ParaCurve" && kind != "UnsymParaCurve") return std::nullopt;
  const bool even = kind == "ParaCurve";
  const auto before = even ? length : number_at(node, "lengthIn");
  const auto behind = even ? length : number_at(node, "lengthOut");
  if (!before || !behind || *before < 0 || *behind < 0) return std::nullopt;
  change.before = even ? *before / 2 : *before;
  change.behind = even ? *behind / 2 : *behind;
  return change;
}

std::string advice_to_ignore(const std::string& name) {
  return "export the alignment again, or leave it out: --ignore " + name.substr(0, 60);
}

// Nothing, with its error logged, where the profile cannot be read.
std::optional<VerticalProfile> read_profile(const pugi::xml_node& node, const LandXml& file) {
  constexpr double kSag = 0.001;  // metres
  const std::string name = std::string(node.attribute("name").value()).substr(0, 60);
  std::vector<GradeChange> changes;
  for (const pugi::xml_node& each : node.children()) {
    if (each.type() != pugi::node_element || each.name() == std::string("Feature")) continue;
    const auto change = read_grade_change(each);
    if (!change) {
      return file.error(
          each, "bad-element",
          fmt::format("{} of profile {}: expected a PVI, ParaCurve, UnsymParaCurve or CircCurve "
                      "with station, height and the curve's length or radius",
                      each.name(), name),
          advice_to_ignore(name));
    }
    changes.push_back(*change);
  }
  Result<VerticalProfile> profile = profile_of_grades(changes, kSag * file.metre);
  if (profile && profile->size() < 2) profile = fail("expected two points at least");
  if (profile) return *profile;
  return file.error(node, "bad-element", "profile " + name + ": " + profile.error().message,
                    advice_to_ignore(name));
}

// Nodes of one kind in several groups, and what they are in words.
struct NodesOfKind {
  pugi::xml_object_range<pugi::xml_named_node_iterator> groups;
  const char* kind;
  const char* words;
};

// The only one that is not ignored, an empty node where there is none. Nothing, with an error
// logged, where there are several.
std::optional<pugi::xml_node> only_one(const NodesOfKind& nodes, const LandXml& file) {
  std::vector<pugi::xml_node> found;
  std::string names;
  for (const pugi::xml_node& group : nodes.groups) {
    for (const pugi::xml_node& each : group.children(nodes.kind)) {
      const std::string name = each.attribute("name").value();
      if (std::ranges::find(file.ignore, name) != file.ignore.end()) continue;
      names += (names.empty() ? "" : ", ") + name.substr(0, 60);
      found.push_back(each);
    }
  }
  if (found.size() < 2) return found.empty() ? pugi::xml_node() : found[0];
  return file.error(found[1], "several-alignments",
                    std::string("several ") + nodes.words + ": " + names.substr(0, 300),
                    "leave all but one out: --ignore NAME,NAME");
}

// The only profile of the alignment that is not ignored, empty where there is none. Nothing, with
// its error logged, where there are several, or it cannot be read.
std::optional<VerticalProfile> profile_of(const pugi::xml_node& alignment, const LandXml& file) {
  const auto node =
      only_one({alignment.children("Profile"), "ProfAlign", "profiles of one alignment"}, file);
  if (!node) return std::nullopt;
  return *node ? read_profile(*node, file) : VerticalProfile{};
}

// Logs where an alignment, between two stations, has no heights.
void check_reach(const VerticalProfile& profile, double from, double to, double slack, int line,
                 const std::string& name, FindingLog& log) {
  if (profile.empty()) return;
  const double first = profile.front().x();
  const double last = profile.back().x();
  const std::string stretches = fmt::format(
      "the profile of alignment {} goes from station {} to {}, the alignment from {} to {}",
      name.substr(0, 60), format_number(first, 3), format_number(last, 3), format_number(from, 3),
      format_number(to, 3));
  if (first >= to || last <= from) {
    log.error({line, 0}, "short-profile", stretches,
              "correct the alignment's first station, staStart, or the profile's stations");
  } else if (!reaches(profile, from, slack) || !reaches(profile, to, slack)) {
    log.warning({line, 0}, "short-profile",
                stretches + ": beyond the profile the floor goes on with its grade there",
                "give the profile the alignment's length, or points of the floor (FL) there");
  }
}

// ---- The alignment's points.

// Where a piece of this length is cut, from 0 to its length: where the profile has a corner, so
// that each element has one grade.
std::vector<double> cuts_of(double length, double chainage, const VerticalProfile& profile) {
  constexpr double kLeast = 0.01;  // of the file's unit
  std::vector<double> cuts{0};
  for (const Vector2d& corner : profile) {
    const double at = corner.x() - chainage;
    if (at > cuts.back() + kLeast && at < length - kLeast) cuts.push_back(at);
  }
  cuts.push_back(length);
  return cuts;
}

void add_elements(const Clothoid& shape, const std::vector<double>& cuts, DesignedLine& line) {
  const double change = (shape.to - shape.from) / shape.length;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    line.elements.push_back(
        {cuts[i + 1] - cuts[i], shape.from + cuts[i] * change, shape.from + cuts[i + 1] * change});
  }
}

// Distances along a piece: its cuts, and others between them at most a step apart.
std::vector<double> steps_between(const std::vector<double>& cuts, double step) {
  std::vector<double> distances{0};
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double length = cuts[i + 1] - cuts[i];
    const int count = std::max(1, static_cast<int>(std::ceil(length / step)));
    for (int k = 1; k <= count; ++k) distances.push_back(cuts[i] + length * k / count);
  }
  return distances;
}

// Where a piece ends.
struct PieceEnd {
  double along = 0;  // from the alignment's start
  Vector2d at{0, 0};
};

// Whether a survey can have the elements, and whether these, joined without bends, pass through the
// pieces' ends.
bool joins(const DesignedLine& line, const std::vector<PieceEnd>& ends, double metre) {
  constexpr double kGap = 0.005;  // metres
  if (line.elements.empty() || line.elements.size() > kMostElements) return false;
  const auto is_usable = [&](double curvature) {
    return curvature == 0 || std::abs(curvature) * kWidestRadius * metre >= 1;
  };
  const bool usable = std::ranges::all_of(line.elements, [&](const Clothoid& element) {
    return is_usable(element.from) && is_usable(element.to);
  });
  if (!usable) return false;
  const Centerline chain = line_in_world(line, {});
  return std::ranges::all_of(ends, [&](const PieceEnd& end) {
    return (chain.at(end.along).position.head<2>() - end.at).norm() <= kGap * metre;
  });
}

void sample_alignment(const pugi::xml_node& alignment, const LandXml& file, RawPoints& result) {
  constexpr double kStep = 0.5;     // metres
  constexpr double kSlack = 0.01;   // that the profile may be shorter
  constexpr double kLongest = 2e4;  // metres of alignment: limits the points
  const std::string name = alignment.attribute("name").value();
  const auto profile = profile_of(alignment, file);
  if (!profile) return;
  const double first = number_at(alignment, "staStart").value_or(0);
  double sampled = 0;
  DesignedLine whole;
  std::vector<PieceEnd> ends;
  for (const pugi::xml_node& node : alignment.child("CoordGeom").children()) {
    if (node.type() != pugi::node_element) continue;
    const auto piece = read_piece(node);
    const Centerline runs = piece ? line_of(*piece) : Centerline{};
    const double chainage = first + sampled;
    if (piece) sampled += piece->shape.length;
    if (!piece || !agrees(node, *piece, runs, file.metre) || sampled > kLongest * file.metre) {
      file.error(node, "bad-element",
                 fmt::format("{} of alignment {}: {}", node.name(), name.substr(0, 60),
                             piece ? "its numbers contradict each other, or it is too long"
                                   : "expected a Line, Curve or clothoid Spiral with all its "
                                     "points, and rot=\"cw\" or \"ccw\" where it bends"),
                 advice_to_ignore(name));
      return;
    }
    if (whole.elements.empty()) whole = {piece->start, piece->heading, {}};
    const std::vector<double> cuts = cuts_of(piece->shape.length, chainage, *profile);
    add_elements(piece->shape, cuts, whole);
    ends.push_back({sampled, piece->end});
    for (const double s : steps_between(cuts, kStep * file.metre)) {
      const Vector2d p = runs.at(s).position.head<2>();
      const bool has_height = reaches(*profile, chainage + s, kSlack * file.metre);
      const double z = has_height ? height_at(*profile, chainage + s) : 0;
      RawPoint point{file.line_of(node), name, "CL", {p.x(), p.y(), z}};
      point.has_height = has_height;
      point.of_alignment = true;
      add_point(result, std::move(point), file.log);
    }
  }
  check_reach(*profile, first, first + sampled, kSlack * file.metre, file.line_of(alignment), name,
              file.log);
  if (joins(whole, ends, file.metre)) result.alignment = std::move(whole);
}

// ---- Points, and what the export of a survey says of all its tags.

void read_points(const pugi::xml_node& group, const LandXml& file, RawPoints& result) {
  for (const pugi::xml_node& node : group.children("CgPoint")) {
    if (node.attribute("pntRef")) continue;
    const std::string name = node.attribute("name").value();
    const std::vector<double> p = numbers_of(node);
    if (p.size() != 3) {
      file.error(node, "bad-number",
                 "point " + name.substr(0, 60) + " is `" +
                     std::string(trim(node.text().get())).substr(0, 60) +
                     "`, expected north, east and elevation");
      continue;
    }
    RawPoint point{file.line_of(node), name, description_of(node), {p[1], p[0], p[2]}};
    point.digits = node.attribute("desc").value();
    if (!add_point(result, std::move(point), file.log)) return;
  }
}

void read_listed(const pugi::xml_node& group, const LandXml& file, RawPoints& result) {
  const pugi::xml_node feature = group.find_child_by_attribute("Feature", "code", kListedSurvey);
  for (const pugi::xml_node& each : feature.children("Property")) {
    result.listed_line = file.line_of(feature);
    result.listed[each.attribute("label").value()] = each.attribute("value").value();
  }
}

}  // namespace

RawPoints landxml_points(std::string_view text, const std::vector<std::string>& ignore,
                         FindingLog& log) {
  RawPoints result;
  LandXml file{TextPlaces(text), ignore, log};
  pugi::xml_document document;
  const auto parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  const pugi::xml_node root = document.child("LandXML");
  if (!parsed || !root) {
    log.error({file.places.at(parsed.offset).line, 0}, "syntax",
              std::string("no valid LandXML: ") + parsed.description(),
              "write the file again with the program that made it");
    return result;
  }
  const pugi::xml_node units = root.child("Units").first_child();
  const std::string unit = units.attribute("linearUnit").value();
  result.metres_per_unit = metres_of_unit(unit);
  if (!result.metres_per_unit) result.unknown_unit = unit;
  file.metre = 1 / result.metres_per_unit.value_or(1);
  result.epsg_code = root.child("CoordinateSystem").attribute("epsgCode").value();
  for (const pugi::xml_node& group : root.children("CgPoints")) {
    read_points(group, file, result);
    read_listed(group, file, result);
  }
  const auto alignment = only_one({root.children("Alignments"), "Alignment", "alignments"}, file);
  if (alignment && *alignment) sample_alignment(*alignment, file, result);
  return result;
}

}  // namespace tagsmith::detail
