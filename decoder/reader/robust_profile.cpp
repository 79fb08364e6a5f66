// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/robust_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "decoder/reader/agreeing_rows.hpp"
#include "decoder/reader/occluders.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/reader/uneven_light.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// ---- The point spread along the symbol.

namespace {

// Distance in the image between bars that are a unit apart, by which a module's width goes.
// Why: docs/decisions/0002-likelihood-decoding.md.
double width_across(const FrameHomography& image_from_frame, double u) {
  constexpr double kStep = 1e-3;
  const PixelPoint by_u = image_from_frame(u + kStep, 0.5) - image_from_frame(u - kStep, 0.5);
  const PixelPoint by_v = image_from_frame(u, 0.5 + kStep) - image_from_frame(u, 0.5 - kStep);
  return std::abs(cross(by_u, by_v)) / std::max(std::hypot(by_v.x, by_v.y), 1e-12);
}

}  // namespace

void set_spreads(const FrameHomography& image_from_frame, const SymbolLayout& layout,
                 ScanProfile& profile) {
  const double middle = width_across(image_from_frame, 0.5);
  for (ScanBin& bin : profile) {
    const double width = width_across(image_from_frame, layout.width_share(bin.at));
    bin.spread = middle / std::max(width, 1e-12);
  }
}

// ---- The profile.

namespace {

// Width of a pixel across the bars, pixels along the symbol, where it is wider than a module; else
// 0: then it is part of the point spread, as in the fit of the frame's sides, whose corners the
// bars may move. A pixel's area, projected across the bars, is a box averaged over another; the
// wider one counts here, the other is part of the point spread.
double pixel_across(const SymbolRows& rows) {
  if (rows.module_px > 1) return 0;
  const PixelPoint along = rows.image_from_frame(1, 0.5) - rows.image_from_frame(0, 0.5);
  const PixelPoint down = rows.image_from_frame(0.5, 1) - rows.image_from_frame(0.5, 0);
  const double height = std::hypot(down.x, down.y);
  const double sine = cross(along, down) / (std::hypot(along.x, along.y) * height);
  return std::max(std::abs(down.x), std::abs(down.y)) / (height * std::abs(sine));
}

// Standard deviation of the point spread across the bars, pixels, without a pixel of this width; at
// least half of what it is with one. `sides`: of a frame turned to P.
double blur_across(const std::array<FrameSide, 4>& sides, double pixel) {
  const double blur = (sides[1].blur_px + sides[3].blur_px) / 2;
  return std::sqrt(std::max(blur * blur - pixel * pixel / 12, blur * blur / 4));
}

void hide_behind(std::span<const Occluder> occluders, SymbolRows& rows) {
  for (std::size_t row = 0; row < rows.rows; ++row) {
    for (const Occluder& occluder : occluders) {
      const auto [begin, end] = hidden_width(occluder, rows.height_of(row));
      for (std::size_t bin = 0; bin < rows.bins; ++bin) {
        const double u = rows.width_share_of(static_cast<double>(bin) + 0.5);
        if (begin <= u && u <= end) rows.cell(row, bin).count = 0;
      }
    }
  }
}

// The fine rows of a symbol without what occluders hide.
SymbolRows rows_in_sight(const GrayView& image, const RefinedFrame& frame,
                         const SymbolLayout& layout) {
  SymbolRows rows(image, frame.corners, frame.lens, layout, RowHeight::fine);
  hide_behind(find_occluders(image, frame, layout), rows);
  return rows;
}

ScanProfile profile_of(const SymbolRows& rows, const std::vector<Agreed>& agreed) {
  ScanProfile profile;
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    const Agreed& at = agreed[bin];
    if (rows.middles[bin] < 0) continue;
    const double place = rows.module_of(static_cast<double>(rows.middles[bin]));
    if (at.shown < kProfile.least_shown) {
      profile.push_back({place, 0.5, kHiddenVariance, 1});
      continue;
    }
    const float few = static_cast<float>(kProfile.shading) * (1 - at.shown) * (1 - at.shown);
    const float doubt = std::min(1.0F, 2 * at.doubt);
    const float variance = 1 / at.weight + kProfile.model_error * kProfile.model_error + few * few +
                           doubt * doubt * doubt * doubt;
    profile.push_back({place, static_cast<double>(at.darkness), static_cast<double>(variance), 1});
  }
  return profile;
}

// First and last height of the rows that are used of a part of the bars' height, shares of the
// frame's: where the frame's blur or its corners' error may reach, the bars' ends are not.
std::array<double, 2> used_heights(HeightShare part, const SymbolLayout& layout) {
  const double bars = layout.bar_height();
  return {layout.bars_top + std::max(part.begin, kProfile.ends) * bars,
          layout.bars_top + std::min(part.end, 1 - kProfile.ends) * bars};
}

// Evens out the rows of a frame, and returns the light of its white.
double evened(const RefinedFrame& frame, SymbolRows& rows) {
  return even_out(rows, blur_across(frame.sides, 0) / std::max(rows.module_px, 1e-3));
}

PlateLevels levels_of(const RefinedFrame& frame) {
  const FrameSide &upper = frame.sides[0], &lower = frame.sides[2];
  return {{upper.white_begin, upper.white_end, lower.white_begin, lower.white_end},
          {upper.black_begin, upper.black_end, lower.black_begin, lower.black_end}};
}

// The same of a plate of this white everywhere, whose ink reflects as much of it as before.
PlateLevels even_levels(const RefinedFrame& frame, double white) {
  PlateLevels levels = levels_of(frame);
  const double black = std::accumulate(levels.black.begin(), levels.black.end(), 0.0);
  const double bright = std::accumulate(levels.white.begin(), levels.white.end(), 0.0);
  levels.white.fill(white);
  levels.black.fill(black / bright * white);
  return levels;
}

bool are_same(const Quad& a, const Quad& b) {
  return std::ranges::equal(a, b,
                            [](PixelPoint p, PixelPoint q) { return p.x == q.x && p.y == q.y; });
}

}  // namespace

double middle_height(HeightShare part, const SymbolLayout& layout) {
  const auto [top, bottom] = used_heights(part, layout);
  return (top + bottom) / 2;
}

RobustProfile::RobustProfile(const GrayView& image, const RefinedFrame& frame,
                             const SymbolLayout& layout, bool even_out_light)
    : image_(image),
      frame_(frame),
      rows_(image, frame.corners, frame.lens, layout, RowHeight::coarse) {
  if (even_out_light) white_ = evened(frame, rows_);
}

bool RobustProfile::is_of(const GrayView& image, const RefinedFrame& frame,
                          const SymbolLayout& layout, bool evened) const {
  return image.row(0) == image_.row(0) && are_same(frame.corners, frame_.corners) &&
         layout == rows_.layout && evened == white_.has_value();
}

SymbolProfile RobustProfile::finished(ScanProfile bins, const SymbolRows& rows) const {
  set_spreads(rows.image_from_frame, rows.layout, bins);
  const double per_px = 1 / std::max(rows.module_px, 1e-3);
  const double pixel = pixel_across(rows);
  const double bin = 1.0 / rows.bins_per_module;
  const double blur = blur_across(frame_.sides, pixel) * per_px;
  return {std::move(bins), rows.module_px, std::sqrt(blur * blur + bin * bin / 12), pixel * per_px,
          white_.has_value()};
}

SymbolProfile RobustProfile::of_agreeing_rows(HeightShare part) const {
  const auto [top, bottom] = used_heights(part, rows_.layout);
  const PlateLevels levels = white_ ? even_levels(frame_, *white_) : levels_of(frame_);
  return finished(profile_of_agreeing(rows_, levels, top, bottom), rows_);
}

SymbolProfile RobustProfile::of_all_rows(AddedLight added) const {
  SymbolRows rows = rows_in_sight(image_, frame_, rows_.layout);
  if (white_) evened(frame_, rows);
  // What a highlight bleaches is plain too: there its rows' own light decides.
  if (added == AddedLight::even) leave_out_plain(rows);
  return finished(profile_of(rows, settle(rows, added).agreed), rows);
}

}  // namespace tagsmith::detail
