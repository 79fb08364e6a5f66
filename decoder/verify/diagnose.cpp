// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/diagnose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/placement/reader_limits.hpp"

namespace tagsmith::detail {
namespace {

// A plate that is too narrow to be read is reported as seen from the side beyond this incidence,
// radians.
constexpr double kSteep = radians(70);
// Beyond these nothing in docs/accuracy.md is read.
constexpr double kDarkestWhite = 40;  // samples, 0 to 255
constexpr double kBrightestBars = 170;
constexpr double kLeastPlateContrast = 20;
constexpr double kMostBlur = 0.9;   // modules
constexpr double kSharpBlur = 1.2;  // pixels: the blur of lens and pixels in a photo in focus
constexpr double kMostHidden = 0.05;
constexpr double kEndOfScale = 255;  // of every camera's samples: brighter light is clipped
// Modules by which printers and cameras usually widen or narrow bars: what the reader expects.
constexpr double kUsualGrowth = kImaging.edge;

struct Levels {
  double dark = 0;
  double bright = 0;
};

// Of the samples inside the frame, the 5th and the 95th percentile.
Levels levels_in(const GrayView& image, const FrameCorners& corners) {
  constexpr int kSteps = 48;
  const Homography image_from_frame = homography_to(corners);
  std::vector<int> samples;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const auto level =
          sample_nearest(image, image_from_frame((i + 0.5) / kSteps, (j + 0.5) / kSteps));
      if (level) samples.push_back(*level);
    }
  }
  if (samples.empty()) return {0, 255};
  return {static_cast<double>(quantile(samples, 0.05)),
          static_cast<double>(quantile(samples, 0.95))};
}

double shortening(const TagTemplate& tag, double length, double height) {
  const double ratio = tag.frame_inner_length / tag.frame_inner_height;
  const double seen = std::max(1e-9, length) / std::max(1e-9, height);
  return std::min(seen / ratio, ratio / seen);
}

// The corners from the upper left one of a plate that hangs upright, in a picture that is to be
// shown so: the corners of a plate that was not read begin anywhere.
FrameCorners from_upper_left(const GrayView& image, const TagTemplate& tag, FrameCorners corners,
                             int orientation) {
  const double along = length_of(corners);
  const double across = height_of(corners);
  const std::vector<std::size_t> first = possible_first_corners(image, corners);
  const bool crossed = first.size() == 1
                           ? first.front() == 0
                           : shortening(tag, along, across) >= shortening(tag, across, along);
  if (!crossed) std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  const Upright upright{orientation, image.width, image.height};
  const PixelPoint upper = upright.turn(0.5 * (corners[0] + corners[1]));
  const PixelPoint lower = upright.turn(0.5 * (corners[2] + corners[3]));
  if (lower.y < upper.y) std::rotate(corners.begin(), corners.begin() + 2, corners.end());
  return corners;
}

// A plate with the measurements that may show why it cannot be read.
struct PlateLook {
  const GrayView& image;
  const TagTemplate& tag;
  FrameCorners corners;            // from the upper left one
  double module_px = 0;            // as seen along the symbol
  double incidence = 0;            // radians, from the foreshortening of one axis against the other
  bool knows_up = true;            // of the picture
  bool is_photo = true;            // not a page or a scan
  const SymbolFit* fit = nullptr;  // of the symbol that was refused; null = none was seen
};

PlateLook look_at(const GrayView& image, const TagTemplate& tag, const FrameCorners& corners,
                  const std::optional<int>& orientation) {
  PlateLook look{image, tag, from_upper_left(image, tag, corners, orientation.value_or(1))};
  const double along = length_of(look.corners);
  look.module_px = along * module_width(tag) / tag.frame_inner_length;
  look.incidence = std::acos(std::min(1.0, shortening(tag, along, height_of(look.corners))));
  look.knows_up = orientation.has_value();
  return look;
}

// The object whose light is measured, in words.
struct Lit {
  const char* bright;
  const char* dark;
  const char* both;
};
constexpr Lit kPlate{"its white is", "its darkest bars are", "contrast of bars and ground too low"};
constexpr Lit kPicture{"the brightest parts of the picture are", "its darkest parts are",
                       "contrast too low"};

std::optional<Diagnosis> judge_light(const GrayView& image, const FrameCorners& corners,
                                     const Lit& lit) {
  Levels levels = levels_in(image, corners);
  if (image.is_negative) levels = {255 - levels.bright, 255 - levels.dark};  // as the camera saw it
  if (levels.bright < kDarkestWhite) {
    return Diagnosis{"too-dark", fmt::format("{} {:.0f} of 255, {:.0f} needed", lit.bright,
                                             levels.bright, kDarkestWhite)};
  }
  if (levels.dark > kBrightestBars) {
    return Diagnosis{"glare", fmt::format("{} {:.0f} of 255, limit {:.0f}", lit.dark, levels.dark,
                                          kBrightestBars)};
  }
  if (levels.bright - levels.dark < kLeastPlateContrast) {
    return Diagnosis{"low-contrast", fmt::format("{}: {:.0f} grey levels, {:.0f} needed", lit.both,
                                                 levels.bright - levels.dark, kLeastPlateContrast)};
  }
  return std::nullopt;
}

std::optional<Diagnosis> judge_view(const PlateLook& look) {
  const double least = least_module_px(true, look.incidence, 0, ReadShare::half);
  if (!(look.module_px < least)) return std::nullopt;
  if (look.incidence <= kSteep) {
    return Diagnosis{"too-small", fmt::format("{:.2f} pixels a module, {:.2f} are needed",
                                              look.module_px, least)};
  }
  const std::string needed = std::isfinite(least) ? fmt::format("{:.2f} are needed", least)
                                                  : std::string("nothing is read so obliquely");
  return Diagnosis{"end-on", fmt::format("seen at {:.0f} degrees from its front, {:.2f} pixels a "
                                         "module are left, {}",
                                         degrees(look.incidence), look.module_px, needed)};
}

std::optional<Diagnosis> judge_plate_light(const PlateLook& look) {
  return judge_light(look.image, look.corners, kPlate);
}

std::optional<double> median_of(std::vector<int> samples) {
  if (samples.empty()) return std::nullopt;
  return quantile(samples, 0.5);
}

// The level amid the frame's upper and lower strokes; nothing when they are outside the picture.
std::optional<double> stroke_level(const GrayView& image, const TagTemplate& tag,
                                   const FrameCorners& corners) {
  const Homography image_from_frame = homography_to(corners);
  const double half_stroke = tag.frame_stroke / 2 / tag.frame_inner_height;
  std::vector<int> samples;
  for (int i = 1; i < 20; ++i) {
    for (const double down : {-half_stroke, 1 + half_stroke}) {
      const auto level = sample_nearest(image, image_from_frame(i / 20.0, down));
      if (level) samples.push_back(*level);
    }
  }
  return median_of(std::move(samples));
}

// The level amid the quiet zones, where the blur of frame and bars hardly reaches.
std::optional<double> ground_level(const GrayView& image, const TagTemplate& tag,
                                   const FrameCorners& corners) {
  constexpr int kSteps = 12;
  const Homography image_from_frame = homography_to(corners);
  const double quiet = tag.quiet_zone_modules * module_width(tag) / tag.frame_inner_length;
  std::vector<int> samples;
  for (int row = 0; row < kSteps; ++row) {
    const double down = 0.1 + 0.8 * row / (kSteps - 1);
    for (int column = 0; column < kSteps; ++column) {
      const double in_zone = quiet * (1 + (column + 0.5) / kSteps) / 3;
      for (const double right : {in_zone, 1 - in_zone}) {
        const auto level = sample_nearest(image, image_from_frame(right, down));
        if (level) samples.push_back(*level);
      }
    }
  }
  return median_of(std::move(samples));
}

// The white inside the frame compared with its strokes.
double frame_contrast(const GrayView& image, const TagTemplate& tag, const FrameCorners& corners) {
  const std::optional<double> black = stroke_level(image, tag, corners);
  return black ? levels_in(image, corners).bright - *black : 0;
}

// Width of the frame's inner edge, from a quarter to three quarters of the way from black to white,
// modules; the wider of its upper and its left edge.
double edge_width(const GrayView& image, const TagTemplate& tag, const FrameCorners& corners) {
  constexpr int kSteps = 48;
  constexpr int kLines = 15;
  const Homography image_from_frame = homography_to(corners);
  const double module = module_width(tag);
  double widest = 0;
  for (const bool upper : {true, false}) {
    const double clear = module * (upper ? tag.margin_modules : tag.quiet_zone_modules);
    const double reach = tag.frame_stroke / 2 + clear / 2;
    std::array<double, kSteps> profile{};
    for (int i = 0; i < kSteps; ++i) {
      const double out = (i + 0.5) / kSteps * reach - tag.frame_stroke / 2;
      for (int line = 0; line < kLines; ++line) {
        const double along = 0.3 + 0.4 * line / (kLines - 1);
        const PixelPoint at = upper ? image_from_frame(along, out / tag.frame_inner_height)
                                    : image_from_frame(out / tag.frame_inner_length, along);
        profile[static_cast<std::size_t>(i)] += sample_bilinear(image, at) / kLines;
      }
    }
    const auto ends = std::ranges::minmax(profile);
    const double quarter = 0.25 * (ends.max - ends.min);
    const auto between = std::ranges::count_if(profile, [&](double level) {
      return level > ends.min + quarter && level < ends.max - quarter;
    });
    widest = std::max(widest, static_cast<double>(between) / kSteps * reach / module);
  }
  return widest;
}

// The place of what is hidden, as seen by a viewer who faces the plate; shares of the bars' area.
std::string place_in_words(double right, double down, bool knows_up) {
  const char* row = down < 1.0 / 3 ? "upper" : down > 2.0 / 3 ? "lower" : "middle";
  const char* column = right < 1.0 / 3 ? "left" : right > 2.0 / 3 ? "right" : "middle";
  if (std::string(row) == column) return "in the middle";
  return fmt::format("at the {} {}{}", row, column,
                     knows_up ? "" : " as the picture stands (which way is up in it is not known)");
}

// Parts of the bars' area in which no bars and spaces are seen, though they are seen elsewhere. A
// cell is wider than any element.
std::optional<Diagnosis> judge_cover(const PlateLook& look) {
  const GrayView& image = look.image;
  const TagTemplate& tag = look.tag;
  const FrameCorners& corners = look.corners;
  constexpr int kColumns = 19;
  constexpr int kRows = 4;
  constexpr int kAlong = 30;  // samples of a cell
  constexpr int kAcross = 5;
  constexpr double kLeastModule = 1.5;  // pixels; below, blur hides bars
  constexpr double kFaint = 0.35;       // of the contrast that most cells have
  constexpr double kSharp = 0.6;        // of the frame's contrast, that most cells have
  constexpr double kWidestEdge = 1.0;   // modules: with more blur, cells cannot be compared
  if (look.module_px < kLeastModule || edge_width(image, tag, corners) > kWidestEdge) {
    return std::nullopt;
  }
  const Homography image_from_frame = homography_to(corners);
  const double left = tag.quiet_zone_modules * module_width(tag) / tag.frame_inner_length;
  const double top = tag.margin_modules * module_width(tag) / tag.frame_inner_height;
  std::vector<double> contrasts;
  for (int cell = 0; cell < kColumns * kRows; ++cell) {
    std::vector<int> samples;
    const int row = cell / kColumns;
    for (int i = 0; i < kAlong * kAcross; ++i) {
      const int line = i / kAlong;
      const double right = (cell % kColumns + (i % kAlong + 0.5) / kAlong) / kColumns;
      const double down = (row + (line + 0.5) / kAcross) / kRows;
      const auto level = sample_nearest(
          image, image_from_frame(left + right * (1 - 2 * left), top + down * (1 - 2 * top)));
      if (!level) return std::nullopt;
      samples.push_back(*level);
    }
    std::ranges::sort(samples);
    contrasts.push_back(samples[samples.size() * 9 / 10] - samples[samples.size() / 10]);
  }
  std::vector<double> ordered = contrasts;
  std::ranges::sort(ordered);
  const double usual = ordered[ordered.size() * 3 / 4];
  // Where bars are blurred everywhere, faint ones are not covered.
  if (usual < std::max(kLeastPlateContrast, kSharp * frame_contrast(image, tag, corners))) {
    return std::nullopt;
  }
  double hidden = 0;
  double right = 0;
  double down = 0;
  for (int cell = 0; cell < kColumns * kRows; ++cell) {
    if (contrasts[static_cast<std::size_t>(cell)] >= kFaint * usual) continue;
    ++hidden;
    right += (cell % kColumns + 0.5) / kColumns;
    const int row = cell / kColumns;
    down += (row + 0.5) / kRows;
  }
  const double share = hidden / (kColumns * kRows);
  if (share <= kMostHidden) return std::nullopt;
  return Diagnosis{
      "covered",
      fmt::format("{:.2g} % of the bars are covered or damaged (limit {:.0f} %), {}", 100 * share,
                  100 * kMostHidden, place_in_words(right / hidden, down / hidden, look.knows_up))};
}

// `blur`: standard deviation, modules.
std::optional<Diagnosis> judge_blur(double blur, double module_px) {
  if (blur <= kMostBlur) return std::nullopt;
  if (blur * module_px < kSharpBlur) {
    return Diagnosis{"too-small",
                     fmt::format("{:.2f} pixels a module, {:.2f} are needed at this sharpness",
                                 module_px, blur * module_px / kMostBlur)};
  }
  return Diagnosis{"blurred", fmt::format("blur of {:.2f} modules, limit {:.1f}", blur, kMostBlur)};
}

// Whether half of the plate's white or more is at the end of the scale. In a negative the white is
// that of the frame, and its end is 0. On pages and in scans white paper is there as well.
bool is_white_lost(const PlateLook& look) {
  if (!look.is_photo) return false;
  if (look.image.is_negative) return stroke_level(look.image, look.tag, look.corners) == 0;
  return ground_level(look.image, look.tag, look.corners) == kEndOfScale;
}

// White beyond the end of the scale narrows all bars from both sides, as far as the blur reaches.
// Dirt and damage affect only some of them, and ink makes bars wider. A fit to something that is no
// symbol determines nothing about its bars.
std::optional<Diagnosis> judge_exposure(const PlateLook& look) {
  if (look.fit == nullptr || look.fit->explained < kJudge.like_symbol) return std::nullopt;
  const double growth = look.fit->image.growth;
  const double eaten = look.image.is_negative ? growth : -growth;
  if (eaten <= kUsualGrowth || !is_white_lost(look)) return std::nullopt;
  return Diagnosis{
      "glare", fmt::format("overexposed: its white is {:.0f} of 255, the end of the scale, and "
                           "leaves bars {} by {:.2f} modules, limit {:.2f}",
                           kEndOfScale, growth > 0 ? "wider" : "narrower", eaten, kUsualGrowth)};
}

// For a symbol that one growth explains. Rendered symbols grown by 0.65 to 0.9 modules either way
// are explained to 0.995 and more, covered ones that a fit reports as grown to 0.95 and less.
std::optional<Diagnosis> judge_growth(const PlateLook& look) {
  constexpr double kLeastExplained = 0.97;
  const SymbolFit* fit = look.fit;
  if (fit == nullptr || fit->explained < kLeastExplained ||
      std::abs(fit->image.growth) <= kJudge.most_growth) {
    return std::nullopt;
  }
  if (auto exposure = judge_exposure(look)) return exposure;
  return Diagnosis{"bars-grown", fmt::format("bars {} by {:.2f} modules, limit {:.1f}",
                                             fit->image.growth > 0 ? "wider" : "narrower",
                                             std::abs(fit->image.growth), kJudge.most_growth)};
}

std::optional<Diagnosis> judge_frame_blur(const PlateLook& look) {
  constexpr double kOfQuarters = 1.35;  // standard deviations between an edge's quarters
  return judge_blur(edge_width(look.image, look.tag, look.corners) / kOfQuarters, look.module_px);
}

std::optional<Diagnosis> judge_bars(const PlateLook& look) {
  if (look.fit == nullptr) return std::nullopt;
  return judge_blur(look.fit->image.blur, look.module_px);
}

// In order of precedence. Geometry comes before light, and light before the bars, because each
// makes the later measurements worthless. Bars that grew until they touch, or shrank to hairs, have
// cells without contrast as if they were covered. A frame that is blurred so much is better
// evidence than a fit to what is left of the bars, and so is clipped white.
constexpr std::optional<Diagnosis> (*kJudges[])(const PlateLook&) = {
    judge_view,       judge_plate_light, judge_growth, judge_cover,
    judge_frame_blur, judge_exposure,    judge_bars,
};

// The most frequent reason for a refusal without a measured cause.
std::string suspicion(RejectionReason reason) {
  switch (reason) {
    case RejectionReason::element_widths:
      return ": some bars are of no width that digits have. Dirt, a scratch or a cable across "
             "them, too narrow to be measured, or something that is no tag";
    case RejectionReason::guard_pattern:
      return ": the bars at its ends or in its middle are not there. They are covered, or it is no "
             "tag";
    case RejectionReason::doubtful:
      return ": one of its digits is in doubt. A bar is dirty, damaged or half hidden";
    case RejectionReason::covered:
      return ": something hangs before it or sticks on it";
    default:
      return {};
  }
}

}  // namespace

Diagnosis diagnose(const GrayView& image, const TagTemplate& tag, const Rejection& rejection,
                   const std::optional<int>& orientation, bool is_photo) {
  PlateLook look = look_at(image, tag, rejection.corners, orientation);
  look.is_photo = is_photo;
  if (rejection.symbol) look.fit = &rejection.symbol->decoding.fit;
  const std::string reason = describe(rejection);
  for (const auto& judge : kJudges) {
    auto diagnosis = judge(look);
    if (!diagnosis) continue;
    diagnosis->words += fmt::format(" (the reader says: {})", reason);
    return *diagnosis;
  }
  return {"undecodable", describe_measured(rejection) + suspicion(rejection.reason)};
}

std::optional<Diagnosis> find_cover(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners,
                                    const std::optional<int>& orientation) {
  return judge_cover(look_at(image, tag, corners, orientation));
}

std::optional<Diagnosis> diagnose_light(const GrayView& image, const FrameCorners& corners) {
  return judge_light(image, corners, kPlate);
}

std::optional<Diagnosis> diagnose_picture(const GrayView& image) {
  const double right = image.width - 1;
  const double bottom = image.height - 1;
  return judge_light(image, {{{0, 0}, {right, 0}, {right, bottom}, {0, bottom}}}, kPicture);
}

}  // namespace tagsmith::detail
