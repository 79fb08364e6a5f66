// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/svg.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {
namespace {

using Points = std::vector<Eigen::Vector2d>;

// Ten nanometres are finer than any plotter, and keep files small.
std::string mm(double metres) { return mm_text(metres, 5); }

std::string colour(std::string_view attribute, const Colour& colour) {
  const auto level = [](double share) { return std::lround(std::clamp(share, 0.0, 1.0) * 255); };
  return fmt::format(" {}=\"#{:02x}{:02x}{:02x}\"", attribute, level(colour.red),
                     level(colour.green), level(colour.blue));
}

std::string path_data(const Points& points, bool closed) {
  std::string path;
  for (const Eigen::Vector2d& point : points) {
    path += (path.empty() ? "M" : "L") + mm(point.x()) + " " + mm(point.y());
  }
  return path + (closed ? "Z" : "");
}

std::string element(const SheetLine& line) {
  std::string dashes;
  for (const double dash : line.line.dashes) dashes += (dashes.empty() ? "" : " ") + mm(dash);
  return "<path fill=\"none\"" + colour("stroke", line.line.colour) + " stroke-width=\"" +
         mm(line.line.width) + "\" stroke-linejoin=\"round\"" +
         (dashes.empty() ? "" : " stroke-dasharray=\"" + dashes + "\"") + " d=\"" +
         path_data(line.points, line.closed) + "\"/>\n";
}

std::string element(const SheetArea& area) {
  std::string path;
  for (const Points& outline : area.outlines) path += path_data(outline, true);
  return "<path" + colour("fill", area.fill) +
         (area.outlines.size() > 1 ? " fill-rule=\"evenodd\"" : "") + " d=\"" + path + "\"/>\n";
}

std::string element(const SheetText& text) {
  const std::string turn =
      text.angle == 0 ? "" : " rotate(" + format_number(-degrees(text.angle), 6) + ")";
  return "<path" + colour("fill", text.colour) + " transform=\"translate(" + mm(text.at.x()) + " " +
         mm(text.at.y()) + ")" + turn + "\" d=\"" + text_path(text) + "\"><title>" +
         markup_text(text.text) + "</title></path>\n";
}

std::string element(const SheetPicture& picture) {
  if (picture.jpeg.empty()) return "";
  return "<image x=\"" + mm(picture.at.x()) + "\" y=\"" + mm(picture.at.y()) + "\" width=\"" +
         mm(picture.width) + "\" height=\"" + mm(picture.height) +
         "\" preserveAspectRatio=\"none\" href=\"data:image/jpeg;base64," + base64(picture.jpeg) +
         "\"/>\n";
}

std::string group(const SheetLayer& layer) {
  const std::string id = markup_text(layer.name);
  std::string text;
  if (layer.window) {
    const Eigen::Vector2d from = layer.window->min();
    const Eigen::Vector2d to = layer.window->max();
    text += "<clipPath id=\"" + id + "-window\"><path d=\"" +
            path_data({from, {to.x(), from.y()}, to, {from.x(), to.y()}}, true) +
            "\"/></clipPath>\n";
  }
  text += "<g id=\"" + id + "\"" + (layer.window ? " clip-path=\"url(#" + id + "-window)\"" : "") +
          ">\n";
  if (!layer.title.empty()) text += "<title>" + markup_text(layer.title) + "</title>\n";
  for (const SheetItem& item : layer.items) {
    text += std::visit([](const auto& value) { return element(value); }, item);
  }
  return text + "</g>\n";
}

}  // namespace

std::string render_svg(const Sheet& sheet) {
  const std::string width = mm(sheet.width);
  const std::string height = mm(sheet.height);
  const std::string subject = sheet.subject + (sheet.keywords.empty() ? "" : "; " + sheet.keywords);
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height +
      "\">\n<title>" + markup_text(sheet.title) + "</title>\n<desc>" + markup_text(subject) +
      "</desc>\n<rect width=\"" + width + "\" height=\"" + height + "\" fill=\"#ffffff\"/>\n";
  for (const SheetLayer& layer : sheet.layers) svg += group(layer);
  return svg + "</svg>\n";
}

}  // namespace tagsmith::detail
