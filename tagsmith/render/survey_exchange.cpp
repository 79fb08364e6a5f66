// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/survey_exchange.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

// LandXML puts north before east.
std::string plane_text(const Vector3d& p) {
  return format_number(p.y()) + " " + format_number(p.x());
}

// Radii of LandXML; a straight end has none.
std::string radius_text(double curvature) {
  return curvature == 0 ? "INF" : format_number(1 / std::abs(curvature));
}

// One element, or the arcs of a clothoid.
std::string element_xml(const Survey& survey, double start,
                        std::span<const CenterlineElement> part) {
  const Centerline& line = survey.tunnel.centerline;
  const auto text_of = [&](const Vector3d& p) {
    return plane_text(grid_from_world(survey.grid, p));
  };
  const auto rotation = [&](double curvature) {
    return (curvature > 0) != survey.grid.x_axis_left ? "cw" : "ccw";
  };
  double whole = 0;
  for (const CenterlineElement& element : part) whole += element.length;
  const CenterlinePoint first = line.at(start);
  const CenterlinePoint last = line.at(start + whole);
  const std::string from = text_of(first.position), to = text_of(last.position);
  const std::string length = format_number(whole);
  const double curvature = part.front().curvature;
  if (const auto clothoid = clothoid_of(part)) {
    // Where the directions at both ends meet.
    const Vector3d way = last.position - first.position;
    const double along =
        way.dot(right_of(last.heading)) / direction_of(first.heading).dot(right_of(last.heading));
    return fmt::format(
        "        <Spiral length=\"{}\" radiusEnd=\"{}\" radiusStart=\"{}\" rot=\"{}\" "
        "spiType=\"clothoid\"><Start>{}</Start><PI>{}</PI><End>{}</End></Spiral>\n",
        length, radius_text(clothoid->to), radius_text(clothoid->from),
        rotation(clothoid->from + clothoid->to), from,
        text_of(first.position + along * direction_of(first.heading)), to);
  }
  if (curvature == 0) {
    return fmt::format("        <Line length=\"{}\"><Start>{}</Start><End>{}</End></Line>\n",
                       length, from, to);
  }
  return fmt::format(
      "        <Curve rot=\"{}\" crvType=\"arc\" radius=\"{}\" length=\"{}\"><Start>{}</Start>"
      "<Center>{}</Center><End>{}</End></Curve>\n",
      rotation(curvature), radius_text(curvature), length, from,
      text_of(first.position + right_of(first.heading) / curvature), to);
}

std::string alignment_xml(const Survey& survey) {
  const Centerline& line = survey.tunnel.centerline;
  const std::string name = markup_text(survey.name);
  std::string text = fmt::format(
      "  <Alignments>\n    <Alignment name=\"{}\" length=\"{}\" staStart=\"0\">\n"
      "      <CoordGeom>\n",
      name, format_number(line.length()));
  std::string profile;
  double start = 0;
  const auto add_height = [&](double chainage) {
    profile += fmt::format("          <PVI>{} {}</PVI>\n", format_number(chainage),
                           format_number(line.at(chainage).position.z()));
  };
  std::span<const CenterlineElement> rest = line.elements();
  while (!rest.empty()) {
    const std::span<const CenterlineElement> part = leading_part(rest);
    text += element_xml(survey, start, part);
    add_height(start);
    for (const CenterlineElement& element : part) start += element.length;
    rest = rest.subspan(part.size());
  }
  add_height(start);
  return text + fmt::format(
                    "      </CoordGeom>\n      <Profile name=\"{0}\">\n"
                    "        <ProfAlign name=\"{0}\">\n{1}        </ProfAlign>\n"
                    "      </Profile>\n    </Alignment>\n  </Alignments>\n",
                    name, profile);
}

// A word of 16 characters of data: index, information and unit, sign, data.
std::string gsi_text(const std::string& index, const std::string& text) {
  return fmt::format("{}+{:0>16} ", index, text);
}

// Unit 6: the last digit is a tenth of a millimetre.
std::string gsi_length(const std::string& index, double metres) {
  const auto tenths = std::llround(std::abs(metres) * 1e4);
  return fmt::format("{}..06{}{:016} ", index, metres < 0 && tenths != 0 ? '-' : '+', tenths);
}

}  // namespace

std::string render_landxml(const Survey& survey) {
  std::string date = "1970-01-01";  // of the newest measurement: one survey gives one file
  std::string points;
  for (const PlacedTag& tag : survey.tags) {
    date = std::max(date, tag.date);
    points += fmt::format("    <CgPoint name=\"{0}\" code=\"{0}\" desc=\"{1}\">{2} {3}</CgPoint>\n",
                          tag.name, to_string(tag.digits), plane_text(tag.p_in_grid),
                          format_number(tag.p_in_grid.z()));
  }
  std::string crs;
  if (survey.grid.epsg != 0) {
    crs = fmt::format("  <CoordinateSystem epsgCode=\"{}\"/>\n", survey.grid.epsg);
  }
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\" "
             "date=\"{}\" time=\"00:00:00\">\n"
             "  <Units><Metric areaUnit=\"squareMeter\" linearUnit=\"meter\" "
             "volumeUnit=\"cubicMeter\" temperatureUnit=\"celsius\" pressureUnit=\"milliBars\"/>"
             "</Units>\n{}  <Application name=\"tagsmith\"/>\n",
             date, crs) +
         alignment_xml(survey) + "  <CgPoints name=\"tags\">\n" + points +
         "  </CgPoints>\n</LandXML>\n";
}

std::string render_gsi(const Survey& survey) {
  std::string text;
  int block = 0;
  for (const PlacedTag& tag : survey.tags) {
    const Vector3d& p = tag.p_in_grid;
    text += "*" + gsi_text(fmt::format("11{:04}", ++block % 10'000), tag.name) +
            gsi_length("81", p.x()) + gsi_length("82", p.y()) + gsi_length("83", p.z()) +
            gsi_text("71....", tag.name) + gsi_text("72....", to_string(tag.digits)) + "\r\n";
  }
  return text;
}

}  // namespace tagsmith::detail
