// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sketch.hpp"

#include <algorithm>

namespace tagsmith::detail {

std::vector<double> dashed() { return {0.003, 0.001}; }

std::vector<double> long_dashed_dotted() { return {0.006, 0.001, 0.0003, 0.001}; }

SketchLayer& Sketch::layer(std::string_view name) {
  const auto found = std::ranges::find(layers, name, &SketchLayer::name);
  return found != layers.end() ? *found : layers.emplace_back(SketchLayer{std::string(name), {}});
}

}  // namespace tagsmith::detail
