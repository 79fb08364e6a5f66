// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/edge_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tagsmith {
namespace {

// Pixels near a side, gathered by how far along and how far across they lie: fine across near the
// edge, where the light changes within a pixel, coarse elsewhere.
class EdgeBins {
 public:
  EdgeBins(double inward, double outward) : inward_(inward), outward_(outward) {
    const double span = std::max(0.0, inward - kFine) + std::max(0.0, outward - kFine);
    coarse_ = std::max(0.5, span / 12);
    rows_ = index_of(outward) + 1;
    bins_.resize(kZones * rows_);
  }

  bool holds(double across) const { return across >= -inward_ && across <= outward_; }

  void add(double along, double across, double value) {
    const auto zone = static_cast<std::size_t>(
        std::clamp((along + 1) / 2 * kZones, 0.0, static_cast<double>(kZones) - 1));
    EdgeSample& bin = bins_[zone * rows_ + index_of(across)];
    bin.along += along;
    bin.across += across;
    bin.value += value;
    bin.weight += 1;
  }

  std::vector<EdgeSample> samples() const {
    std::vector<EdgeSample> samples;
    samples.reserve(bins_.size());
    for (const EdgeSample& bin : bins_) {
      if (bin.weight == 0) continue;
      samples.push_back(
          {bin.along / bin.weight, bin.across / bin.weight, bin.value / bin.weight, bin.weight});
    }
    return samples;
  }

 private:
  static constexpr std::size_t kZones = 6;
  static constexpr double kFine = 1.6;  // pixels on both sides of the edge
  static constexpr double kStep = 0.2;  // pixels

  std::size_t index_of(double across) const {
    const double fine_begin = std::max(0.0, inward_ - kFine) / coarse_;
    double position = 0;
    if (across < -kFine) {
      position = (across + inward_) / coarse_;
    } else if (across <= kFine) {
      position = std::ceil(fine_begin) + (across + kFine) / kStep;
    } else {
      position = std::ceil(fine_begin) + 2 * kFine / kStep + 1 + (across - kFine) / coarse_;
    }
    return static_cast<std::size_t>(std::max(0.0, position));
  }

  double inward_;
  double outward_;
  double coarse_ = 1;
  std::size_t rows_ = 0;
  std::vector<EdgeSample> bins_;
};

// The pixels near the side, `margin` pixels at its ends left out.
std::vector<EdgeSample> samples_near(const GrayView& image, const SideLine& side, double inward,
                                     double outward, double margin) {
  constexpr double kMaxCount = 1500;  // pixels; more add nothing that the model could use
  EdgeBins bins(inward, outward);
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
  const int stride = std::max(1, static_cast<int>((last - first) * (2 * band) / kMaxCount));
  for (int major = first; major <= last; major += stride) {
    const double t = steep ? (major - side.begin.y) / d.y : (major - side.begin.x) / d.x;
    const double centre = steep ? side.begin.x + t * d.x : side.begin.y + t * d.y;
    const int limit = (steep ? image.width : image.height) - 1;
    const int from = std::max(0, static_cast<int>(std::ceil(centre - band)));
    const int to = std::min(limit, static_cast<int>(std::floor(centre + band)));
    for (int minor = from; minor <= to; ++minor) {
      const PixelPoint point{static_cast<double>(steep ? minor : major),
                             static_cast<double>(steep ? major : minor)};
      const double across = dot(point - side.begin, side.outward);
      if (!bins.holds(across)) continue;
      const double along = 2 * dot(point - side.begin, side.along) / side_length - 1;
      bins.add(along, across, steep ? image.at(minor, major) : image.at(major, minor));
    }
  }
  return bins.samples();
}

}  // namespace

std::vector<EdgeSample> edge_samples(const GrayView& image, const SideLine& side) {
  const double inward = std::clamp(side.stroke, 2.0, 8.0);
  const double outward = side.stroke < 4 ? side.stroke + 1.5 : std::min(0.75 * side.stroke, 8.0);
  const double margin = std::max(2.0, 1.2 * side.reach);
  return samples_near(image, side, inward, outward, margin);
}

}  // namespace tagsmith
