// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/dxf.hpp"

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith {
namespace {

using Eigen::Vector3d;

struct DxfLayer {
  const char* name;
  int colour;  // AutoCAD colour index
};

constexpr std::array<DxfLayer, 7> kLayers{{{"CENTERLINE", 8},
                                           {"WALLS", 7},
                                           {"PLATES", 5},
                                           {"FRAMES", 3},
                                           {"P", 1},
                                           {"HOLES", 6},
                                           {"NAMES", 7}}};

// Group codes and values, a line each (AutoCAD 2000 DXF Reference, "ASCII DXF Files").
// Why: docs/decisions/0017-files-and-formats.md.
class DxfWriter {
 public:
  void group(int code, std::string_view value) {
    text_ += fmt::format("{:3}\n", code);
    text_ += value;
    text_ += '\n';
  }
  void group(int code, int value) { group(code, fmt::format("{}", value)); }
  void real(int code, double value) { group(code, fmt::format("{:.6f}", value + 0.0)); }
  void point(int code, const Vector3d& p) {
    for (int axis = 0; axis < 3; ++axis) real(code + 10 * axis, p[axis]);
  }
  // Every object has a handle of its own.
  std::string handle(int code = 5) {
    const std::string name = fmt::format("{:X}", next_++);
    group(code, name);
    return name;
  }
  std::string next_handle() const { return fmt::format("{:X}", next_); }
  void begin(std::string_view section) {
    group(0, "SECTION");
    group(2, section);
  }
  void end() { group(0, "ENDSEC"); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int next_ = 0x20;
};

// Owners that entries point to before they are written.
constexpr const char* kModelSpace = "1F";
constexpr const char* kPaperSpace = "1E";

void write_header(DxfWriter& dxf) {
  dxf.begin("HEADER");
  dxf.group(9, "$ACADVER");
  dxf.group(1, "AC1015");
  dxf.group(9, "$HANDSEED");
  dxf.group(5, "FFFFFF");
  dxf.group(9, "$INSUNITS");
  dxf.group(70, 6);  // metres
  dxf.group(9, "$MEASUREMENT");
  dxf.group(70, 1);  // metric
  dxf.end();
  dxf.begin("CLASSES");
  dxf.end();
}

// A symbol table of `entries` records, each begun by `write`.
template <class Write>
void write_table(DxfWriter& dxf, const char* name, int entries, const Write& write) {
  dxf.group(0, "TABLE");
  dxf.group(2, name);
  const std::string table = dxf.handle();
  dxf.group(330, "0");
  dxf.group(100, "AcDbSymbolTable");
  dxf.group(70, entries);
  if (std::string_view(name) == "DIMSTYLE") dxf.group(100, "AcDbDimStyleTable");
  write(table);
  dxf.group(0, "ENDTAB");
}

void begin_record(DxfWriter& dxf, const char* type, const std::string& table,
                  const std::string& subclass, const std::string& name,
                  const char* own_handle = nullptr) {
  dxf.group(0, type);
  if (own_handle != nullptr) {
    dxf.group(5, own_handle);
  } else {
    dxf.handle();
  }
  dxf.group(330, table);
  dxf.group(100, "AcDbSymbolTableRecord");
  dxf.group(100, subclass);
  dxf.group(2, name);
}

void write_line_types(DxfWriter& dxf) {
  write_table(dxf, "LTYPE", 3, [&](const std::string& table) {
    for (const char* name : {"ByBlock", "ByLayer", "Continuous"}) {
      begin_record(dxf, "LTYPE", table, "AcDbLinetypeTableRecord", name);
      dxf.group(70, 0);
      dxf.group(3, "");
      dxf.group(72, 65);
      dxf.group(73, 0);
      dxf.real(40, 0);
    }
  });
}

void write_layers(DxfWriter& dxf) {
  const auto layer = [&](const std::string& table, const char* name, int colour) {
    begin_record(dxf, "LAYER", table, "AcDbLayerTableRecord", name);
    dxf.group(70, 0);
    dxf.group(62, colour);
    dxf.group(6, "Continuous");
  };
  write_table(dxf, "LAYER", static_cast<int>(kLayers.size()) + 1, [&](const std::string& table) {
    layer(table, "0", 7);
    for (const auto& [name, colour] : kLayers) layer(table, name, colour);
  });
}

void write_text_style(DxfWriter& dxf) {
  write_table(dxf, "STYLE", 1, [&](const std::string& table) {
    begin_record(dxf, "STYLE", table, "AcDbTextStyleTableRecord", "Standard");
    dxf.group(70, 0);
    dxf.real(40, 0);
    dxf.real(41, 1);
    dxf.real(50, 0);
    dxf.group(71, 0);
    dxf.real(42, 0.1);
    dxf.group(3, "txt");
    dxf.group(4, "");
  });
}

void write_tables(DxfWriter& dxf) {
  const auto empty = [](const std::string&) {};
  dxf.begin("TABLES");
  write_table(dxf, "VPORT", 0, empty);
  write_line_types(dxf);
  write_layers(dxf);
  write_text_style(dxf);
  write_table(dxf, "VIEW", 0, empty);
  write_table(dxf, "UCS", 0, empty);
  write_table(dxf, "APPID", 1, [&](const std::string& table) {
    begin_record(dxf, "APPID", table, "AcDbRegAppTableRecord", "ACAD");
    dxf.group(70, 0);
  });
  write_table(dxf, "DIMSTYLE", 0, empty);
  write_table(dxf, "BLOCK_RECORD", 2, [&](const std::string& table) {
    begin_record(dxf, "BLOCK_RECORD", table, "AcDbBlockTableRecord", "*Model_Space", kModelSpace);
    begin_record(dxf, "BLOCK_RECORD", table, "AcDbBlockTableRecord", "*Paper_Space", kPaperSpace);
  });
  dxf.end();
}

void write_blocks(DxfWriter& dxf) {
  dxf.begin("BLOCKS");
  for (const auto& [name, owner] :
       {std::pair{"*Model_Space", kModelSpace}, std::pair{"*Paper_Space", kPaperSpace}}) {
    for (const char* type : {"BLOCK", "ENDBLK"}) {
      const bool begins = std::string_view(type) == "BLOCK";
      dxf.group(0, type);
      dxf.handle();
      dxf.group(330, owner);
      dxf.group(100, "AcDbEntity");
      dxf.group(8, "0");
      dxf.group(100, begins ? "AcDbBlockBegin" : "AcDbBlockEnd");
      if (!begins) continue;
      dxf.group(2, name);
      dxf.group(70, 0);
      dxf.point(10, {0, 0, 0});
      dxf.group(3, name);
      dxf.group(1, "");
    }
  }
  dxf.end();
}

void write_objects(DxfWriter& dxf) {
  dxf.begin("OBJECTS");
  dxf.group(0, "DICTIONARY");
  const std::string root = dxf.handle();
  dxf.group(330, "0");
  dxf.group(100, "AcDbDictionary");
  dxf.group(281, 1);
  dxf.group(3, "ACAD_GROUP");
  dxf.group(350, dxf.next_handle());
  dxf.group(0, "DICTIONARY");
  dxf.handle();
  dxf.group(330, root);
  dxf.group(100, "AcDbDictionary");
  dxf.group(281, 1);
  dxf.end();
}

// The handle of what is begun.
std::string begin_entity(DxfWriter& dxf, const char* type, const char* layer,
                         const std::string& owner = kModelSpace) {
  dxf.group(0, type);
  std::string handle = dxf.handle();
  dxf.group(330, owner);
  dxf.group(100, "AcDbEntity");
  dxf.group(8, layer);
  return handle;
}

void write_line(DxfWriter& dxf, const char* layer, const Vector3d& from, const Vector3d& to) {
  begin_entity(dxf, "LINE", layer);
  dxf.group(100, "AcDbLine");
  dxf.point(10, from);
  dxf.point(11, to);
}

void write_point(DxfWriter& dxf, const char* layer, const Vector3d& at) {
  begin_entity(dxf, "POINT", layer);
  dxf.group(100, "AcDbPoint");
  dxf.point(10, at);
}

// One object in space, so that a plate or a wall is picked as a whole.
void write_polyline(DxfWriter& dxf, const char* layer, std::span<const Vector3d> points,
                    bool closed) {
  const std::string polyline = begin_entity(dxf, "POLYLINE", layer);
  dxf.group(100, "AcDb3dPolyline");
  dxf.group(66, 1);  // vertices follow
  dxf.point(10, {0, 0, 0});
  dxf.group(70, closed ? 9 : 8);
  for (const Vector3d& point : points) {
    begin_entity(dxf, "VERTEX", layer, polyline);
    dxf.group(100, "AcDbVertex");
    dxf.group(100, "AcDb3dPolylineVertex");
    dxf.point(10, point);
    dxf.group(70, 32);  // of a polyline in space
  }
  begin_entity(dxf, "SEQEND", layer, polyline);
}

void write_outline(DxfWriter& dxf, const char* layer, const std::array<Vector3d, 4>& corners) {
  write_polyline(dxf, layer, corners, true);
}

// DXF arcs run counter-clockwise in the drawing's x and y.
void write_arc(DxfWriter& dxf, const char* layer, const Vector3d& centre, const Vector3d& from,
               const Vector3d& to, bool counter_clockwise) {
  const auto angle = [&](const Vector3d& p) {
    return degrees(std::atan2(p.y() - centre.y(), p.x() - centre.x()));
  };
  begin_entity(dxf, "ARC", layer);
  dxf.group(100, "AcDbCircle");
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
    const CenterlinePoint point = line.at(chainage);
    return grid_from_world(survey.grid, point.position + to_right * right_of(point.heading));
  };
  double start = 0;
  for (const CenterlineElement& element : line.elements()) {
    const double end = start + element.length;
    // At the end of an element `at` speaks of the next one, which begins at the same place.
    if (element.curvature == 0) {
      write_line(dxf, layer, in_grid(start, offset), in_grid(end, offset));
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
  const auto [left, right] = plate_ends(plate);
  const double top = -(plate.plate_height - plate.frame_inner_height) / 2 + plate.frame_offset_up;
  const double bottom = top + plate.plate_height;
  write_outline(
      dxf, "PLATES",
      {in_grid(left, top), in_grid(right, top), in_grid(right, bottom), in_grid(left, bottom)});
  const double length = plate.frame_inner_length;
  const double height = plate.frame_inner_height;
  write_outline(dxf, "FRAMES",
                {in_grid(0, 0), in_grid(length, 0), in_grid(length, height), in_grid(0, height)});
  write_point(dxf, "P", tag.p_in_grid);
  for (const DrillHole& hole : plate.holes) {
    write_point(dxf, "HOLES",
                in_grid((left + right) / 2 + hole.right, (top + bottom) / 2 - hole.up));
  }
  begin_entity(dxf, "TEXT", "NAMES");
  dxf.group(100, "AcDbText");
  dxf.point(10, tag.p_in_grid);
  dxf.real(40, 0.1);
  dxf.group(1, tag.name + "  " + to_string(tag.digits));
  dxf.group(100, "AcDbText");
}

}  // namespace

std::string render_dxf(const Survey& survey) {
  DxfWriter dxf;
  write_header(dxf);
  write_tables(dxf);
  write_blocks(dxf);
  dxf.begin("ENTITIES");
  write_parallel(dxf, "CENTERLINE", survey, 0);
  for (const Side side : {Side::left, Side::right}) write_rock(dxf, survey, side);
  for (const PlacedTag& tag : survey.tags) write_tag(dxf, survey, tag);
  dxf.end();
  write_objects(dxf);
  dxf.group(0, "EOF");
  return dxf.text();
}

}  // namespace tagsmith
