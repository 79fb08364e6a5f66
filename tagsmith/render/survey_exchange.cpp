// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/survey_exchange.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/render/tunnel_plan.hpp"
#include "tagsmith/survey/listed_survey.hpp"

namespace tagsmith::detail {

// ---- DXF.

namespace {

using Eigen::Vector3d;

struct DxfLayer {
  const char* name;
  int colour;  // AutoCAD colour index
};

constexpr std::array<DxfLayer, 8> kLayers{{{"0", 7},
                                           {"CENTERLINE", 8},
                                           {"WALLS", 7},
                                           {"PLATES", 5},
                                           {"FRAMES", 3},
                                           {"P", 1},
                                           {"HOLES", 6},
                                           {"NAMES", 7}}};

// Owners that entries point to before they are written.
constexpr const char* kModelSpace = "1F";
constexpr const char* kPaperSpace = "1E";

// Group codes and values, a line each (AutoCAD 2000 DXF Reference, "ASCII DXF Files").
// Why: docs/decisions/0015-files-and-ledger.md.
class DxfWriter {
 public:
  void group(int code, std::string_view value) {
    text_ += fmt::format("{:3}\n", code);
    text_ += value;
    text_ += '\n';
  }

  // "100 AcDbText, 70 1": groups separated by commas. The value # makes a handle of its own for an
  // object; the last of them is returned.
  std::string groups(const std::string& list) {
    std::string handle;
    for (const std::string& each : split(list, ',')) {
      const std::string_view group_text = trim(each);
      const std::size_t blank = std::min(group_text.find(' '), group_text.size());
      std::string value(trim(group_text.substr(blank)));
      if (value == "#") value = handle = fmt::format("{:X}", next_++);
      group(std::stoi(each), value);
    }
    return handle;
  }

  void real(int code, double value) { group(code, fmt::format("{:.6f}", value + 0.0)); }
  void point(int code, const Vector3d& p) {
    for (int axis = 0; axis < 3; ++axis) real(code + 10 * axis, p[axis]);
  }

  // The handle of what is begun.
  std::string entity(std::string_view type, std::string_view layer, std::string_view subclass,
                     std::string_view owner = kModelSpace) {
    group(0, type);
    std::string handle = groups("5 #");
    group(330, owner);
    group(100, "AcDbEntity");
    group(8, layer);
    if (!subclass.empty()) group(100, subclass);
    return handle;
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int next_ = 0x20;
};

struct DxfRecord {
  std::string name;
  std::string rest{};        // groups behind the name, each after a comma
  std::string handle = "#";  // # = any
};

// A symbol table. `subclass`: of its records, without "AcDb" and "TableRecord".
void write_table(DxfWriter& dxf, const std::string& type, const std::string& subclass = {},
                 const std::vector<DxfRecord>& records = {}) {
  const std::string table =
      dxf.groups(fmt::format("0 TABLE, 2 {}, 5 #, 330 0, 100 AcDbSymbolTable, 70 {}{}", type,
                             records.size(), type == "DIMSTYLE" ? ", 100 AcDbDimStyleTable" : ""));
  for (const auto& [name, rest, handle] : records) {
    dxf.groups(
        fmt::format("0 {}, 5 {}, 330 {}, 100 AcDbSymbolTableRecord, "
                    "100 AcDb{}TableRecord, 2 {}{}",
                    type, handle, table, subclass, name, rest));
  }
  dxf.groups("0 ENDTAB");
}

void write_tables(DxfWriter& dxf) {
  const std::string line_type = ", 70 0, 3, 72 65, 73 0, 40 0.000000";
  std::vector<DxfRecord> layers;
  for (const auto& [name, colour] : kLayers) {
    layers.push_back({name, fmt::format(", 70 0, 62 {}, 6 Continuous", colour)});
  }
  dxf.groups("0 SECTION, 2 TABLES");
  write_table(dxf, "VPORT");
  write_table(dxf, "LTYPE", "Linetype",
              {{"ByBlock", line_type}, {"ByLayer", line_type}, {"Continuous", line_type}});
  write_table(dxf, "LAYER", "Layer", layers);
  write_table(
      dxf, "STYLE", "TextStyle",
      {{"Standard", ", 70 0, 40 0.000000, 41 1.000000, 50 0.000000, 71 0, 42 0.100000, 3 txt, 4"}});
  write_table(dxf, "VIEW");
  write_table(dxf, "UCS");
  write_table(dxf, "APPID", "RegApp", {{"ACAD", ", 70 0"}});
  write_table(dxf, "DIMSTYLE");
  write_table(dxf, "BLOCK_RECORD", "Block",
              {{"*Model_Space", "", kModelSpace}, {"*Paper_Space", "", kPaperSpace}});
  dxf.groups("0 ENDSEC");
}

// The sections before the entities: metres, metric; tables; two empty blocks.
void write_head(DxfWriter& dxf) {
  dxf.groups("0 SECTION, 2 HEADER, 9 $ACADVER, 1 AC1015, 9 $HANDSEED, 5 FFFFFF, 9 $INSUNITS, 70 6");
  dxf.groups("9 $MEASUREMENT, 70 1, 0 ENDSEC, 0 SECTION, 2 CLASSES, 0 ENDSEC");
  write_tables(dxf);
  dxf.groups("0 SECTION, 2 BLOCKS");
  for (const auto& [name, owner] :
       {std::pair{"*Model_Space", kModelSpace}, std::pair{"*Paper_Space", kPaperSpace}}) {
    dxf.entity("BLOCK", "0", "AcDbBlockBegin", owner);
    dxf.groups(fmt::format("2 {}, 70 0", name));
    dxf.point(10, {0, 0, 0});
    dxf.groups(fmt::format("3 {}, 1", name));
    dxf.entity("ENDBLK", "0", "AcDbBlockEnd", owner);
  }
  dxf.groups("0 ENDSEC");
}

// The sections behind them: a dictionary that holds an empty one.
void write_tail(DxfWriter& dxf) {
  const std::string root = dxf.groups("0 SECTION, 2 OBJECTS, 0 DICTIONARY, 5 #");
  const std::string inner = fmt::format("{:X}", std::stoi(root, nullptr, 16) + 1);
  dxf.groups("330 0, 100 AcDbDictionary, 281 1, 3 ACAD_GROUP, 350 " + inner);
  dxf.groups("0 DICTIONARY, 5 #, 330 " + root + ", 100 AcDbDictionary, 281 1, 0 ENDSEC, 0 EOF");
}

void write_point(DxfWriter& dxf, const char* layer, const Vector3d& at) {
  dxf.entity("POINT", layer, "AcDbPoint");
  dxf.point(10, at);
}

// One object in space, so that a plate or a wall is picked as a whole.
void write_polyline(DxfWriter& dxf, const char* layer, std::span<const Vector3d> points,
                    bool closed) {
  const std::string polyline = dxf.entity("POLYLINE", layer, "AcDb3dPolyline");
  dxf.group(66, "1");  // vertices follow
  dxf.point(10, {0, 0, 0});
  dxf.group(70, closed ? "9" : "8");
  for (const Vector3d& point : points) {
    dxf.entity("VERTEX", layer, "AcDbVertex", polyline);
    dxf.group(100, "AcDb3dPolylineVertex");
    dxf.point(10, point);
    dxf.group(70, "32");  // of a polyline in space
  }
  dxf.entity("SEQEND", layer, "", polyline);
}

// DXF arcs run counter-clockwise in the drawing's x and y.
void write_arc(DxfWriter& dxf, const char* layer, const Vector3d& centre, const Vector3d& from,
               const Vector3d& to, bool counter_clockwise) {
  const auto angle = [&](const Vector3d& p) {
    return degrees(std::atan2(p.y() - centre.y(), p.x() - centre.x()));
  };
  dxf.entity("ARC", layer, "AcDbCircle");
  dxf.point(10, centre);
  dxf.real(40, (from - centre).norm());
  dxf.group(100, "AcDbArc");
  dxf.real(50, angle(counter_clockwise ? from : to));
  dxf.real(51, angle(counter_clockwise ? to : from));
}

// A line beside the center line, element by element.
void write_parallel(DxfWriter& dxf, const char* layer, const Survey& survey, double offset) {
  const Centerline& line = survey.tunnel.centerline;
  const auto in_grid = [&](double chainage, double to_right) {
    return grid_from_world(survey.grid, point_beside(line, chainage, to_right));
  };
  double start = 0;
  for (const CenterlineElement& element : line.elements()) {
    const double end = start + element.length;
    // At the end of an element `at` returns the next one, which begins at the same place.
    if (element.curvature == 0) {
      dxf.entity("LINE", layer, "AcDbLine");
      dxf.point(10, in_grid(start, offset));
      dxf.point(11, in_grid(end, offset));
    } else if (element.grade == 0) {
      const bool turns_left = (element.curvature < 0) != survey.grid.x_axis_left;
      write_arc(dxf, layer, in_grid(start, 1 / element.curvature), in_grid(start, offset),
                in_grid(end, offset), turns_left);
    } else {
      const double angle = element.length * std::abs(element.curvature);
      const int count = std::max(1, static_cast<int>(std::ceil(angle / radians(2))));
      std::vector<Vector3d> points;
      for (int i = 0; i <= count; ++i) {
        points.push_back(in_grid(start + element.length * i / count, offset));
      }
      write_polyline(dxf, layer, points, false);
    }
    start = end;
  }
}

void write_rock(DxfWriter& dxf, const Survey& survey, Side side) {
  constexpr double kSag = 0.001;
  const Centerline& line = survey.tunnel.centerline;
  const ChainageProfile rock = rock_of(survey.tunnel, side);
  if (rock.is_constant()) {
    write_parallel(dxf, "WALLS", survey, rock.at(0));
    return;
  }
  std::vector<Vector3d> points;
  for (const SidePoint& point : side_points(line, rock, 0, line.length(), kSag)) {
    points.push_back(grid_from_world(survey.grid, point.position));
  }
  write_polyline(dxf, "WALLS", points, false);
}

void write_tag(DxfWriter& dxf, const Survey& survey, const PlacedTag& tag) {
  const TagTemplate& plate = survey.tag_template;
  const auto in_grid = [&](double right, double down) {
    return grid_from_world(survey.grid, tag.world_from_plate * Vector3d(right, down, 0));
  };
  const auto write_outline = [&](const char* layer, const Rectangle& box) {
    std::vector<Vector3d> corners;
    for (const auto& [right, down] : corners_of(box)) corners.push_back(in_grid(right, down));
    write_polyline(dxf, layer, corners, true);
  };
  const Rectangle outline = plate_outline(plate);
  write_outline("PLATES", outline);
  write_outline("FRAMES", {0, 0, plate.frame_inner_length, plate.frame_inner_height});
  write_point(dxf, "P", tag.p_in_grid);
  for (const DrillHole& hole : plate.holes) {
    write_point(dxf, "HOLES",
                in_grid(outline.x + outline.width / 2 + hole.right,
                        outline.y + outline.height / 2 - hole.up));
  }
  dxf.entity("TEXT", "NAMES", "AcDbText");
  dxf.point(10, tag.p_in_grid);
  dxf.real(40, 0.1);
  dxf.group(1, tag.name + "  " + to_string(tag.digits));
  dxf.group(100, "AcDbText");
}

}  // namespace

std::string render_dxf(const Survey& survey) {
  DxfWriter dxf;
  write_head(dxf);
  dxf.groups("0 SECTION, 2 ENTITIES");
  write_parallel(dxf, "CENTERLINE", survey, 0);
  for (const Side side : {Side::left, Side::right}) write_rock(dxf, survey, side);
  for (const PlacedTag& tag : survey.tags) write_tag(dxf, survey, tag);
  dxf.groups("0 ENDSEC");
  write_tail(dxf);
  return dxf.text();
}

// ---- LandXML and GSI.

namespace {

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

// The values that all tags share, by the columns of the CSV.
std::vector<std::pair<std::string, std::string>> listed_survey(const Survey& survey) {
  const PositionCode& code = survey.code;
  std::vector<std::pair<std::string, std::string>> listed{
      {"template", survey.tag_template.name},
      {"check_digit", to_string(code.check)},
      {"x_axis", survey.grid.x_axis_left ? "left" : "right"}};
  constexpr std::array kAxes{"x", "y", "z"};
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    listed.emplace_back(std::string("digits_") + kAxes[i], std::to_string(code.digit_counts[i]));
    listed.emplace_back(std::string("resolution_") + kAxes[i], format_number(code.resolution[i]));
    listed.emplace_back(std::string("origin_") + kAxes[i], format_number(code.origin[i]));
  }
  const std::array plate = listed_plate(survey.tag_template);
  constexpr std::array kLengths{"plate_length", "plate_height", "frame_length", "frame_height"};
  for (std::size_t i = 0; i < plate.size(); ++i) {
    listed.emplace_back(kLengths[i], format_number(plate[i]));
  }
  return listed;
}

// A word of 16 bytes of data: index, information and unit, sign, data.
std::string gsi_text(const std::string& index, const std::string& text) {
  const std::string zeros(16 - std::min<std::size_t>(16, text.size()), '0');
  return index + "+" + zeros + text + " ";
}

// Unit 6: the last digit is a tenth of a millimetre.
std::string gsi_length(const std::string& index, double metres) {
  const auto tenths = std::llround(std::abs(metres) * 1e4);
  return fmt::format("{}..06{}{:016} ", index, metres < 0 && tenths != 0 ? '-' : '+', tenths);
}

// A block 41 with the name (at most 15 characters) in word 42 and the text in 43 to 49, behind
// signs of equality, since zeros on the left are padding.
std::string gsi_listed(int block, const std::string& name, const std::string& text) {
  constexpr std::size_t kPart = 15;
  constexpr int kLastWord = 49;
  std::string line =
      "*" + gsi_text(fmt::format("41{:04}", block), kListedSurvey) + gsi_text("42....", "=" + name);
  for (int word = 43; word <= kLastWord; ++word) {
    const std::size_t from = kPart * static_cast<std::size_t>(word - 43);
    if (from < text.size()) {
      line += gsi_text(std::to_string(word) + "....", "=" + text.substr(from, kPart));
    }
  }
  return line + "\r\n";
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
  std::string listed;
  for (const auto& [name, text] : listed_survey(survey)) {
    listed += fmt::format("      <Property label=\"{}\" value=\"{}\"/>\n", name, markup_text(text));
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
         fmt::format("    <Feature code=\"{}\">\n{}    </Feature>\n", kListedSurvey, listed) +
         "  </CgPoints>\n</LandXML>\n";
}

std::string render_gsi(const Survey& survey) {
  std::string text;
  int block = 0;
  for (const auto& [name, value] : listed_survey(survey)) text += gsi_listed(++block, name, value);
  for (const PlacedTag& tag : survey.tags) {
    const Vector3d& p = tag.p_in_grid;
    text += "*" + gsi_text(fmt::format("11{:04}", ++block % 10'000), tag.name) +
            gsi_length("81", p.x()) + gsi_length("82", p.y()) + gsi_length("83", p.z()) +
            gsi_text("71....", tag.name) + gsi_text("72....", to_string(tag.digits)) + "\r\n";
  }
  return text;
}

}  // namespace tagsmith::detail
