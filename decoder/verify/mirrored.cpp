// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/mirrored.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {
namespace {

struct Strip {
  double white = 0;  // brightest tenth, samples
  double ink = 0;    // share of samples darker than half of it
};

// The strip in the plate's frame; nothing when a part of it is outside the picture.
std::optional<Strip> look_at(const GrayView& image, const TagTemplate& tag,
                             const FrameCorners& corners, const Rectangle& area) {
  constexpr int kAlong = 160;
  constexpr int kAcross = 12;
  const Homography image_from_frame = homography_to(corners);
  std::vector<double> samples;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const PixelPoint at =
          image_from_frame((area.x + area.width * (i + 0.5) / kAlong) / tag.frame_inner_length,
                           (area.y + area.height * (j + 0.5) / kAcross) / tag.frame_inner_height);
      const auto level = sample_nearest(image, at);
      if (!level) return std::nullopt;
      samples.push_back(*level);
    }
  }
  std::ranges::sort(samples);
  const double white = samples[samples.size() * 9 / 10];
  const auto dark = std::ranges::lower_bound(samples, white / 2);
  return Strip{white,
               static_cast<double>(dark - samples.begin()) / static_cast<double>(samples.size())};
}

// Where the label's text stands; nothing when none is below the frame.
std::optional<Rectangle> label_below(const TagTemplate& tag) {
  if (!tag.label.shown) return std::nullopt;
  const Rectangle strip = strip_below_frame(tag);
  if (strip.height < kLeastLabelHeight) return std::nullopt;
  // The patches at its right end would be ink as well.
  const double width = strip.width - (tag.patch_size > 0 ? 2.5 * tag.patch_size : 0);
  return Rectangle{strip.x, strip.y, width, strip.height};
}

bool is_mirrored(const GrayView& image, const TagTemplate& tag, const FrameCorners& corners,
                 const Rectangle& below) {
  Rectangle above = below;
  above.y = tag.frame_inner_height - below.y - below.height;
  const std::optional<Strip> right = look_at(image, tag, corners, below);
  const std::optional<Strip> wrong = look_at(image, tag, corners, above);
  constexpr double kBlank = 0.003;
  constexpr double kLeastInk = 0.02;
  constexpr double kMostInk = 0.4;  // rock and other plates are darker on the whole
  constexpr double kSameWhite = 0.7;
  return right && wrong && right->ink < kBlank && wrong->ink > kLeastInk && wrong->ink < kMostInk &&
         right->white > kSameWhite * wrong->white && wrong->white > kSameWhite * right->white;
}

// White of the plate above and below the outer edge of the feature frame, metres, in the plate's
// frame as read.
struct Margins {
  double above = 0;
  double below = 0;
};

Margins margins_of(const TagTemplate& tag) {
  const double both = tag.plate_height - tag.frame_inner_height - 2 * tag.frame_stroke;
  return {both / 2 - tag.frame_offset_up, both / 2 + tag.frame_offset_up};
}

// How far the plate's white goes on from the frame's outer edge, upwards or downwards: in most
// places along the frame, since letters end it early. Nothing when it goes on beyond `farthest` or
// out of the picture: paper on paper, a white wall.
std::optional<double> white_beyond(const GrayView& image, const TagTemplate& tag,
                                   const Homography& image_from_frame, bool upwards,
                                   double farthest) {
  constexpr int kPlaces = 24;
  constexpr double kStep = 0.001;  // metres
  std::vector<double> widths;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = 0.1 + 0.8 * (i + 0.5) / kPlaces;
    const auto sample = [&](double out) -> std::optional<double> {
      const double down = upwards ? -out : tag.frame_inner_height + out;
      return sample_nearest(image, image_from_frame(along, down / tag.frame_inner_height));
    };
    const auto white = sample(-module_width(tag) * tag.margin_modules / 2);
    if (!white) return std::nullopt;
    const double first = module_width(tag);  // nearer is the stroke's blur
    const int last = static_cast<int>(std::floor((farthest - first) / kStep));
    int step = 0;
    for (; step <= last; ++step) {
      const auto level = sample(tag.frame_stroke + first + step * kStep);
      if (!level) return std::nullopt;
      if (*level < *white / 2) break;
    }
    widths.push_back(first + step * kStep);
  }
  std::ranges::sort(widths);
  const double width = widths[widths.size() * 4 / 5];
  if (width > farthest) return std::nullopt;
  return width;
}

// Where the frame stands out of the plate's middle, a mirrored print has its wider margin above the
// bars as they are read, not below, or the other way round.
bool is_mirrored_by_margins(const GrayView& image, const TagTemplate& tag,
                            const FrameCorners& corners) {
  constexpr double kLeastDifference = 0.010;  // metres
  constexpr double kFits = 0.3;               // of the difference
  const Margins drawn = margins_of(tag);
  const double difference = std::abs(drawn.above - drawn.below);
  if (difference < kLeastDifference) return false;
  const Homography image_from_frame = homography_to(corners);
  const double farthest = std::max(drawn.above, drawn.below) + difference;
  const auto above = white_beyond(image, tag, image_from_frame, true, farthest);
  const auto below = white_beyond(image, tag, image_from_frame, false, farthest);
  return above && below && std::abs(*above - drawn.below) < kFits * difference &&
         std::abs(*below - drawn.above) < kFits * difference;
}

}  // namespace

// Why: docs/decisions/0018-verification-lines.md.
std::string find_mirroring(const GrayView& image, const TagTemplate& tag,
                           const FrameCorners& corners, double module_px) {
  constexpr double kLeastModule = 4;  // pixels; letters are four modules high and more
  constexpr double kLeastModuleForMargins = 2;
  const std::optional<Rectangle> below = label_below(tag);
  if (below && module_px >= kLeastModule && is_mirrored(image, tag, corners, *below)) {
    return "its label stands above the bars, expected below";
  }
  if (module_px >= kLeastModuleForMargins && is_mirrored_by_margins(image, tag, corners)) {
    return "the plate's wider margin is on the wrong side of the bars";
  }
  return {};
}

}  // namespace tagsmith::detail
