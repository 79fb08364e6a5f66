// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/edge_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

// Places of pixels in a line, relative to a side.
struct EvenPlaces {
  float along, across;  // of the first
  float step_along, step_across;

  EvenPlaces from(int place) const {
    const auto steps = static_cast<float>(place);
    return {along + steps * step_along, across + steps * step_across, step_along, step_across};
  }
};

// Pixels near a side, grouped by how far along and how far across they lie: fine across near the
// edge, where the light changes within a pixel, coarse elsewhere. Not coarse where the stroke's
// other edge is included: a mean over two pixels has no definite place, and a different one where
// perspective tapers the stroke.
class EdgeBins {
 public:
  EdgeBins(float inward, float outward, bool both_edges, int zones)
      : zones_(zones),
        inward_(inward),
        outward_(outward),
        rows_across_(inward, both_edges ? 2 : 1 / std::max(0.5F, coarse_span(inward, outward) / 8)),
        rows_(static_cast<std::size_t>(rows_across_.index_of(outward)) + 1) {
    bins_.resize(static_cast<std::size_t>(zones_) * rows_);
  }

  // Adds `count` pixels, `stride` apart, at even places.
  void add(EvenPlaces places, const std::uint8_t* pixel, std::ptrdiff_t stride, int count) {
    std::array<std::int32_t, 64> bins;
    constexpr auto at_once = static_cast<int>(bins.size());
    for (; count > 0; count -= at_once, places = places.from(at_once)) {
      const int here = std::min(count, at_once);
      find_bins(places, here, bins.data());
      for (int i = 0; i < here; ++i, pixel += stride) {
        const auto at = static_cast<std::size_t>(i);
        if (bins[at] < 0) continue;
        EdgeSample& bin = bins_[static_cast<std::size_t>(bins[at])];
        const auto steps = static_cast<float>(i);
        bin.along += places.along + steps * places.step_along;
        bin.across += places.across + steps * places.step_across;
        bin.value += static_cast<float>(*pixel);
        bin.weight += 1;
      }
    }
  }

  std::vector<EdgeSample> samples() {
    std::erase_if(bins_, [](const EdgeSample& bin) { return bin.weight == 0; });
    for (EdgeSample& bin : bins_) {
      const float share = 1 / bin.weight;
      bin.along *= share;
      bin.across *= share;
      bin.value *= share;
    }
    return std::move(bins_);
  }

 private:
  static float coarse_span(float inward, float outward) {
    return std::max(0.0F, inward - kEdgeFit.fine) + std::max(0.0F, outward - kEdgeFit.fine);
  }

  // Which row of bins a place across the edge is in: one of the coarse ones before the fine ones,
  // of these, or of the coarse ones behind them. Only constants are chosen, so that the compiler
  // can use its vectors.
  struct Rows {
    float per_coarse, before, within, behind;  // row = across * scale + one of these

    Rows(float inward, float in_coarse)
        : per_coarse(in_coarse),
          before(inward * in_coarse),
          within(std::ceil(std::max(0.0F, inward - kEdgeFit.fine) * in_coarse) +
                 kEdgeFit.fine * kEdgeFit.per_pixel),
          behind(within + kEdgeFit.fine * (kEdgeFit.per_pixel - in_coarse) + 1) {}

    std::int32_t index_of(float across) const {
      const bool is_fine = std::abs(across) <= kEdgeFit.fine;
      const float scale = is_fine ? kEdgeFit.per_pixel : per_coarse;
      const float coarse = across < 0 ? before : behind;
      const float first = is_fine ? within : coarse;
      return static_cast<std::int32_t>(across * scale + first);
    }
  };

  // The bin of each of the next places; -1 = none.
  TAGSMITH_WIDE void find_bins(const EvenPlaces& places, int count, std::int32_t* bins) const {
    const auto per_along = 0.5F * static_cast<float>(zones_);
    const auto rows = static_cast<std::int32_t>(rows_);
    const std::int32_t last_zone = zones_ - 1;
    const Rows across_rows = rows_across_;
    const float inward = inward_, outward = outward_;
    const EvenPlaces at = places;
    TAGSMITH_INDEPENDENT_TURNS
    for (int i = 0; i < count; ++i) {
      const auto steps = static_cast<float>(i);
      const float along = at.along + steps * at.step_along;
      const float across = at.across + steps * at.step_across;
      const auto zone = static_cast<std::int32_t>((along + 1) * per_along);
      const std::int32_t bin =
          std::max(0, std::min(zone, last_zone)) * rows + across_rows.index_of(across);
      const bool is_held = (across >= -inward) & (across <= outward);
      bins[i] = bin | (static_cast<std::int32_t>(is_held) - 1);
    }
  }

  int zones_;
  float inward_;
  float outward_;
  Rows rows_across_;
  std::size_t rows_;
  std::vector<EdgeSample> bins_;
};

using ClippedSlices = std::array<bool, kSlices>;

// Slices along a side in which the white, so many pixels inside its edge, is clipped: a lamp's
// beam. An edge there appears farther out, by an unknown distance. None where too few others are
// left to fit the side, or where their white is not far below: then the distance is small, and the
// whole side gives a better fit. Why: docs/decisions/0007-corner-covariance.md.
ClippedSlices clipped_slices(const GrayView& image, const SideLine& side, double inward) {
  ClippedSlices clipped{};
  std::array<std::uint8_t, 8> white{};  // of a slice
  const std::size_t all = white.size() * kSlices;
  std::vector<std::uint8_t> others;
  others.reserve(all);
  for (std::size_t slice = 0; slice < kSlices; ++slice) {
    for (std::size_t i = 0; i < white.size(); ++i) {
      const auto place = static_cast<double>(white.size() * slice + i) + 0.5;
      const double along = 2 * place / static_cast<double>(all) - 1;
      const PixelPoint at = point_on(side, along) - inward * side.outward;
      const int x = std::clamp(static_cast<int>(std::lround(at.x)), 0, image.width - 1);
      const int y = std::clamp(static_cast<int>(std::lround(at.y)), 0, image.height - 1);
      white[i] = image.row(y)[x];
    }
    clipped[slice] = std::cmp_greater(2 * std::ranges::count(white, 255), white.size());
    if (!clipped[slice]) others.insert(others.end(), white.begin(), white.end());
  }
  if (others.size() == all || 4 * others.size() < all) return {};
  return ToneCurve::of(image).light_of(quantile(others, 0.5)) > 0.5 ? ClippedSlices{} : clipped;
}

// The pixels near the side, `margin` pixels at its ends left out.
std::vector<EdgeSample> samples_near(const GrayView& image, const SideLine& side, double inward,
                                     double outward, double margin, int zones) {
  EdgeBins bins(static_cast<float>(inward), static_cast<float>(outward), outward > side.stroke,
                zones);
  const PixelPoint d = side.end - side.begin;
  const bool steep = std::abs(d.y) > std::abs(d.x);
  const double side_length = length(d);
  const double stretch = side_length / std::max(std::abs(d.x), std::abs(d.y));
  const double low = std::min(steep ? side.begin.y : side.begin.x, steep ? side.end.y : side.end.x);
  const double high =
      std::max(steep ? side.begin.y : side.begin.x, steep ? side.end.y : side.end.x);
  const double cut = margin / stretch;
  const int first = std::max(0, static_cast<int>(std::ceil(low + cut)));
  const int last =
      std::min((steep ? image.height : image.width) - 1, static_cast<int>(std::floor(high - cut)));
  const double band = std::max(inward, outward) * stretch;
  const int stride =
      std::max(1, static_cast<int>((last - first) * (2 * band) / kEdgeFit.most_pixels));
  const int limit = (steep ? image.width : image.height) - 1;
  const std::ptrdiff_t step = steep ? 1 : image.stride;
  // What a step of one pixel along the minor axis changes.
  const double along_unit = 2 / side_length;
  const auto by_across = static_cast<float>(steep ? side.outward.x : side.outward.y);
  const auto by_along = static_cast<float>((steep ? side.along.x : side.along.y) * along_unit);
  const bool is_bowed = !side.bow.is_straight();
  const ClippedSlices clipped = clipped_slices(image, side, 0.6 * inward);
  for (int major = first; major <= last; major += stride) {
    const double t = steep ? (major - side.begin.y) / d.y : (major - side.begin.x) / d.x;
    if (clipped[static_cast<std::size_t>(zone_at(static_cast<float>(2 * t - 1), kSlices))])
      continue;
    double centre = steep ? side.begin.x + t * d.x : side.begin.y + t * d.y;
    // Near the edge the tangent of the bow there is sufficient.
    const double s = std::clamp(2 * t - 1, -1.0, 1.0);
    const double bow = is_bowed ? side.bow.at(s) : 0;
    const double slope = is_bowed ? side.bow.slope(s) : 0;
    if (is_bowed) centre += bow / static_cast<double>(by_across);
    const int from = std::max(0, static_cast<int>(std::ceil(centre - band)));
    const int to = std::min(limit, static_cast<int>(std::floor(centre + band)));
    const PixelPoint point{static_cast<double>(steep ? from : major),
                           static_cast<double>(steep ? major : from)};
    auto across = static_cast<float>(dot(point - side.begin, side.outward));
    const auto along = static_cast<float>(along_unit * dot(point - side.begin, side.along) - 1);
    if (is_bowed) across -= static_cast<float>(bow + slope * (static_cast<double>(along) - s));
    const float step_across = by_across - static_cast<float>(slope) * by_along;
    const std::uint8_t* pixel = image.row(steep ? major : from) + (steep ? from : major);
    bins.add({along, across, by_along, step_across}, pixel, step, to - from + 1);
  }
  return bins.samples();
}

}  // namespace

std::vector<EdgeSample> edge_samples(const GrayView& image, const SideLine& side, double thin,
                                     int zones) {
  const double inward = std::clamp(side.stroke, 2.0, 8.0);
  const double outward = side.stroke < thin ? side.stroke + 1.5 : std::min(0.75 * side.stroke, 8.0);
  return edge_samples_between(image, side, inward, outward, zones);
}

std::vector<EdgeSample> edge_samples_between(const GrayView& image, const SideLine& side,
                                             double inward, double outward, int zones) {
  const double margin = std::max(2.0, 1.2 * side.reach);
  return samples_near(image, side, inward, outward, margin, zones);
}

}  // namespace tagsmith::detail
