// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/shown_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "decoder/feature_frame/tuning.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

// Where an edge may be in a slice, from white inside to black.
struct EdgePlace {
  int slice = 0;
  double along = 0;
  double across = 0;
};

// An edge's line in the coordinates of samples.
struct EdgeLine {
  double place = 0;
  double turn = 0;
  double bow = 0;  // how far its middle stands outwards from its ends

  double off(const EdgePlace& edge) const {
    return edge.across - place - turn * edge.along - bow * (1 - edge.along * edge.along);
  }
};

std::size_t slice_of(const EdgeSample& sample) {
  return static_cast<std::size_t>(zone_at(sample.along, kSlices));
}

// By which share of the brighter value the darker one is below it: the same in shadow.
float contrast_of(float dark, float bright) { return (bright - dark) / std::max(1.0F, bright); }

// The falls of a slice from its white to its black; none where it has hardly the side's contrast.
void add_edges(std::vector<EdgeSample>& slice, int number, float contrast,
               std::vector<EdgePlace>& edges) {
  if (slice.size() < 4) return;
  std::ranges::sort(slice, {}, &EdgeSample::across);
  const auto [dark, bright] = std::ranges::minmax(slice, {}, &EdgeSample::value);
  const float least = static_cast<float>(kEdgeFit.slice_contrast) * contrast;
  if (contrast_of(dark.value, bright.value) < least) return;
  const float middle = (dark.value + bright.value) / 2;
  for (std::size_t i = 1; i < slice.size(); ++i) {
    const EdgeSample& before = slice[i - 1];
    const EdgeSample& after = slice[i];
    if (before.value < middle || after.value >= middle) continue;
    const float share = (before.value - middle) / (before.value - after.value);
    edges.push_back({number,
                     static_cast<double>(before.along + share * (after.along - before.along)),
                     static_cast<double>(before.across + share * (after.across - before.across))});
  }
}

// Which slices have an edge so near a line.
std::array<bool, kSlices> slices_on(const EdgeLine& line, const std::vector<EdgePlace>& edges,
                                    double tolerance) {
  std::array<bool, kSlices> on{};
  for (const EdgePlace& edge : edges) {
    if (std::abs(line.off(edge)) < tolerance) on[static_cast<std::size_t>(edge.slice)] = true;
  }
  return on;
}

std::ptrdiff_t count_on(const EdgeLine& line, const std::vector<EdgePlace>& edges,
                        double tolerance) {
  return std::ranges::count(slices_on(line, edges, tolerance), true);
}

// The bowed line through three edges.
EdgeLine through(const EdgePlace& a, const EdgePlace& b, const EdgePlace& c) {
  const double first = (b.across - a.across) / (b.along - a.along);
  const double second = (c.across - b.across) / (c.along - b.along);
  const double square = (second - first) / (c.along - a.along);
  const double turn = first - square * (a.along + b.along);
  return {a.across - turn * a.along + square * (1 - a.along * a.along), turn, -square};
}

// Whether one bow goes through all slices but one.
bool lie_on_bow(const std::vector<EdgePlace>& edges, double tolerance) {
  constexpr int kQuarter = kSlices / 4;
  for (const EdgePlace& a : edges) {
    if (a.slice >= kQuarter) continue;
    for (const EdgePlace& b : edges) {
      if (b.slice < kSlices / 2 - 2 || b.slice >= kSlices / 2 + 2) continue;
      for (const EdgePlace& c : edges) {
        if (c.slice < kSlices - kQuarter) continue;
        if (count_on(through(a, b, c), edges, tolerance) >= kSlices - 1) return true;
      }
    }
  }
  return false;
}

// Through the edges of two slices that are not neighbours; that which most slices are on.
EdgeLine best_line(const std::vector<EdgePlace>& edges, double tolerance) {
  EdgeLine best;
  std::ptrdiff_t most = 0;
  for (const EdgePlace& a : edges) {
    for (const EdgePlace& b : edges) {
      if (b.slice - a.slice < kSlices / 4) continue;
      const double turn = (b.across - a.across) / (b.along - a.along);
      const EdgeLine line{a.across - turn * a.along, turn, 0};
      const std::ptrdiff_t count = count_on(line, edges, tolerance);
      if (count <= most) continue;
      most = count;
      best = line;
    }
  }
  return best;
}

}  // namespace

std::optional<ShownPart> shown_part(std::vector<EdgeSample> samples, double noise) {
  std::array<std::vector<EdgeSample>, kSlices> slices;
  std::vector<float> values;
  for (const EdgeSample& sample : samples) {
    slices[slice_of(sample)].push_back(sample);
    values.push_back(sample.value);
  }
  if (values.empty()) return std::nullopt;
  const float bright = quantile(values, 0.9), dark = quantile(values, 0.1);
  std::vector<EdgePlace> edges;
  for (int i = 0; i < kSlices; ++i) {
    add_edges(slices[static_cast<std::size_t>(i)], i, contrast_of(dark, bright), edges);
  }
  const double tolerance =
      kEdgeFit.slice_off + 2 * noise / std::max(1.0, static_cast<double>(bright - dark));
  if (lie_on_bow(edges, tolerance)) return std::nullopt;
  const EdgeLine line = best_line(edges, tolerance);
  const auto on = slices_on(line, edges, tolerance);
  const auto count = std::ranges::count(on, true);
  if (count < kSlices / 2 || count == kSlices) return std::nullopt;
  std::erase_if(samples, [&](const EdgeSample& sample) { return !on[slice_of(sample)]; });
  return ShownPart{line.place, line.turn, std::move(samples)};
}

}  // namespace tagsmith::detail
