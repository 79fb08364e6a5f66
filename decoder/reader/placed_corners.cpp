// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/placed_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/field_displacement.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/reader/stroke_edges.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

using CornerVector = Eigen::Matrix<double, 8, 1>;

// Adds a displacement of a whole side, hardly turned, by so many pixels.
void add_displacement(double px, FrameSide& side) {
  side.covariance += px * px * Eigen::Matrix2d{{1.25, 1}, {1, 1.25}};
}

// By how much a stroke is clearly thicker or thinner than the others: it has a crust or dirt along
// one of its edges.
double clear_excess(const StrokeExcesses& excesses, std::size_t side) {
  const auto& excess = excesses[side];
  return excess && std::abs(excess->px) >= 2 * excess->sigma_px ? excess->px : 0;
}

// Seen obliquely, ink that grew moves the upper and lower side farther than the growth across the
// bars says, and a tone curve does not.
void add_doubt_of_sides(const StrokeExcesses& excesses, double growth_along_bars,
                        RefinedFrame& frame) {
  for (FrameSide* side : {&frame.sides[0], &frame.sides[2]}) {
    add_displacement(growth_along_bars / 3, *side);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    add_displacement(clear_excess(excesses, i), frame.sides[i]);
  }
}

// By how much a stroke is thicker than bars and layout say, of those whose outer edges show: half
// of it may be at its inner edge.
double common_to_strokes(const StrokeExcesses& excesses) {
  double sum = 0, count = 0;
  for (const auto& excess : excesses) {
    if (!excess) continue;
    sum += excess->common_px;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

CornerCovariance covariance_by_frame(RefinedFrame frame, const SymbolHypothesis& symbol,
                                     const StrokeExcesses& excesses) {
  const BlackGrowth growth = growth_of(symbol);
  add_doubt_of_sides(excesses, growth.along_bars_px, frame);
  const double by_growth = growth.doubt_px / 2;
  const double by_strokes = common_to_strokes(excesses) / 2;
  const double by_shadows = symbol.in_shadow ? kCorner.in_shadow : 0;
  return corner_covariance(frame, std::hypot(by_growth, by_shadows), by_strokes);
}

// What the bars' ends show of the upper and the lower side.
struct SidesByEnds {
  bool shown = false;  // the ends beside the side are in sight
  double off_px = 0;   // by which the side contradicts them; 0 = it does not
};

// Where the ends of the bars beside it are not visible, only the stroke distinguishes the upper or
// the lower side from other edges, and an edge between light and shade may lie on it. A side that
// contradicts its bars' ends may be the edge of something else.
PlacedCorners placed_by_frame(const SymbolHypothesis& symbol,
                              const std::array<SidesByEnds, 2>& by_ends,
                              const StrokeExcesses& excesses) {
  RefinedFrame frame = symbol.frame;
  for (const std::size_t side : {0U, 2U}) {
    if (!frame.shown[side]) continue;
    const SidesByEnds& ends = by_ends[side / 2];
    const double doubt = ends.shown ? 0 : frame.sides[side].stroke_px / 2;
    frame.sides[side].covariance += Eigen::Matrix2d::Identity() * doubt * doubt;
    add_displacement(ends.off_px, frame.sides[side]);
  }
  return {corners_of(symbol), covariance_by_frame(std::move(frame), symbol, excesses)};
}

CornerVector as_vector(const FrameCorners& corners) {
  CornerVector vector;
  for (std::size_t i = 0; i < 4; ++i) {
    vector.segment<2>(static_cast<Eigen::Index>(2 * i)) << corners[i].x, corners[i].y;
  }
  return vector;
}

// Places on the frame's sides that the bars see: two each on side 3 and side 1, in the upper and in
// the lower half of their height, and both ends of side 0 and side 2, where the bars' ends show.
using Places = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;
using PlacesCovariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;

// How far outwards the bars put these places, pixels, beyond the frame as it was fitted.
struct SeenOutwards {
  explicit SeenOutwards(Eigen::Index places)
      : by_bars(Places::Zero(places)),
        covariance(PlacesCovariance::Zero(places, places)),
        by_corners(decltype(by_corners)::Zero(places, 8)) {}

  Places by_bars;
  PlacesCovariance covariance;
  // By how much these places move outwards with the corners.
  Eigen::Matrix<double, Eigen::Dynamic, 8, 0, 8, 8> by_corners;
  std::array<SidesByEnds, 2> by_ends{};  // above and below
};

// Enters how a place moves outwards with the corners; `share` of a side's length from its begin.
void enter_place(Eigen::Index place, const SideLine& line, std::size_t side, double share,
                 SeenOutwards& seen) {
  const Eigen::RowVector2d outward{line.outward.x, line.outward.y};
  const auto begin = static_cast<Eigen::Index>(2 * side);
  const auto end = static_cast<Eigen::Index>(2 * ((side + 1) % 4));
  seen.by_corners.block<1, 2>(place, begin) = (1 - share) * outward;
  seen.by_corners.block<1, 2>(place, end) = share * outward;
}

// Enters a place on side 3 or 1 at a height, a share of the frame's. Returns how far it lies
// outwards for a displacement of the bars.
Eigen::RowVector3d enter_beside(Eigen::Index place, std::size_t side, double height,
                                const SymbolHypothesis& symbol, SeenOutwards& seen) {
  const SymbolLayout& layout = symbol.layout;
  const FrameHomography map(symbol.frame.corners, symbol.frame.lens);
  const auto seen_at = [&](double module) { return map(layout.width_share(module), height); };
  const double quiet = layout.quiet_zone_modules;
  const double module = side == 3 ? -quiet : kModuleCount + quiet;
  const SideLine line = side_of(symbol.frame.corners, side);
  enter_place(place, line, side,
              dot(seen_at(module) - line.begin, line.along) / distance(line.begin, line.end), seen);
  const double module_px = dot(seen_at(module + 0.5) - seen_at(module - 0.5), line.outward);
  return module_px * SeenPlaces::by_displacement(module);
}

// Takes what is plain where the symbol shows bars for covered or saturated: no element is wider
// than four modules.
void hide_plain(const SymbolHypothesis& symbol, ScanProfile& bins) {
  constexpr double kWindow = 5;  // modules
  const auto count = static_cast<Eigen::Index>(bins.size());
  const auto bars = bar_shares(bins, symbol.decoding.fit.image, symbol.decoding.digits);
  Eigen::ArrayXd shown(count), expected(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    shown[i] = bins[static_cast<std::size_t>(i)].darkness;
    expected[i] = static_cast<double>(bars[static_cast<std::size_t>(i)].share);
  }
  const auto variance = [](const auto& places) { return (places - places.mean()).square().mean(); };
  Eigen::Index end = 0;
  for (Eigen::Index first = 0; first < count; ++first) {
    const double until = bins[static_cast<std::size_t>(first)].at + kWindow;
    while (end < count && bins[static_cast<std::size_t>(end)].at < until) ++end;
    const Eigen::Index size = end - first;
    if (variance(shown.segment(first, size)) >=
        kProfile.plainer * variance(expected.segment(first, size))) {
      continue;
    }
    for (Eigen::Index i = first; i < end; ++i) {
      bins[static_cast<std::size_t>(i)].variance = kHiddenVariance;
    }
  }
}

SeenBands seen_bands(const SymbolHypothesis& symbol, const RobustProfile& rows) {
  const bool by_bars_alone = !symbol.frame.shown[1] || !symbol.frame.shown[3];
  SeenBands bands;
  for (int i = 0; i < 4; ++i) {
    ScanProfile bins = rows.of_agreeing_rows(band_of(i), symbol.profile).bins;
    if (by_bars_alone) hide_plain(symbol, bins);
    SeenPlaces& bars = bands[static_cast<std::size_t>(i)];
    bars = seen_places(bins, symbol.decoding.digits, symbol.decoding.fit.image);
    bars.covariance *=
        kCorner.alike * (symbol.frame.was_sharpened ? correlation_factor(bars.residuals) : 1);
  }
  return bands;
}

// Enters the two places that the bars of half their height see, that of two bands.
void enter_half(const HeightShare& half, const SeenPlaces& upper, const SeenPlaces& lower,
                Eigen::Index first, const SymbolHypothesis& symbol, SeenOutwards& seen) {
  const double height = middle_height(half, symbol.layout);
  Eigen::Matrix<double, 2, 3> by_displacement;
  by_displacement << enter_beside(first, 3, height, symbol, seen),
      enter_beside(first + 1, 1, height, symbol, seen);
  // The mean of the two, each by its information.
  const Eigen::Matrix3d share = lower.covariance * (upper.covariance + lower.covariance).inverse();
  seen.by_bars.segment<2>(first) =
      by_displacement * (lower.displacement + share * (upper.displacement - lower.displacement));
  seen.covariance.block<2, 2>(first, first) =
      by_displacement * share * upper.covariance * by_displacement.transpose();
}

// Variance of sides by the bars, pixels^2, from what is unknown about a lens. A lens of the
// division model displaces a point at t along the bars from their middle by lambda t^3 and by terms
// that shift, stretch and bend absorb. A lens that differs slightly from its model displaces, along
// a frame twice as long as high, by up to twice the bow of the longer sides.
double lens_variance(const SymbolHypothesis& symbol) {
  const RefinedFrame& frame = symbol.frame;
  const double half_length = symbol.profile.module_px * kModuleCount / 2;
  const double unseen = frame.lens_doubt * std::pow(half_length, 3);
  double shape = frame.unexplained_bow;
  for (const SideSagitta& side : sagittas_of(frame.lens, frame.corners)) {
    shape = std::max(shape, kLens.shape * std::abs(side.middle()));
  }
  return unseen * unseen + 4 * shape * shape;
}

// Enters the two ends of side 0 or 2 by where the bars end. What is unknown about a lens turns that
// line, too, so each end has an independent error as well.
void enter_ends(const BarEnds& ends, std::size_t side, Eigen::Index first,
                const SymbolHypothesis& symbol, double by_lens, SeenOutwards& seen) {
  const SymbolLayout& layout = symbol.layout;
  const FrameHomography map(symbol.frame.corners, symbol.frame.lens);
  const double v = side == 0 ? layout.bars_top : layout.bars_bottom;
  const SideLine line = side_of(symbol.frame.corners, side);
  const double longer = growth_of(symbol).px / 2;
  for (const int end : {0, 1}) {
    enter_place(first + end, line, side, end, seen);
    const double u = side == 0 ? end : 1 - end;
    seen.by_bars[first + end] = dot(map(u, ends.at(u)) - map(u, v), line.outward) - longer;
  }
  const double layout_px = kBarEnds.layout * height_of(symbol.frame.corners);
  seen.covariance.block<2, 2>(first, first) =
      Eigen::Matrix2d::Constant(layout_px * layout_px + by_lens) +
      Eigen::Matrix2d::Identity() * (ends.sigma_px * ends.sigma_px + by_lens);
}

// Bars have the same unexplained errors as a frame's sides: a common one for each side as a whole,
// one for each of its halves independently, and for the halves also that of the lens.
void add_unexplained(double by_lens, SeenOutwards& seen) {
  const double alone = kCorner.side * kCorner.side + by_lens;
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = i % 2; j < 4; j += 2) {
      seen.covariance(i, j) += kCorner.side * kCorner.side;
    }
    seen.covariance(i, i) += alone;
  }
}

// How far the upper and the lower corners may lie along the bars beside a straight line through the
// bars of all heights, pixels: what a quadratic and a cubic through the bands add to it there, if
// more than noise puts the bands beside a line. Rows of an image that a shaken camera reads one
// after another do so. A shake also looks like pixel locking of the sides, which is no noise here.
std::array<double, 2> beside_a_line(const SeenBands& bands, double middle,
                                    const SymbolHypothesis& symbol) {
  const Eigen::RowVector3d at_middle = SeenPlaces::by_displacement(middle);
  const double px = symbol.profile.module_px;
  Eigen::Matrix<double, 1, 4> shift, variance;
  for (int i = 0; i < 4; ++i) {
    const SeenPlaces& bars = bands[static_cast<std::size_t>(i)];
    shift[i] = px * at_middle.dot(bars.displacement);
    variance[i] = px * px * at_middle.dot(bars.covariance * at_middle.transpose()) +
                  kCorner.side * kCorner.side;
  }
  // Multiples of the orthogonal polynomials of second and third degree at -1.5, -0.5, 0.5, 1.5.
  const Eigen::Vector4d second(1, -1, -1, 1), third(-1, 3, -3, 1);
  const double quadratic = shift.dot(second), cubic = shift.dot(third);
  const double chi_square =
      quadratic * quadratic / variance.sum() + cubic * cubic / variance.dot(third.cwiseAbs2());
  if (!(chi_square > 9)) return {};  // 1 in 90 by noise alone
  const auto height = [&](int band) { return middle_height(band_of(band), symbol.layout); };
  const double step = (height(3) - height(0)) / 3;
  const auto beside = [&](double corner) {
    const double x = (corner - height(0)) / step - 1.5;
    return std::hypot(quadratic / 4 * (x * x - 1.25), cubic / 6 * (x * x * x - 2.05 * x));
  };
  return {beside(0), beside(1)};
}

// By how far lopsidedness is beyond four standard deviations of what noise explains, and of what
// bars along the pixel grid show in clear photos, pixels.
double beyond_noise(const Lopsidedness& seen) {
  const double noise = 4 * std::hypot(seen.sigma_px, 0.05);
  return std::sqrt(std::max(0.0, seen.px * seen.px - noise * noise));
}

// By how much everything that is seen may be displaced, pixels, where the picture is of more than
// one moment: two exposures, or a filter that mixes earlier frames into it. Then the point spread
// is lopsided along the motion. Zero where noise explains it.
double between_moments(const GrayView& image, const SeenBands& bands,
                       const SymbolHypothesis& symbol) {
  double sum = 0, weight = 0;
  for (const SeenPlaces& bars : bands) {
    const double here = 1 / (bars.lopsided_sigma * bars.lopsided_sigma);
    sum += here * bars.lopsided;
    weight += here;
  }
  const double px = symbol.profile.module_px;
  const double across = beyond_noise({px * sum / weight, px / std::sqrt(weight)});
  const double blur_px = std::max(symbol.frame.sides[0].blur_px, symbol.frame.sides[2].blur_px);
  if (blur_px < 0.8) return across;  // it hides no such motion along the bars
  const auto along = lopsidedness_along_bars(image, bar_ends_of(image, symbol), blur_px);
  return std::hypot(across, along ? beyond_noise(*along) : 0);
}

// Of a line of bars' ends: where it stands in SeenOutwards, and how far it may be off by itself.
struct EnteredEnds {
  Eigen::Index first = 0;
  double variance = 0;  // pixels^2
};

// A side of which the bars' ends contradict those at the other side more than noise explains may be
// the edge of something that lies along it, such as a cable or a board, unless that lies across the
// ends: the side stays, and is as unsure as it is off. By the layout alone this would not
// show, but what the margins are rounded by, and most of the systematic error, is common to both.
// Why: docs/decisions/0007-corner-covariance.md.
void doubt_sides_off_ends(const SymbolHypothesis& symbol, const StrokeExcesses& excesses,
                          const EnteredEnds& upper, const EnteredEnds& lower, SeenOutwards& seen) {
  const auto off = [&](const EnteredEnds& ends) { return seen.by_bars.segment<2>(ends.first); };
  const auto of_side = [&](std::size_t side) {
    const double excess = clear_excess(excesses, side);
    return symbol.frame.sides[side].covariance.trace() / 2 + excess * excess;
  };
  const double variance = upper.variance + lower.variance + of_side(0) + of_side(2);
  const double apart = off(upper).mean() - off(lower).mean();
  if (!(apart * apart > 9 * variance)) return;  // three standard deviations
  for (const auto& [side, ends] : {std::pair{0U, upper}, std::pair{1U, lower}}) {
    seen.by_ends[side].off_px = off(ends).cwiseAbs().maxCoeff();
    seen.covariance.block<2, 2>(ends.first, ends.first).diagonal().array() +=
        1e6;  // they do not count
  }
}

SeenOutwards seen_by_bars(const SymbolHypothesis& symbol, const SeenBands& bands,
                          const BothEnds& ends, const StrokeExcesses& excesses) {
  const auto& [field, upper, lower] = ends;
  // A side that was hidden is already placed by the ends.
  const bool has_upper = upper && symbol.frame.shown[0], has_lower = lower && symbol.frame.shown[2];
  SeenOutwards seen(4 + (has_upper ? 2 : 0) + (has_lower ? 2 : 0));
  seen.by_ends = {SidesByEnds{upper.has_value()}, SidesByEnds{lower.has_value()}};
  enter_half({0, 0.5}, bands[0], bands[1], 0, symbol, seen);
  enter_half({0.5, 1}, bands[2], bands[3], 2, symbol, seen);
  const double by_lens = lens_variance(symbol);
  add_unexplained(by_lens, seen);
  const Eigen::Index below = seen.by_bars.size() - 2;
  if (has_upper) enter_ends(*upper, 0, 4, symbol, by_lens, seen);
  if (has_lower) enter_ends(*lower, 2, below, symbol, by_lens, seen);
  if (has_upper && has_lower) {
    // The two lines have eight ninths of the variance of their systematic error in common.
    const double common = kBarEnds.systematic_px * kBarEnds.systematic_px * 8 / 9;
    const auto alone = [&](const BarEnds& line) {
      return line.sigma_px * line.sigma_px + by_lens - common;
    };
    doubt_sides_off_ends(symbol, excesses, {4, alone(*upper)}, {below, alone(*lower)}, seen);
  }
  return seen;
}

// How corners move when the places are put where the bars have them, and how much better the
// corners are known then: least squares.
struct Correction {
  CornerVector moved;
  CornerCovariance gained;  // pixels^2, of their covariance
  double chi_square = 0;    // of the places, by where the corners were before
};

Correction correction_by(const SeenOutwards& seen, const CornerVector& moved_before,
                         const CornerCovariance& covariance) {
  const auto off = (seen.by_bars - seen.by_corners * moved_before).eval();
  const auto shared = (covariance * seen.by_corners.transpose()).eval();
  const auto solver = (seen.by_corners * shared + seen.covariance).eval().ldlt();
  return {shared * solver.solve(off), shared * solver.solve(shared.transpose()),
          off.dot(solver.solve(off))};
}

// The bars' edges are as good as straight over a small part of a module only, and a hidden side may
// be moved by whole ones: adds what one step of the fit then misses.
void add_doubt_of_long_moves(const SymbolHypothesis& symbol, const CornerVector& moved,
                             CornerCovariance& covariance) {
  for (const std::size_t side : {1U, 3U}) {
    if (symbol.frame.shown[side]) continue;
    for (const std::size_t corner : {side, (side + 1) % 4}) {
      const auto k = static_cast<Eigen::Index>(2 * corner);
      const double missed = moved.segment<2>(k).squaredNorm() / (4 * symbol.profile.module_px);
      covariance.block<2, 2>(k, k) += missed * missed * Eigen::Matrix2d::Identity();
    }
  }
}

// The corners by the frame, moved to where the bars have them as far as the two agree.
PlacedCorners moved_to_bars(const SymbolHypothesis& symbol, const SeenOutwards& seen,
                            const StrokeExcesses& excesses) {
  PlacedCorners placed = placed_by_frame(symbol, seen.by_ends, excesses);
  const CornerVector at = as_vector(placed.corners);
  const CornerVector before = at - as_vector(symbol.frame.corners);
  const Correction found = correction_by(seen, before, placed.covariance);
  if (!std::isfinite(found.chi_square)) return placed;
  const double excess = std::max(1.0, found.chi_square / static_cast<double>(seen.by_bars.size()));
  if (excess > kCorner.most_contradiction) {
    // One of the two is wrong: the frame stays; the place that the bars give is as likely.
    const CornerVector apart =
        correction_by(seen, before, found.chi_square * placed.covariance).moved;
    placed.covariance = excess * placed.covariance + apart * apart.transpose() +
                        CornerCovariance::Identity() * (apart.squaredNorm() / 8);
    return placed;
  }
  placed.covariance = excess * (placed.covariance - found.gained);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto k = static_cast<Eigen::Index>(2 * i);
    placed.corners[i] = {at[k] + found.moved[k], at[k + 1] + found.moved[k + 1]};
  }
  add_doubt_of_long_moves(symbol, found.moved, placed.covariance);
  return placed;
}

}  // namespace

HeightShare band_of(int band) { return {0.25 * band, 0.25 * (band + 1)}; }

CornerCovariance covariance_by_motion(const GrayView& image, const SeenBands& bands, double middle,
                                      const SymbolHypothesis& symbol) {
  const std::array<double, 2> beside = beside_a_line(bands, middle, symbol);
  Eigen::Matrix<double, 8, 2> moved = Eigen::Matrix<double, 8, 2>::Zero();
  for (const Eigen::Index i : {0, 1}) {
    const auto end = static_cast<std::size_t>(i);
    const PixelPoint along = side_of(symbol.frame.corners, 2 * end).along;
    moved.block<4, 1>(4 * i, i) << along.x, along.y, along.x, along.y;
    moved.col(i) *= beside[end];
  }
  CornerCovariance covariance = moved * moved.transpose();
  const PixelBox around = box_around(symbol.frame.corners, kMostFieldDisplacement, image);
  const double by_fields = field_displacement(part_of(image, around)) / 2;
  covariance.diagonal().array() += by_fields * by_fields;  // the rows do not show it across them
  // The bars show how far, and not in which direction.
  const double by_moments = between_moments(image, bands, symbol);
  covariance += by_moments * by_moments * Eigen::Matrix2d::Identity().replicate<4, 4>();
  return covariance;
}

BothEnds bar_ends_of(const GrayView& image, const SymbolHypothesis& symbol) {
  return find_both_ends(
      image, bar_field(symbol.frame.corners, symbol.layout, symbol.frame.lens, symbol.in_shadow));
}

CornerCovariance covariance_by_frame(const GrayView& image, const SymbolHypothesis& symbol) {
  return covariance_by_frame(symbol.frame, symbol, stroke_excesses(image, symbol));
}

PlacedCorners placed_by_frame_and_bars(const GrayView& image, const SymbolHypothesis& symbol,
                                       const BothEnds& ends) {
  const SeenBands bands = seen_bands(symbol, *rows_of(image, symbol.frame, symbol));
  const StrokeExcesses excesses = stroke_excesses(image, symbol);
  PlacedCorners placed =
      moved_to_bars(symbol, seen_by_bars(symbol, bands, ends, excesses), excesses);
  placed.covariance += covariance_by_motion(image, bands, kModuleCount / 2.0, symbol);
  return placed;
}

}  // namespace tagsmith::detail
