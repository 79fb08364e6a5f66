// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/edge_samples.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

// Pixels near a side, grouped by how far along and how far across they lie: fine across near the
// edge, where the light changes within a pixel, coarse elsewhere. Not coarse where the stroke's
// other edge is included: a mean over two pixels has no definite place, and a different one where
// perspective tapers the stroke.
class EdgeBins {
 public:
  EdgeBins(float inward, float outward, bool both_edges, int zones)
      : zones_(zones), inward_(inward), outward_(outward) {
    const float span =
        std::max(0.0F, inward - kEdgeFit.fine) + std::max(0.0F, outward - kEdgeFit.fine);
    per_coarse_ = both_edges ? 2 : 1 / std::max(0.5F, span / 8);
    fine_begin_ = std::ceil(std::max(0.0F, inward_ - kEdgeFit.fine) * per_coarse_);
    rows_ = index_of(outward) + 1;
    bins_.resize(static_cast<std::size_t>(zones_) * rows_);
  }

  bool holds(float across) const { return across >= -inward_ && across <= outward_; }

  void add(float along, float across, float value) {
    const int zone = zone_at(along, zones_);
    EdgeSample& bin = bins_[static_cast<std::size_t>(zone) * rows_ + index_of(across)];
    bin.along += along;
    bin.across += across;
    bin.value += value;
    bin.weight += 1;
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
  std::size_t index_of(float across) const {
    float position = 0;
    if (across < -kEdgeFit.fine) {
      position = (across + inward_) * per_coarse_;
    } else if (across <= kEdgeFit.fine) {
      position = fine_begin_ + (across + kEdgeFit.fine) * kEdgeFit.per_pixel;
    } else {
      position = fine_begin_ + 2 * kEdgeFit.fine * kEdgeFit.per_pixel + 1 +
                 (across - kEdgeFit.fine) * per_coarse_;
    }
    return static_cast<std::size_t>(static_cast<int>(std::max(0.0F, position)));
  }

  int zones_;
  float inward_;
  float outward_;
  float per_coarse_ = 1;
  float fine_begin_ = 0;
  std::size_t rows_ = 0;
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
    auto along = static_cast<float>(along_unit * dot(point - side.begin, side.along) - 1);
    if (is_bowed) across -= static_cast<float>(bow + slope * (static_cast<double>(along) - s));
    const float step_across = by_across - static_cast<float>(slope) * by_along;
    const std::uint8_t* pixel = image.row(steep ? major : from) + (steep ? from : major);
    for (int minor = from; minor <= to; ++minor) {
      if (bins.holds(across)) bins.add(along, across, static_cast<float>(*pixel));
      across += step_across;
      along += by_along;
      pixel += step;
    }
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
