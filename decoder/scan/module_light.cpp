// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/module_light.hpp"

#include <algorithm>
#include <cmath>

#include "tagsmith/base/normal.hpp"

namespace tagsmith {
namespace {

constexpr float kHalfLength = kModuleCount / 2.0F;

std::array<float, kModuleCount + 1> displaced_edges(const SymbolImage& image) {
  std::array<float, kModuleCount + 1> edges{};
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const float nominal = static_cast<float>(k) - kHalfLength;
    const float t = nominal / kHalfLength;
    edges[k] = static_cast<float>(k) + static_cast<float>(image.shift) +
               static_cast<float>(image.stretch) * nominal + static_cast<float>(image.bend) * t * t;
  }
  return edges;
}

// How far from an edge, in modules, a point spread of this standard deviation lets it matter.
float reach_of(const SymbolImage& image, float blur) {
  return std::min(14.0F, 4 * blur + static_cast<float>(std::abs(image.growth)) / 2);
}

std::size_t band_of(const ScanProfile& profile, const SymbolImage& image) {
  double widest = 1;
  for (const ScanBin& bin : profile) widest = std::max(widest, bin.spread);
  const float reach = reach_of(image, static_cast<float>(image.blur * widest));
  // Edges within reach of one place lie within twice the reach of each other.
  return std::min(ModuleLight::kMostFeatures,
                  2 * static_cast<std::size_t>(std::ceil(2.1F * reach)) + 3);
}

}  // namespace

ModuleLight::ModuleLight(const ScanProfile& profile, const SymbolImage& image)
    : contrast_(static_cast<float>(image.black - image.white)), band_(band_of(profile, image)) {
  places_.reserve(profile.size());
  light_.reserve(profile.size() * (band_ + kLanes));
  const auto edges = displaced_edges(image);
  std::size_t first = 0;
  for (const ScanBin& bin : profile) add(bin, image, edges, first);
}

// Adds one place: its light is the sum over the edges within reach of a step, and of the modules
// between them. The mean of the steps of a bar's begin and of its end at the same nominal place
// belongs to the module, half their difference to the growth of the edge.
void ModuleLight::add(const ScanBin& bin, const SymbolImage& image,
                      const std::array<float, kModuleCount + 1>& edges, std::size_t& first) {
  const NormalTable& normal = NormalTable::get();
  const float at = static_cast<float>(bin.at);
  const float blur = static_cast<float>(image.blur * bin.spread);
  const float reach = reach_of(image, blur);
  while (first < edges.size() && edges[first] < at - reach) ++first;
  const float t = (at - kHalfLength) / kHalfLength;
  const float half_growth = static_cast<float>(image.growth) / 2;
  const float per_blur = 1 / blur;
  std::array<float, kMostFeatures> light;
  std::size_t count = 0;
  float before = 1;  // step of the edge before
  std::size_t k = first;
  for (; k < edges.size() && edges[k] < at + reach && count + 2 < kMostFeatures; ++k) {
    const float z = (at - edges[k]) * per_blur;
    float step = 0, growth = 0;
    if (half_growth == 0) {
      step = normal(z).integral;
    } else {
      const float widened = normal(z + half_growth * per_blur).integral;
      const float narrowed = normal(z - half_growth * per_blur).integral;
      step = (widened + narrowed) / 2;
      growth = (widened - narrowed) / 2;
    }
    if (k > 0) light[count++] = before - step;
    light[count++] = growth;
    before = step;
  }
  if (k < edges.size() && k > 0 && k > first) light[count++] = before;
  if (k == first && k > 0 && k < edges.size()) light[count++] = 1;  // in the midst of one module
  Place place;
  place.begin = first == 0 ? 0 : 2 * first - 1;  // the module before the first edge
  place.count = count;
  place.offset = light_.size();
  place.value =
      (static_cast<float>(bin.darkness - image.white) - static_cast<float>(image.shading) * t) /
      contrast_;
  places_.push_back(place);
  light_.insert(light_.end(), light.begin(), light.begin() + static_cast<std::ptrdiff_t>(count));
  light_.resize(light_.size() + kLanes);
}

}  // namespace tagsmith
