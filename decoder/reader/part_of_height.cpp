// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/part_of_height.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Core>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/sharpening.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/cut_frame.hpp"
#include "decoder/reader/judge.hpp"
#include "decoder/reader/placed_corners.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

// The frame from its side in sight on, which becomes side 0, with side 2, out of sight, where its
// proportions have it. Side 1 of a cut outline is out of sight.
std::optional<Quad> completed(const Quad& cut, const FrameShape& shape, const Camera& camera) {
  FrameShape upright = shape;
  std::swap(upright.length, upright.height);
  const auto whole = completed_by_shape(cut, upright, camera);
  return whole ? std::optional(beginning_at(*whole, 3)) : std::nullopt;
}

struct CutView {
  const GrayView& image;
  const Camera& camera;
  const ReadOptions& options;
};

std::optional<RefinedFrame> fit_cut_height(const CutView& view, const Quad& rough,
                                           const FrameShape& shape, bool was_sharpened) {
  const auto fitted = refine_shown_sides(view.image, rough, {true, true, false, true}, 0,
                                         LensDistortion(view.camera), shape, was_sharpened);
  if (!fitted || std::ranges::count(fitted->shown, true) < 3) return std::nullopt;
  const auto whole = completed(beginning_at(fitted->corners, 1), shape, view.camera);
  if (!whole) return std::nullopt;
  RefinedFrame frame = *fitted;
  frame.corners = *whole;
  return frame;
}

// The heights between which the picture shows all of a frame, as shares of its height.
HeightShare shown_heights(const GrayView& image, const RefinedFrame& frame) {
  const FrameHomography map(frame.corners, frame.lens);
  const bool is_upper_shown = frame.shown[0];
  double shown = is_upper_shown ? 0 : 1, hidden = 1 - shown;
  for (int i = 0; i < 20; ++i) {
    const double v = (shown + hidden) / 2;
    const bool is_shown = is_in_picture(image, map(0, v)) && is_in_picture(image, map(1, v));
    (is_shown ? shown : hidden) = v;
  }
  return is_upper_shown ? HeightShare{0, shown} : HeightShare{shown, 1};
}

// The symbol in the part of its frame that is in sight, as if this were the frame.
SymbolHypothesis in_part(const SymbolHypothesis& symbol, const HeightShare& part) {
  SymbolHypothesis result = symbol;
  const FrameHomography map(symbol.frame.corners, symbol.frame.lens);
  result.frame.corners =
      Quad{map(0, part.begin), map(1, part.begin), map(1, part.end), map(0, part.end)};
  const double height = part.end - part.begin;
  const auto share_of_part = [&](double v) {
    return std::clamp((v - part.begin) / height, 0.0, 1.0);
  };
  SymbolLayout& layout = result.layout;
  layout.bars_top = share_of_part(layout.bars_top);
  layout.bars_bottom = share_of_part(layout.bars_bottom);
  layout.frame.height *= height;
  result.rows.reset();
  return result;
}

// The whole frame from P on, of which a part is in sight.
std::optional<Quad> whole_frame(const Quad& part, bool is_upper_shown, const FrameShape& shape,
                                const Camera& camera) {
  const std::size_t shown = is_upper_shown ? 0 : 2;
  const auto whole = completed(beginning_at(part, shown + 1), shape, camera);
  return whole ? std::optional(beginning_at(*whole, shown)) : std::nullopt;
}

// How far a frame's side out of sight may be from where its proportions have it, pixels: the more,
// the more obliquely the plate is seen. Seen from the height of the side in sight the other three
// sides do not tell at all how far it is turned about a vertical axis. Nothing where a slightly
// different frame is that of no rectangle.
std::optional<double> doubt_of_unseen(const Quad& whole, const CornerCovariance& covariance,
                                      bool is_upper_shown, const FrameShape& shape,
                                      const CutView& view) {
  const std::size_t hidden = is_upper_shown ? 2 : 0;
  const PixelPoint outward = side_of(whole, hidden).outward;
  Eigen::Matrix<double, 2, 8> by_corners;
  for (std::size_t k = 0; k < 8; ++k) {
    Quad other = whole;
    (k % 2 == 0 ? other[k / 2].x : other[k / 2].y) += 1;
    const auto moved = whole_frame(other, is_upper_shown, shape, view.camera);
    if (!moved) return std::nullopt;
    for (const std::size_t end : {0U, 1U}) {
      by_corners(static_cast<Eigen::Index>(end), static_cast<Eigen::Index>(k)) =
          dot((*moved)[hidden + end] - whole[hidden + end], outward);
    }
  }
  const double by_sides = (by_corners * covariance * by_corners.transpose()).trace() / 2;
  const int steps = view.options.camera ? kPart.steps : kPart.steps_unknown;
  const double by_proportions = kPart.step * steps * distance(whole[1], whole[2]);
  return std::sqrt(by_sides + by_proportions * by_proportions);
}

// A believed symbol, and how far the side out of sight may be from where it is assumed.
struct SymbolInPart {
  SymbolHypothesis symbol;
  double doubt_px = 0;

  std::size_t side_in_sight() const { return symbol.frame.shown[0] ? 0 : 2; }

  // From the side in sight to the bars' ends, which are as far off as this is of the height.
  double margin_px_in_doubt() const {
    const SymbolLayout& layout = symbol.layout;
    return doubt_px * (side_in_sight() == 0 ? layout.bars_top : 1 - layout.bars_bottom);
  }
};

// The symbol in such a frame, if it is believed and its bars end where they should beside the side
// in sight. Where they do not quite, that side may be the edge of something along it, and is as
// unsure.
std::optional<SymbolInPart> believed_in(const CutView& view, const RefinedFrame& frame) {
  auto symbol = quick_hypothesis(view.image, frame, view.options);
  if (!symbol || !may_be_symbol(*symbol)) return std::nullopt;
  if (objection_to_quick(view.image, *symbol, view.options)) {
    symbol = believed_hypothesis(view.image, frame, view.options, false);
  }
  if (!symbol || !symbol->frame.shown[1] || !symbol->frame.shown[3]) return std::nullopt;
  SymbolInPart part{*std::move(symbol)};
  RefinedFrame& seen = part.symbol.frame;
  const Quad corners = corners_of(part.symbol);
  const auto off = off_bar_ends(bar_ends_of(view.image, part.symbol), part.side_in_sight(), corners,
                                part.symbol.layout);
  if (!off || *off > ends_tolerance_px(corners)) return std::nullopt;
  seen.sides[part.side_in_sight()].covariance += Eigen::Matrix2d::Constant(*off * *off);
  const auto doubt = doubt_of_unseen(seen.corners, corner_covariance(seen, 0, 0), seen.shown[0],
                                     part.symbol.layout.frame, view);
  if (!doubt) return std::nullopt;
  part.doubt_px = *doubt;
  return part;
}

// The corners of the whole frame by those of its part in sight. Those out of sight lie on the lines
// of the sides, and are as unsure along them as `doubt` says.
PlacedCorners whole_corners(const PlacedCorners& part, const Quad& whole, bool is_upper_shown,
                            double doubt) {
  CornerCovariance by_part = CornerCovariance::Identity();
  CornerCovariance along = CornerCovariance::Zero();
  for (const std::size_t i : is_upper_shown ? std::array{2U, 3U} : std::array{0U, 1U}) {
    const std::size_t shown = 3 - i;  // at the other end of its side
    const PixelPoint side = whole[i] - part.corners[shown];
    const double longer = length(side) / distance(part.corners[i], part.corners[shown]);
    const auto at = static_cast<Eigen::Index>(2 * i), from = static_cast<Eigen::Index>(2 * shown);
    by_part.block<2, 2>(at, at) *= longer;
    by_part.block<2, 2>(at, from) = (1 - longer) * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d direction = Eigen::Vector2d(side.x, side.y).normalized();
    along.block<2, 2>(at, at) = doubt * doubt * direction * direction.transpose();
  }
  return {whole, by_part * part.covariance * by_part.transpose() + along};
}

// The corners of the whole frame by sides and bars in sight. How far the bars end from the side in
// sight is a share of a height that is as unsure as the side out of sight.
std::optional<PlacedCorners> placed_by_part(const CutView& view, const SymbolInPart& seen,
                                            const HeightShare& heights) {
  const bool is_upper_shown = seen.side_in_sight() == 0;
  const SymbolHypothesis part = in_part(seen.symbol, heights);
  BothEnds ends = bar_ends_of(view.image, part);
  (is_upper_shown ? ends.lower : ends.upper).reset();  // the bars run on there
  auto& shown = is_upper_shown ? ends.upper : ends.lower;
  if (shown) shown->sigma_px = std::hypot(shown->sigma_px, seen.margin_px_in_doubt());
  const PlacedCorners placed = placed_by_frame_and_bars(view.image, part, ends);
  const auto whole =
      whole_frame(placed.corners, is_upper_shown, seen.symbol.layout.frame, view.camera);
  return whole ? std::optional(whole_corners(placed, *whole, is_upper_shown, seen.doubt_px))
               : std::nullopt;
}

std::optional<PartReading> reading_of_height(const CutView& view, const SymbolInPart& part) {
  const SymbolHypothesis& symbol = part.symbol;
  const HeightShare heights = shown_heights(view.image, symbol.frame);
  const auto placed = placed_by_part(view, part, heights);
  if (!placed) return std::nullopt;
  PartReading reading;
  reading.candidates = {{symbol.decoding.digits}};
  reading.in_sight.fill(true);
  reading.shows_all_bars = true;
  reading.corners = placed->corners;
  for (std::size_t i = 0; i < 4; ++i) {
    reading.corner_in_sight[i] = is_in_picture(view.image, reading.corners[i]);
  }
  reading.corner_covariance = placed->covariance;
  reading.share = heights.end - heights.begin;
  reading.module_px = symbol.profile.module_px;
  reading.confidence = symbol.decoding.confidence;
  return reading;
}

std::optional<PartReading> read_without_halos(const CutView& view, const RefinedFrame& frame,
                                              const Sharpening& halos, const SymbolLayout& layout) {
  UnsharpenedImage plain(view.image);
  plain.undo(halos, frame.corners);
  const GrayView image = plain.view();
  const CutView without{image, view.camera, view.options};
  auto fitted = fit_cut_height(without, frame.corners, layout.frame, true);
  if (!fitted) return std::nullopt;
  add_halo_doubt(frame.corners, *fitted);
  const auto part = believed_in(without, *fitted);
  return part ? reading_of_height(without, *part) : std::nullopt;
}

}  // namespace

std::optional<PartReading> read_part_of_height(const GrayView& image, const Quad& cut,
                                               const Camera& camera, const ReadOptions& options) {
  const CutView view{image, camera, options};
  for (const SymbolLayout& layout : options.layouts) {
    const auto rough = completed(cut, layout.frame, camera);
    const auto frame = rough ? fit_cut_height(view, *rough, layout.frame, false) : std::nullopt;
    const auto part = frame ? believed_in(view, *frame) : std::nullopt;
    auto reading = part ? reading_of_height(view, *part) : std::nullopt;
    if (!reading) continue;
    const auto halos = sharpening_of(image, *frame, layout.frame);
    auto plain = halos ? read_without_halos(view, *frame, *halos, layout) : std::nullopt;
    return plain ? std::move(plain) : std::move(reading);
  }
  return std::nullopt;
}

}  // namespace tagsmith::detail
