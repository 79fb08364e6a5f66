// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/survey_exchange.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/printable.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

// LandXML puts north before east.
std::string plane_text(const Vector3d& p) {
  return format_number(p.y()) + " " + format_number(p.x());
}

std::string element_xml(const Survey& survey, double start, const CenterlineElement& element) {
  const Centerline& line = survey.tunnel.centerline;
  const auto in_grid = [&](const Vector3d& p) { return grid_from_world(survey.grid, p); };
  const CenterlinePoint first = line.at(start);
  const std::string from = plane_text(in_grid(first.position));
  const std::string to = plane_text(in_grid(line.at(start + element.length).position));
  const std::string length = format_number(element.length);
  if (element.curvature == 0) {
    return fmt::format("        <Line length=\"{}\"><Start>{}</Start><End>{}</End></Line>\n",
                       length, from, to);
  }
  const Vector3d centre = first.position + right_of(first.heading) / element.curvature;
  const bool clockwise = (element.curvature > 0) != survey.grid.x_axis_left;
  return fmt::format(
      "        <Curve rot=\"{}\" crvType=\"arc\" radius=\"{}\" length=\"{}\"><Start>{}</Start>"
      "<Center>{}</Center><End>{}</End></Curve>\n",
      clockwise ? "cw" : "ccw", format_number(1 / std::abs(element.curvature)), length, from,
      plane_text(in_grid(centre)), to);
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
  for (const CenterlineElement& element : line.elements()) {
    text += element_xml(survey, start, element);
    add_height(start);
    start += element.length;
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
