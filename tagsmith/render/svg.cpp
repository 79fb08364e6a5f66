// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/svg.hpp"

#include <span>

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
    group += "<path d=\"" + svg_outline(item) + "\"><title>" + svg_escaped(item.text) +
             "</title></path>\n";
  }
  return group + "</g>\n";
}

std::string tag_elements(const TagDrawing& tag) {
  std::string bars;
  for (const Rectangle& bar : tag.bars) bars += rectangle_path(bar);
  std::string arrows;
  for (const UpArrow& arrow : tag.arrows) arrows += arrow_path(arrow);
  std::string elements = "<path id=\"feature-frame\" fill-rule=\"evenodd\" d=\"" +
                         rectangle_path(tag.frame_outer) + rectangle_path(tag.frame_inner) +
                         "\"/>\n" + element("bars", bars);
  if (!arrows.empty()) elements += element("up-arrow", arrows);
  if (!tag.label.empty()) elements += text_group("label", tag.label);
  return elements;
}

std::string mark_elements(const Page& page) {
  std::string path;
  for (const PageLine& line : page.lines) {
    path += "M" + point(line.from.x, line.from.y) + "L" + point(line.to.x, line.to.y);
  }
  return "<path id=\"marks\" fill=\"none\" stroke=\"#000000\" stroke-width=\"" +
         svg_mm(page.line_width) + "\" d=\"" + path + "\"/>\n" + text_group("notes", page.texts);
}

}  // namespace

std::string render_svg(const Page& page) {
  const std::string width = svg_mm(page.width);
  const std::string height = svg_mm(page.height);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
         width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height +
         "\" fill=\"#000000\">\n<title>" + svg_escaped(page.notes.title) + "</title>\n<desc>" +
         svg_escaped(page.notes.subject) + "</desc>\n<rect id=\"page\" width=\"" + width +
         "\" height=\"" + height + "\" fill=\"#ffffff\"/>\n" + tag_elements(page.tag) +
         mark_elements(page) + "</svg>\n";
}

}  // namespace tagsmith
