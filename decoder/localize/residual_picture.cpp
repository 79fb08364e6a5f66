// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/residual_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kCaption = 60;  // pixels above each image

// The largest residual of the used corners becomes about a twelfth of the image's width; a round
// factor.
double enlargement(const Fix& fix, int width) {
  double largest = 1e-6;
  for (const FittedCorners& corners : fix.corners) {
    for (std::size_t i = 0; corners.used && i < 4; ++i) {
      largest = std::max(largest, distance(corners.seen[i], corners.fitted[i]));
    }
  }
  const double factor = width / 12.0 / largest;
  const double power = std::pow(10, std::floor(std::log10(factor)));
  const double first = factor / power;
  return std::max(1.0, power * (first >= 5 ? 5 : first >= 2 ? 2 : 1));
}

std::string tag_drawing(const FittedCorners& tag, double factor) {
  const char* colour = tag.used ? "#b00020" : "#909090";
  std::string text = "<polygon fill='none' stroke='#404040' stroke-width='2' points='";
  for (const PixelPoint& corner : tag.seen)
    text += fmt::format("{:.2f},{:.2f} ", corner.x, corner.y);
  text += "'/>\n";
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint from = tag.fitted[i];
    const PixelPoint to = from + factor * (tag.seen[i] - tag.fitted[i]);
    text += fmt::format(
        "<circle cx='{:.2f}' cy='{:.2f}' r='5' fill='{}'/>\n"
        "<line x1='{:.2f}' y1='{:.2f}' x2='{:.2f}' y2='{:.2f}' stroke='{}' stroke-width='4'/>\n",
        from.x, from.y, colour, from.x, from.y, to.x, to.y, colour);
  }
  const PixelPoint middle = 0.25 * (tag.seen[0] + tag.seen[1] + tag.seen[2] + tag.seen[3]);
  text +=
      fmt::format("<text x='{:.1f}' y='{:.1f}' font-size='28' text-anchor='middle'>{}{}</text>\n",
                  middle.x, middle.y, markup_text(tag.tag), tag.used ? "" : " (not used)");
  return text;
}

}  // namespace

std::string residual_picture(const Fix& fix, const Rig& rig) {
  double width = 0;
  double height = 0;
  for (const RigCamera& camera : rig.cameras) {
    width += camera.camera.width + 20;
    height = std::max(height, camera.camera.height + kCaption);
  }
  const double factor = enlargement(fix, rig.cameras.front().camera.width);
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='sans-serif'>\n<rect width='{0}' height='{1}' fill='white'/>\n",
      width, height);
  double left = 0;
  for (const RigCamera& camera : rig.cameras) {
    svg += fmt::format(
        "<svg x='{}' y='{}' width='{}' height='{}'>\n"
        "<rect width='100%' height='100%' fill='none' stroke='black' stroke-width='3'/>\n",
        left, kCaption, camera.camera.width, camera.camera.height);
    for (const FittedCorners& tag : fix.corners) {
      if (tag.camera == camera.name) svg += tag_drawing(tag, factor);
    }
    svg += fmt::format(
        "</svg>\n<text x='{}' y='{}' font-size='28'>{}, camera {}: residuals x {:g}</text>\n",
        left + 8, kCaption - 18, markup_text(fix.id), markup_text(camera.name), factor);
    left += camera.camera.width + 20;
  }
  return svg + "</svg>\n";
}

}  // namespace tagsmith::detail
