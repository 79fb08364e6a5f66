// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sketch.hpp"

#include <algorithm>
#include <utility>

namespace tagsmith {

std::vector<double> dashed() { return {0.003, 0.001}; }

std::vector<double> long_dashed_dotted() { return {0.006, 0.001, 0.0003, 0.001}; }

void SketchLayer::add(Area area) { items.emplace_back(std::move(area)); }
void SketchLayer::add(Polyline line) { items.emplace_back(std::move(line)); }
void SketchLayer::add(const Ellipse& ellipse) { items.emplace_back(ellipse); }
void SketchLayer::add(const Dot& dot) { items.emplace_back(dot); }
void SketchLayer::add(const Arrow& arrow) { items.emplace_back(arrow); }
void SketchLayer::add(Words words) { items.emplace_back(std::move(words)); }
void SketchLayer::add(Dimension dimension) { items.emplace_back(std::move(dimension)); }
void SketchLayer::add(Picture picture) { items.emplace_back(std::move(picture)); }

SketchLayer& Sketch::layer(std::string_view name) {
  const auto found = std::ranges::find(layers, name, &SketchLayer::name);
  return found != layers.end() ? *found : layers.emplace_back(SketchLayer{std::string(name), {}});
}

}  // namespace tagsmith
