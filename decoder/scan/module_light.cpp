// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/module_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "decoder/scan/edge_step.hpp"

namespace tagsmith::detail {
namespace {

using Edges = std::array<float, kModuleCount + 1>;

Edges displaced_edges(const ImagingModel& image) {
  Edges edges{};
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const float nominal = static_cast<float>(k) - kHalfLength;
    const float t = nominal / kHalfLength;
    edges[k] = static_cast<float>(k) + static_cast<float>(image.shift) +
               static_cast<float>(image.stretch) * nominal + static_cast<float>(image.bend) * t * t;
  }
  return edges;
}

// The distance from an edge, in modules, up to which a point spread of this standard deviation
// reaches.
float reach_of(const ImagingModel& image, float spread) {
  const double reach = (4 * image.blur + image.pixel / 2) * static_cast<double>(spread);
  return std::min(14.0F, static_cast<float>(reach + std::abs(image.growth) / 2));
}

std::size_t band_of(const ScanProfile& profile, const ImagingModel& image) {
  double widest = 1;
  for (const ScanBin& bin : profile) widest = std::max(widest, bin.spread);
  const float reach = reach_of(image, static_cast<float>(widest));
  // Edges within reach of one place lie within twice the reach of each other.
  return std::min(ModuleLight::kMostFeatures,
                  2 * static_cast<std::size_t>(std::ceil(2.1F * reach)) + 3);
}

// The steps at a place of a bar's begin and of its end at the same nominal place: their mean, and
// half their difference.
struct Step {
  float mean = 0, growth = 0;
};

Step step_at(const EdgeStep& edge, float behind, float half_growth) {
  if (half_growth == 0) return {edge(behind).integral, 0};
  const float widened = edge(behind + half_growth).integral;
  const float narrowed = edge(behind - half_growth).integral;
  return {(widened + narrowed) / 2, (widened - narrowed) / 2};
}

// Writes what features add to a place: its light is the sum over the edges within reach of a step,
// and of the modules between them. The mean step of an edge belongs to the module, the rest to the
// growth of the edge. Returns how many features, from the module before edge `first` on.
std::size_t write_light(const Edges& edges, std::size_t first, float at, float reach,
                        const EdgeStep& edge, float half_growth, float* light) {
  std::size_t count = 0;
  float before = 1;  // step of the edge before
  std::size_t k = first;
  for (; k < edges.size() && edges[k] < at + reach && count + 2 < ModuleLight::kMostFeatures; ++k) {
    const Step step = step_at(edge, at - edges[k], half_growth);
    if (k > 0) light[count++] = before - step.mean;
    light[count++] = step.growth;
    before = step.mean;
  }
  if (k < edges.size() && k > 0 && k > first) light[count++] = before;
  if (k == first && k > 0 && k < edges.size()) light[count++] = 1;  // within one module
  return count;
}

}  // namespace

ModuleLight::ModuleLight(const ScanProfile& profile, const ImagingModel& image)
    : contrast_(static_cast<float>(image.black - image.white)),
      band_(band_of(profile, image)),
      places_(profile.size()),
      light_((profile.size() + 1) * (band_ + kLanes) + kMostFeatures) {
  const Edges edges = displaced_edges(image);
  const auto shading = static_cast<float>(image.shading);
  const float half_growth = static_cast<float>(image.growth) / 2;
  std::size_t first = 0, offset = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const ScanBin& bin = profile[i];
    const auto at = static_cast<float>(bin.at);
    const EdgeStep edge(static_cast<float>(image.blur * bin.spread),
                        static_cast<float>(image.pixel * bin.spread));
    const float reach = reach_of(image, static_cast<float>(bin.spread));
    while (first < edges.size() && edges[first] < at - reach) ++first;
    if (offset + kMostFeatures + kLanes > light_.size()) light_.resize(2 * light_.size());
    Place& place = places_[i];
    place.begin = first == 0 ? 0 : 2 * first - 1;  // the module before the first edge
    place.count = write_light(edges, first, at, reach, edge, half_growth, &light_[offset]);
    place.offset = offset;
    const float t = (at - kHalfLength) / kHalfLength;
    place.value = (static_cast<float>(bin.darkness - image.white) - shading * t) / contrast_;
    offset += place.count + kLanes;
  }
}

}  // namespace tagsmith::detail
