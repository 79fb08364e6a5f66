// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <pugixml.hpp>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/length_units.hpp"
#include "tagsmith/survey/point_formats.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/survey/tunnel_limits.hpp"
#include "tagsmith/survey/xml_document.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

int line_of(const pugi::xml_node& node, const TextPlaces& places) {
  return places.at(node.offset_debug()).line;
}

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
  double length = 0;
  double curvature = 0;  // 1/radius to the right, at its start
  double change = 0;     // of the curvature, per unit of length
};

double heading_of(const Vector2d& way) { return std::atan2(way.x(), way.y()); }

// Simpson's rule over steps short against the bend.
Vector2d along(const Piece& piece, double distance) {
  const int steps = 2 * (8 + static_cast<int>(std::min(
                                 200.0, 50 * std::abs(distance * piece.change) * piece.length)));
  const auto direction = [&](double s) -> Vector2d {
    const double heading = piece.heading + s * piece.curvature + s * s * piece.change / 2;
    return direction_of(heading).head<2>();
  };
  if (piece.change == 0 && piece.curvature == 0) return piece.start + distance * direction(0);
  if (piece.change == 0) {
    const double end = piece.heading + distance * piece.curvature;
    return piece.start + (right_of(piece.heading) - right_of(end)).head<2>() / piece.curvature;
  }
  Vector2d sum(0, 0);
  const double h = distance / steps;
  for (int i = 0; i <= steps; ++i) {
    sum += (i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2) * direction(i * h);
  }
  return piece.start + h / 3 * sum;
}

// The radius at the key as a curvature; INF is straight.
double curvature_at(const pugi::xml_node& node, const char* key, double sign) {
  const auto radius = parse_number(node.attribute(key).value());
  return radius && *radius != 0 ? sign / *radius : 0;
}

std::optional<Piece> read_piece(const pugi::xml_node& node) {
  const std::string kind = node.name();
  const auto start = place_of(node.child("Start"));
  const auto end = place_of(node.child("End"));
  if (!start || !end || *start == *end) return std::nullopt;
  Piece piece{*start, *end, heading_of(*end - *start), (*end - *start).norm(), 0, 0};
  if (kind == "Line") return piece;
  const double sign = node.attribute("rot").value() == std::string("cw") ? 1 : -1;
  if (kind == "Curve") {
    const auto centre = place_of(node.child("Center"));
    if (!centre) return std::nullopt;
    const Vector2d from = *start - *centre;
    const Vector2d to = *end - *centre;
    double turned = sign * (heading_of(to) - heading_of(from));
    if (turned < 0) turned += 2 * std::numbers::pi;
    piece.curvature = sign / from.norm();
    piece.length = turned * from.norm();
    piece.heading = heading_of(from) + sign * std::numbers::pi / 2;
    return piece;
  }
  const auto corner = place_of(node.child("PI"));
  const std::string type = node.attribute("spiType").value();
  const auto length = parse_number(node.attribute("length").value());
  if (kind != "Spiral" || !corner || !length || *length <= 0 ||
      (!type.empty() && type != "clothoid")) {
    return std::nullopt;
  }
  piece.length = *length;
  piece.heading = heading_of(*corner - *start);
  piece.curvature = curvature_at(node, "radiusStart", sign);
  piece.change = (curvature_at(node, "radiusEnd", sign) - piece.curvature) / *length;
  return piece;
}

// Chainages and heights of a profile; empty where the alignment has none.
std::vector<Vector2d> profile_of(const pugi::xml_node& alignment) {
  std::vector<Vector2d> profile;
  for (const pugi::xml_node& node : alignment.child("Profile").child("ProfAlign").children()) {
    const std::vector<double> numbers = numbers_of(node);
    if (numbers.size() == 2) profile.emplace_back(numbers[0], numbers[1]);
  }
  return profile;
}

double height_at(const std::vector<Vector2d>& profile, double chainage) {
  const auto next =
      std::ranges::find_if(profile, [&](const Vector2d& p) { return p.x() >= chainage; });
  if (next == profile.begin()) return profile.front().y();
  if (next == profile.end()) return profile.back().y();
  const Vector2d& before = *std::prev(next);
  return before.y() + (chainage - before.x()) / (next->x() - before.x()) * (next->y() - before.y());
}

// The piece cut where the profile has a corner, so that each element has one grade.
void add_elements(const Piece& piece, double chainage, const std::vector<Vector2d>& profile,
                  DesignedLine& line) {
  constexpr double kLeast = 0.01;  // of the file's unit
  std::vector<double> cuts{0};
  for (const Vector2d& corner : profile) {
    const double at = corner.x() - chainage;
    if (at > cuts.back() + kLeast && at < piece.length - kLeast) cuts.push_back(at);
  }
  cuts.push_back(piece.length);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    line.elements.push_back({cuts[i + 1] - cuts[i], piece.curvature + cuts[i] * piece.change,
                             piece.curvature + cuts[i + 1] * piece.change});
  }
}

// Where a piece ends.
struct PieceEnd {
  double along = 0;  // from the alignment's start
  Vector2d at{0, 0};
};

// Whether the elements, put to each other without bends, pass through the pieces' ends.
bool joins(const DesignedLine& line, const std::vector<PieceEnd>& ends, double gap) {
  if (line.elements.empty() || line.elements.size() > kMostElements) return false;
  const Centerline chain = line_in_world(line, {});
  return std::ranges::all_of(ends, [&](const PieceEnd& end) {
    return (chain.at(end.along).position.head<2>() - end.at).norm() <= gap;
  });
}

void sample_alignment(const pugi::xml_node& alignment, double metre, const TextPlaces& places,
                      RawPoints& result, FindingLog& log) {
  constexpr double kStep = 0.5;      // metres
  constexpr double kGap = 0.02;      // that elements may leave between them
  constexpr double kJoined = 0.005;  // that the whole may be off a piece's end
  constexpr double kLongest = 2e4;   // metres of alignment: bounds the points
  const std::string name = alignment.attribute("name").value();
  const std::vector<Vector2d> profile = profile_of(alignment);
  double chainage = parse_number(alignment.attribute("staStart").value()).value_or(0);
  double sampled = 0;
  DesignedLine whole;
  std::vector<PieceEnd> ends;
  for (const pugi::xml_node& node : alignment.child("CoordGeom").children()) {
    if (node.type() != pugi::node_element) continue;
    const int line = line_of(node, places);
    const auto piece = read_piece(node);
    const bool closes = piece && (along(*piece, piece->length) - piece->end).norm() <= kGap * metre;
    if (closes) sampled += piece->length;
    if (!closes || sampled > kLongest * metre) {
      log.error(
          {line, 0}, "bad-element",
          fmt::format("{} of alignment {}: {}", node.name(), name.substr(0, 60),
                      piece ? "its numbers contradict each other, or it is too long"
                            : "expected a Line, Curve or clothoid Spiral with all its points"),
          "export the alignment again, or leave it out: --ignore " + name.substr(0, 60));
      return;
    }
    if (whole.elements.empty()) whole = {piece->start, piece->heading, {}};
    add_elements(*piece, chainage, profile, whole);
    ends.push_back({sampled, piece->end});
    const int count = std::max(1, static_cast<int>(std::ceil(piece->length / (kStep * metre))));
    for (int i = 0; i <= count; ++i) {
      const double s = piece->length * i / count;
      const Vector2d p = along(*piece, s);
      const double z = profile.empty() ? 0 : height_at(profile, chainage + s);
      add_point(result, {line, name, "CL", {p.x(), p.y(), z}, !profile.empty(), true}, log);
    }
    chainage += piece->length;
  }
  if (joins(whole, ends, kJoined * metre)) result.alignment = std::move(whole);
}

void read_alignments(const pugi::xml_node& root, const std::vector<std::string>& ignore,
                     const TextPlaces& places, RawPoints& result, FindingLog& log) {
  std::vector<pugi::xml_node> alignments;
  std::string names;
  for (const pugi::xml_node& each : root.child("Alignments").children("Alignment")) {
    const std::string name = each.attribute("name").value();
    if (std::ranges::find(ignore, name) != ignore.end()) continue;
    names += (names.empty() ? "" : ", ") + name.substr(0, 60);
    alignments.push_back(each);
  }
  if (alignments.empty()) return;
  if (alignments.size() > 1) {
    log.error({line_of(alignments[1], places), 0}, "several-alignments",
              "several alignments: " + names.substr(0, 300),
              "leave all but one out: --ignore NAME,NAME");
    return;
  }
  sample_alignment(alignments[0], 1 / result.metres_per_unit.value_or(1), places, result, log);
}

}  // namespace

RawPoints landxml_points(std::string_view text, const std::vector<std::string>& ignore,
                         FindingLog& log) {
  RawPoints result;
  const TextPlaces places(text);
  pugi::xml_document document;
  const auto parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  const pugi::xml_node root = document.child("LandXML");
  if (!parsed || !root) {
    log.error({places.at(parsed.offset).line, 0}, "syntax",
              std::string("no valid LandXML: ") + parsed.description(),
              "write the file again with the program that made it");
    return result;
  }
  const pugi::xml_node units = root.child("Units").first_child();
  result.metres_per_unit = metres_of_unit(units.attribute("linearUnit").value());
  const std::string epsg = root.child("CoordinateSystem").attribute("epsgCode").value();
  result.epsg = parse_crs("EPSG:" + epsg).value_or(0);
  for (const pugi::xml_node& group : root.children("CgPoints")) {
    for (const pugi::xml_node& node : group.children("CgPoint")) {
      if (node.attribute("pntRef")) continue;
      const int line = line_of(node, places);
      const std::string name = node.attribute("name").value();
      const std::vector<double> p = numbers_of(node);
      if (p.size() != 3) {
        log.error({line, 0}, "bad-number",
                  "point " + name.substr(0, 60) + " is `" +
                      std::string(trim(node.text().get())).substr(0, 60) +
                      "`, expected north, east and elevation");
        continue;
      }
      if (!add_point(result, {line, name, description_of(node), {p[1], p[0], p[2]}}, log)) break;
    }
  }
  read_alignments(root, ignore, places, result, log);
  return result;
}

}  // namespace tagsmith::detail
