// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/svg.hpp"

#include <span>

#include "tagsmith/base/printable.hpp"
#include "tagsmith/render/svg_elements.hpp"

namespace tagsmith {
namespace {

std::string point(double x, double y) { return svg_mm(x) + " " + svg_mm(y); }

std::string rectangle_path(const Rectangle& rectangle) {
  return "M" + point(rectangle.x, rectangle.y) + "H" + svg_mm(rectangle.x + rectangle.width) + "V" +
         svg_mm(rectangle.y + rectangle.height) + "H" + svg_mm(rectangle.x) + "Z";
}

std::string arrow_path(const UpArrow& arrow) {
  std::string path;
  for (const PlatePoint& corner : outline_of(arrow)) {
    path += (path.empty() ? "M" : "L") + point(corner.x, corner.y);
  }
  return path + "Z";
}

std::string element(const std::string& id, const std::string& path) {
  return "<path id=\"" + id + "\" d=\"" + path + "\"/>\n";
}

// The text itself goes along as the outline's title, for people who look for it.
std::string text_group(const std::string& id, std::span<const TextItem> items) {
  std::string group = "<g id=\"" + id + "\">\n";
  for (const TextItem& item : items) {
    group += "<path d=\"" + svg_outline(item) + "\"><title>" + markup_text(item.text) +
             "</title></path>\n";
  }
  return group + "</g>\n";
}

std::string circle(const HoleOutline& hole) {
  return "<circle cx=\"" + svg_mm(hole.centre.x) + "\" cy=\"" + svg_mm(hole.centre.y) + "\" r=\"" +
         svg_mm(hole.radius) + "\"/>\n";
}

std::string cross_path(const HoleOutline& hole) {
  const auto& [x, y] = hole.centre;
  return "M" + point(x - hole.radius, y) + "H" + svg_mm(x + hole.radius) + "M" +
         point(x, y - hole.radius) + "V" + svg_mm(y + hole.radius);
}

// Outlines of `width` millimetres without a fill.
std::string stroked_group(const std::string& id, const char* colour, double width,
                          const std::string& elements) {
  return "<g id=\"" + id + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"" +
         svg_mm(width) + "\">\n" + elements + "</g>\n";
}

std::string hole_elements(const TagDrawing& tag, double line_width) {
  std::string elements;
  std::string crosses;
  for (const HoleOutline& hole : tag.holes) {
    if (!tag.cut_contour) elements += circle(hole);
    crosses += cross_path(hole);
  }
  return stroked_group("drill-holes", "#000000", line_width,
                       elements + "<path d=\"" + crosses + "\"/>\n");
}

// Cutting plotters take the group by its name or its colour.
std::string contour_elements(const TagDrawing& tag, double line_width) {
  const Rectangle& plate = tag.plate;
  std::string elements = "<rect x=\"" + svg_mm(plate.x) + "\" y=\"" + svg_mm(plate.y) +
                         "\" width=\"" + svg_mm(plate.width) + "\" height=\"" +
                         svg_mm(plate.height) + "\" rx=\"" + svg_mm(tag.corner_radius) + "\"/>\n";
  for (const HoleOutline& hole : tag.holes) elements += circle(hole);
  return stroked_group("CutContour", "#ff00ff", line_width, elements);
}

std::string patch_elements(const ReferencePatches& patches, double line_width) {
  return element("black-patch", rectangle_path(patches.black)) +
         stroked_group("white-patch", "#000000", line_width,
                       "<path d=\"" + rectangle_path(patches.white) + "\"/>\n");
}

std::string tag_elements(const TagDrawing& tag, double line_width) {
  std::string bars;
  for (const Rectangle& bar : tag.bars) bars += rectangle_path(bar);
  std::string arrows;
  for (const UpArrow& arrow : tag.arrows) arrows += arrow_path(arrow);
  std::string elements = "<path id=\"feature-frame\" fill-rule=\"evenodd\" d=\"" +
                         rectangle_path(tag.frame_outer) + rectangle_path(tag.frame_inner) +
                         "\"/>\n" + element("bars", bars);
  if (!arrows.empty()) elements += element("up-arrow", arrows);
  if (tag.patches) elements += patch_elements(*tag.patches, line_width);
  if (!tag.holes.empty()) elements += hole_elements(tag, line_width);
  if (!tag.label.empty()) elements += text_group("label", tag.label);
  if (tag.cut_contour) elements += contour_elements(tag, line_width);
  return elements;
}

// A page of one tag has its parts at the top; of several tags each is a group, its parts named
// after it, because an `id` is unique.
std::string tags_elements(const Page& page) {
  if (page.tags.size() == 1 && !page.tags[0].window) {
    return tag_elements(page.tags[0].drawing, page.line_width);
  }
  std::string elements;
  for (std::size_t i = 0; i < page.tags.size(); ++i) {
    const PageTag& tag = page.tags[i];
    const std::string number = std::to_string(i + 1);
    std::string clip;
    if (tag.window) {
      clip = " clip-path=\"url(#window-" + number + ")\"";
      elements += "<clipPath id=\"window-" + number + "\"><path d=\"" +
                  rectangle_path(*tag.window) + "\"/></clipPath>\n";
    }
    std::string parts = tag_elements(tag.drawing, page.line_width);
    for (std::size_t at = parts.find(" id=\""); at != std::string::npos;
         at = parts.find(" id=\"", at + 1)) {
      parts.insert(at + 5, "tag-" + number + "-");
    }
    elements += "<g id=\"tag-" + number + "\"" + clip + ">\n<title>" + markup_text(tag.name) +
                "</title>\n" + parts + "</g>\n";
  }
  return elements;
}

std::string lines_element(const Page& page, bool dashed) {
  std::string path;
  for (const PageLine& line : page.lines) {
    if (line.dashed != dashed) continue;
    path += "M" + point(line.from.x, line.from.y) + "L" + point(line.to.x, line.to.y);
  }
  if (path.empty()) return {};
  return std::string("<path id=\"") + (dashed ? "dashed-marks" : "marks") +
         "\" fill=\"none\" stroke=\"#000000\" stroke-width=\"" + svg_mm(page.line_width) + "\"" +
         (dashed ? " stroke-dasharray=\"2 1\"" : "") + " d=\"" + path + "\"/>\n";
}

std::string mark_elements(const Page& page) {
  return lines_element(page, false) + lines_element(page, true) + text_group("notes", page.texts);
}

}  // namespace

std::string render_svg(const Page& page) {
  const std::string width = svg_mm(page.width);
  const std::string height = svg_mm(page.height);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
         width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height +
         "\" fill=\"#000000\">\n<title>" + markup_text(page.notes.title) + "</title>\n<desc>" +
         markup_text(page.notes.subject +
                     (page.notes.keywords.empty() ? "" : "; " + page.notes.keywords)) +
         "</desc>\n<rect id=\"page\" width=\"" + width + "\" height=\"" + height +
         "\" fill=\"#ffffff\"/>\n" + tags_elements(page) + mark_elements(page) + "</svg>\n";
}

}  // namespace tagsmith
