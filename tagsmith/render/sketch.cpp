// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sketch.hpp"

#include <algorithm>

namespace tagsmith::detail {

std::vector<double> dashed() { return {0.003, 0.001}; }

std::vector<double> long_dashed_dotted() { return {0.006, 0.001, 0.0003, 0.001}; }

double add_lines(SketchLayer& layer, const std::vector<std::string>& lines, double y,
                 const Colour& colour, double height, double step) {
  for (const std::string& line : lines) {
    layer.add(Words{.text = line, .at = on_paper(0, y), .height = height, .colour = colour});
    y -= step;
  }
  return y;
}

SketchLayer& Sketch::layer(std::string_view name) {
  const auto found = std::ranges::find(layers, name, &SketchLayer::name);
  return found != layers.end() ? *found : layers.emplace_back(SketchLayer{std::string(name), {}});
}

}  // namespace tagsmith::detail
