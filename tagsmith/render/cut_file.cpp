// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/cut_file.hpp"

#include <vector>

#include <fmt/format.h>

#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {
namespace {

// A corner of an outline; with a bulge, a quarter of a circle leads to the next.
struct Corner {
  double x = 0;
  double y = 0;
  bool round = false;
};

std::string place(const Page& page, double x, double y) {
  return fmt::format(" 10\n{:.4f}\n 20\n{:.4f}\n", x * 1000 + 0.0, (page.height - y) * 1000 + 0.0);
}

std::vector<Corner> outline_of(const Rectangle& plate, double radius) {
  const double right = plate.x + plate.width;
  const double bottom = plate.y + plate.height;
  if (radius <= 0) {
    return {{plate.x, bottom}, {right, bottom}, {right, plate.y}, {plate.x, plate.y}};
  }
  return {{plate.x + radius, bottom},  {right - radius, bottom, true},
          {right, bottom - radius},    {right, plate.y + radius, true},
          {right - radius, plate.y},   {plate.x + radius, plate.y, true},
          {plate.x, plate.y + radius}, {plate.x, bottom - radius, true}};
}

std::string polyline(const Page& page, const std::vector<Corner>& corners) {
  // Tangent of a quarter of the arc's angle (AutoCAD DXF Reference, VERTEX, group 42).
  constexpr const char* kQuarterArc = " 42\n0.41421356\n";
  std::string text = fmt::format("  0\nPOLYLINE\n  8\n{}\n 66\n1\n 70\n1\n", kCutContour);
  for (const Corner& corner : corners) {
    text += fmt::format("  0\nVERTEX\n  8\n{}\n", kCutContour) + place(page, corner.x, corner.y);
    if (corner.round) text += kQuarterArc;
  }
  return text + "  0\nSEQEND\n";
}

}  // namespace

std::string render_cut_file(const Page& page) {
  std::string text =
      "  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n  9\n$INSUNITS\n 70\n4\n"
      "  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n";
  for (const PageTag& tag : page.tags) {
    const Rectangle plate = on_page(tag, tag.drawing.plate);
    text += polyline(page, outline_of(plate, tag.drawing.corner_radius));
    for (const HoleOutline& hole : tag.drawing.holes) {
      const PlatePoint centre = on_page(tag, hole.centre);
      text += fmt::format("  0\nCIRCLE\n  8\n{}\n", kCutContour) + place(page, centre.x, centre.y) +
              fmt::format(" 40\n{:.4f}\n", hole.radius * 1000);
    }
  }
  return text + "  0\nENDSEC\n  0\nEOF\n";
}

}  // namespace tagsmith::detail
