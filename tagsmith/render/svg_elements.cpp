// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/svg_elements.hpp"

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith {

std::string svg_mm(double metres) { return format_number(metres * 1000, 6); }

std::string svg_outline(const TextItem& item) {
  // Finer than a printer's dot by far; nanometres would only swell the file.
  const auto coarse = [](const PlatePoint& p) {
    return format_number(p.x * 1000, 4) + " " + format_number(p.y * 1000, 4);
  };
  std::string path;
  for (const PathSegment& segment : text_outline(item)) {
    const auto& [a, b, c] = segment.points;
    switch (segment.verb) {
      case PathVerb::move:
        path += "M" + coarse(a);
        break;
      case PathVerb::line:
        path += "L" + coarse(a);
        break;
      case PathVerb::curve:
        path += "C" + coarse(a) + " " + coarse(b) + " " + coarse(c);
        break;
      case PathVerb::close:
        path += "Z";
        break;
    }
  }
  return path;
}

}  // namespace tagsmith
