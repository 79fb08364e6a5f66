// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/explain.hpp"
#include "tagsmith/placement/reader_limits.hpp"

namespace tagsmith {
namespace {

// Beyond these nothing in docs/accuracy.md is read, or the reader itself refuses (kept, growth).
constexpr double kSteepest = 72;      // degrees of incidence
constexpr double kDarkestWhite = 40;  // samples, 0 to 255
constexpr double kBrightestBars = 170;
constexpr double kLeastContrast = 20;
constexpr double kLeastKept = 0.7;
constexpr double kMostGrowth = 0.7;  // modules
constexpr double kMostBlur = 0.9;    // modules

struct Levels {
  double dark = 0;
  double bright = 0;
};

// Of the samples inside the frame, the 5th and the 95th percentile.
Levels levels_in(const GrayView& image, const FrameCorners& corners) {
  constexpr int kSteps = 48;
  const Homography image_from_unit = homography_to(corners);
  std::vector<int> samples;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const PixelPoint at = image_from_unit((i + 0.5) / kSteps, (j + 0.5) / kSteps);
      const bool inside =
          at.x >= 0 && at.y >= 0 && at.x <= image.width - 1 && at.y <= image.height - 1;
      if (!inside) continue;
      samples.push_back(
          image.at(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y))));
    }
  }
  if (samples.empty()) return {0, 255};
  std::ranges::sort(samples);
  const auto share = [&](std::size_t percent) {
    return static_cast<double>(samples[(samples.size() - 1) * percent / 100]);
  };
  return {share(5), share(95)};
}

struct Shape {
  double module_px = 0;
  double incidence = 0;  // degrees, from the shorter axis's foreshortening alone
};

// The quadrilateral's longer axis is taken for the frame's length unless it is foreshortened more
// than its height can be.
Shape shape_of(const TagTemplate& tag, const FrameCorners& c) {
  const double along = (distance(c[0], c[1]) + distance(c[3], c[2])) / 2;
  const double across = (distance(c[0], c[3]) + distance(c[1], c[2])) / 2;
  const double ratio = tag.frame_inner_length / tag.frame_inner_height;
  const double seen = std::max(along, across) / std::max(1e-9, std::min(along, across));
  // Wider than drawn: the height is foreshortened; narrower: the length is.
  const double shortened = std::min(1.0, seen > ratio ? ratio / seen : seen / ratio);
  return {std::max(along, across) * module_width(tag) / tag.frame_inner_length,
          std::acos(shortened) * 180 / std::numbers::pi};
}

std::optional<Diagnosis> judge_light(const GrayView& image, const FrameCorners& corners) {
  const Levels levels = levels_in(image, corners);
  if (levels.bright < kDarkestWhite) {
    return Diagnosis{"too-dark", fmt::format("white is {:.0f} of 255, {:.0f} is needed",
                                             levels.bright, kDarkestWhite)};
  }
  if (levels.dark > kBrightestBars) {
    return Diagnosis{"glare", fmt::format("the darkest bars are {:.0f} of 255, limit {:.0f}",
                                          levels.dark, kBrightestBars)};
  }
  if (levels.bright - levels.dark < kLeastContrast) {
    return Diagnosis{"low-contrast",
                     fmt::format("bars and ground differ by {:.0f} of 255, {:.0f} is needed",
                                 levels.bright - levels.dark, kLeastContrast)};
  }
  return std::nullopt;
}

std::optional<Diagnosis> judge_view(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners) {
  const Shape shape = shape_of(tag, corners);
  if (shape.incidence > kSteepest) {
    return Diagnosis{"end-on", fmt::format("seen at {:.0f} degrees from its front, limit {:.0f}",
                                           shape.incidence, kSteepest)};
  }
  const double least =
      least_module_px(true, shape.incidence * std::numbers::pi / 180, 0, ReadShare::half);
  if (shape.module_px < least) {
    return Diagnosis{"too-small", fmt::format("{:.2f} pixels a module, {:.2f} are needed",
                                              shape.module_px, least)};
  }
  return judge_light(image, corners);
}

std::optional<Diagnosis> judge_bars(const ExplainedSymbol& symbol) {
  const SymbolFit& fit = symbol.decoding.fit;
  if (fit.kept < kLeastKept) {
    return Diagnosis{"covered", fmt::format("{:.0f} % of the bars are in view, {:.0f} % are needed",
                                            100 * fit.kept, 100 * kLeastKept)};
  }
  if (std::abs(fit.image.growth) > kMostGrowth) {
    return Diagnosis{"bars-grown", fmt::format("bars {} by {:.2f} modules, limit {:.1f}",
                                               fit.image.growth > 0 ? "wider" : "narrower",
                                               std::abs(fit.image.growth), kMostGrowth)};
  }
  if (fit.image.blur > kMostBlur) {
    return Diagnosis{
        "blurred", fmt::format("blur of {:.2f} modules, limit {:.1f}", fit.image.blur, kMostBlur)};
  }
  return std::nullopt;
}

}  // namespace

Diagnosis diagnose(const GrayView& image, const TagTemplate& tag, const Rejection& rejection,
                   const ReadOptions& options) {
  if (const auto view = judge_view(image, tag, rejection.corners)) return *view;
  ReadResult refused;
  refused.rejected.push_back(rejection);
  for (const ExplainedSymbol& symbol : explain(image, options, refused).symbols) {
    if (const auto bars = judge_bars(symbol)) return *bars;
  }
  return {"undecodable", ""};
}

std::optional<Diagnosis> diagnose_picture(const GrayView& image) {
  const double right = image.width - 1;
  const double bottom = image.height - 1;
  return judge_light(image, {{{0, 0}, {right, 0}, {right, bottom}, {0, bottom}}});
}

void diagnose_tags(const GrayView& image, const TagTemplate& tag, const ReadOptions& options,
                   std::vector<TagFinding>& findings) {
  for (TagFinding& finding : findings) {
    if (finding.status != TagStatus::unreadable) continue;
    const Diagnosis diagnosis = diagnose(image, tag, {finding.message, finding.corners}, options);
    finding.rule = diagnosis.rule;
    if (!diagnosis.measured.empty()) finding.message += ": " + diagnosis.measured;
  }
}

}  // namespace tagsmith
