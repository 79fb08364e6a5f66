// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/occluders.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "decoder/reader/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// Places around the bars, clockwise, where the plate should be all white, or all black.
struct Loop {
  std::vector<PixelPoint> at;    // unit square of the frame's inside
  std::vector<double> level;     // grey level seen there
  std::vector<double> expected;  // that of the places around that agree
};

constexpr int kPerSide = 192;

// A rectangle around the bars at these distances from the frame's inner edge (negative: outside).
Loop loop_at(const GrayView& image, const FrameHomography& image_from_frame, double from_side,
             double from_top, double spread_u, double spread_v) {
  Loop loop;
  const std::array<PixelPoint, 5> corners{{{from_side, from_top},
                                           {1 - from_side, from_top},
                                           {1 - from_side, 1 - from_top},
                                           {from_side, 1 - from_top},
                                           {from_side, from_top}}};
  for (std::size_t side = 0; side < 4; ++side) {
    for (int k = 0; k < kPerSide; ++k) {
      const double t = (k + 0.5) / kPerSide;
      const PixelPoint at = (1 - t) * corners[side] + t * corners[side + 1];
      double sum = 0;
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          sum += sample_bilinear(image, image_from_frame(at.x + i * spread_u, at.y + j * spread_v));
        }
      }
      loop.at.push_back(at);
      loop.level.push_back(sum / 9);
    }
  }
  return loop;
}

double quantile_of(std::vector<double> values, double share) { return quantile(values, share); }

// The level that a loop should show: from the places within a side's length, the upper or lower
// part of the middle, so that covers over up to half of them do not count. Every fourth of the
// places is used: on the way from one of them to the next fourth, one leaves and one is new.
void expect(Loop& loop, double share) {
  constexpr int kReach = kPerSide / 2, kStride = 4;
  const int size = static_cast<int>(loop.level.size());
  const auto level = [&](int i) { return loop.level[static_cast<std::size_t>((i + size) % size)]; };
  loop.expected.resize(loop.level.size());
  for (int first = 0; first < kStride; ++first) {
    std::vector<double> near;
    for (int k = -kReach; k <= kReach; k += kStride) near.push_back(level(first + k));
    std::ranges::sort(near);
    const std::size_t place = quantile_place(near.size(), share);
    for (int i = first; i < size; i += kStride) {
      loop.expected[static_cast<std::size_t>(i)] = near[place];
      near.erase(std::ranges::lower_bound(near, level(i - kReach)));
      const double next = level(i + kReach + kStride);
      near.insert(std::ranges::upper_bound(near, next), next);
    }
  }
}

// Consecutive places of a loop that do not show what they should.
struct Crossing {
  int begin = 0;
  int count = 0;
};

std::vector<Crossing> crossings_of(const Loop& loop, double tolerance) {
  constexpr int kMost = 2 * kPerSide;
  const int size = static_cast<int>(loop.level.size());
  const auto is_odd = [&](int i) {
    const auto at = static_cast<std::size_t>((i + size) % size);
    return std::abs(loop.level[at] - loop.expected[at]) > tolerance;
  };
  std::vector<Crossing> crossings;
  int start = 0;  // a place that shows what it should: no crossing is cut there
  while (start < size && is_odd(start)) ++start;
  for (int i = start; i < start + size; ++i) {
    if (!is_odd(i)) continue;
    const int begin = i;
    while (i < start + size && is_odd(i)) ++i;
    if (i - begin <= kMost) crossings.push_back({begin, i - begin});
  }
  return crossings;
}

PixelPoint point_of(const Loop& loop, int i) {
  const int size = static_cast<int>(loop.at.size());
  return loop.at[static_cast<std::size_t>((i % size + size) % size)];
}

double level_at(const Loop& loop, int i) {
  const int size = static_cast<int>(loop.at.size());
  return loop.level[static_cast<std::size_t>((i % size + size) % size)];
}

// The strip between two crossings, a little wider; clockwise because the loop is.
Occluder strip_between(const Loop& loop, const Crossing& a, const Crossing& b) {
  constexpr int kBeyond = 1;  // places: its blurred outline
  return {point_of(loop, a.begin - kBeyond), point_of(loop, a.begin + a.count - 1 + kBeyond),
          point_of(loop, b.begin - kBeyond), point_of(loop, b.begin + b.count - 1 + kBeyond)};
}

bool same_side(const Loop& loop, const Crossing& a, const Crossing& b) {
  const int size = static_cast<int>(loop.at.size());
  const auto side = [&](const Crossing& c) { return ((c.begin + c.count / 2) % size) / kPerSide; };
  return side(a) == side(b);
}

// Whether the light along a way through the unit square is as it should be nearly everywhere. `off`
// returns by how much a level is not, this share of the way on.
template <class Off>
bool is_even_along(const GrayView& image, const FrameHomography& image_from_frame, PixelPoint begin,
                   PixelPoint end, double tolerance, const Off& off) {
  constexpr int kPlaces = 64;
  int even = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const double t = (k + 0.5) / kPlaces;
    const PixelPoint at = (1 - t) * begin + t * end;
    const double level = sample_bilinear(image, image_from_frame(at.x, at.y));
    even += off(level, t) < tolerance ? 1 : 0;
  }
  return even >= kOccluder.least_even * kPlaces;
}

// Whether the light along a strip changes evenly from one crossing to the other: along its middle
// and halfway to its sides.
bool is_plain(const GrayView& image, const FrameHomography& image_from_frame, const Loop& loop,
              const Crossing& a, const Crossing& b, double tolerance) {
  const auto place = [](const Crossing& crossing, double share) {
    return crossing.begin + static_cast<int>(std::lround(share * (crossing.count - 1)));
  };
  return std::ranges::all_of(std::array{0.25, 0.5, 0.75}, [&](double share) {
    // Clockwise on one crossing is anticlockwise on the other.
    const int first = place(a, share), second = place(b, 1 - share);
    const double from = level_at(loop, first), to = level_at(loop, second);
    return is_even_along(
        image, image_from_frame, point_of(loop, first), point_of(loop, second), tolerance,
        [&](double level, double t) { return std::abs(level - ((1 - t) * from + t * to)); });
  });
}

void add_strips(const GrayView& image, const FrameHomography& image_from_frame, const Loop& loop,
                double contrast, std::vector<Occluder>& strips) {
  const std::vector<Crossing> crossings = crossings_of(loop, kProfile.odd * contrast);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& a = crossings[i];
    if (a.count >= kPerSide / 6) {
      // It may cut off a corner or a whole side: what lies between its ends and the loop.
      const int third = a.count / 3;
      strips.push_back({point_of(loop, a.begin - 1), point_of(loop, a.begin + third),
                        point_of(loop, a.begin + 2 * third), point_of(loop, a.begin + a.count)});
    }
    for (std::size_t j = i + 1; j < crossings.size(); ++j) {
      const Crossing& b = crossings[j];
      if (same_side(loop, a, b)) continue;
      if (!is_plain(image, image_from_frame, loop, a, b, kProfile.odd * contrast)) continue;
      strips.push_back(strip_between(loop, a, b));
    }
  }
}

constexpr int kPlacesPerModule = 2;
constexpr int kWidest = kWidestElement * kPlacesPerModule;  // places

// Places along the symbol, in the unit square, every half module and a little beyond the bars.
std::vector<double> places_along(const SymbolLayout& layout) {
  constexpr int kBeyond = 2;  // modules on either side of the bars
  std::vector<double> places;
  for (int k = -kBeyond * kPlacesPerModule; k < (kModuleCount + kBeyond) * kPlacesPerModule; ++k) {
    places.push_back(layout.width_share((k + 0.5) / kPlacesPerModule));
  }
  return places;
}

std::vector<double> levels_at(const GrayView& image, const FrameHomography& image_from_frame,
                              std::span<const double> u, double v) {
  std::vector<double> levels;
  for (const double at : u) levels.push_back(sample_bilinear(image, image_from_frame(at, v)));
  return levels;
}

// What is beside the ends of the bars: the plate there is all white, or all ink.
enum class Beside { quiet_zone, stroke };

// The light beside the ends of the bars.
struct Row {
  Beside beside = Beside::quiet_zone;
  double v = 0;               // in the unit square
  std::span<const double> u;  // likewise
  std::vector<double> level;  // grey
  double contrast = 0;        // of the bars
};

// The means with the light `spread` above and below.
void add_neighbours(Row& row, const GrayView& image, const FrameHomography& image_from_frame,
                    double spread) {
  const std::vector<double> above = levels_at(image, image_from_frame, row.u, row.v - spread);
  const std::vector<double> below = levels_at(image, image_from_frame, row.u, row.v + spread);
  for (std::size_t i = 0; i < row.level.size(); ++i) {
    row.level[i] = (row.level[i] + above[i] + below[i]) / 3;
  }
}

// By how much a level is outside the expected range, which is between two others: white may be
// darker or glare, ink only lighter.
double oddness(const Row& row, double level, double one, double other) {
  const auto [low, high] = std::minmax(one, other);
  return row.beside == Beside::stroke ? level - high : std::max({0.0, low - level, level - high});
}

// The oddness from which a place counts, as a share of the contrast. In ink, less would be noise;
// two modules of white show more, as long as bars of one module can be distinguished.
double odd_from(const Row& row) {
  return row.beside == Beside::stroke ? kOccluder.odd_in_ink : kProfile.odd;
}

bool is_clear(const Row& row) {
  const double usual = quantile_of(row.level, 0.5);
  return std::ranges::all_of(row.level, [&](double level) {
    return oddness(row, level, usual, usual) <= odd_from(row) / 2 * row.contrast;
  });
}

// By how much a place of a row differs from its surroundings: it is neither like one side nor like
// the other nor between. A shadow continues to one side, and its edge is between light and shadow.
double oddness_at(const Row& row, int place) {
  constexpr int kAround = 2 * kNearModules * kPlacesPerModule;
  const double share = row.beside == Beside::stroke ? 0.15 : 0.7;
  const int size = static_cast<int>(row.level.size());
  const auto level_of = [&](int first, int end) {
    return quantile_of(
        {row.level.begin() + std::max(0, first), row.level.begin() + std::min(end, size)}, share);
  };
  return oddness(row, row.level[static_cast<std::size_t>(place)],
                 level_of(place - kAround, place + 1), level_of(place, place + kAround + 1));
}

// Where the row differs from its surroundings.
std::vector<Crossing> crossings_of(const Row& row) {
  std::vector<Crossing> crossings;
  for (int i = 0; std::cmp_less(i, row.level.size()); ++i) {
    if (oddness_at(row, i) < odd_from(row) * row.contrast) continue;
    const bool goes_on = !crossings.empty() && crossings.back().begin + crossings.back().count == i;
    if (goes_on) ++crossings.back().count;
    if (!goes_on) crossings.push_back({i, 1});
  }
  return crossings;
}

// A place of a row, or the one at its end.
PixelPoint place_in(const Row& row, int place) {
  const int last = static_cast<int>(row.u.size()) - 1;
  return {row.u[static_cast<std::size_t>(std::clamp(place, 0, last))], row.v};
}

bool is_much_broader(int broader, int broad) { return broader > 2 * broad + kPlacesPerModule; }

// An object that crosses ink in one row may end in the other within a highlight or a board: this is
// the part of such a `broad` crossing that is straight above or below the `narrow` one.
Crossing part_in_line(const Crossing& broad, const Crossing& narrow) {
  const int last = broad.begin + broad.count - narrow.count;
  return {std::clamp(narrow.begin, broad.begin, last), narrow.count};
}

// Whether the crossings of a row above and a row below the bars may belong to one strip, broad
// enough to hide some module over two thirds of the bars' height. `bars_share` is the bars' height
// over the rows' distance.
// Why: docs/decisions/0004-covered-tags.md.
bool lies_along_bars(const Crossing& above, const Crossing& below, double bars_share) {
  const auto [broad, broader] = std::minmax(above.count, below.count);
  if (is_much_broader(broader, broad)) return false;
  const int way = std::abs(2 * above.begin + above.count - 2 * below.begin - below.count);
  return bars_share * way / 2 <= kOccluder.most_way * (broad + kPlacesPerModule);
}

// Whether the light from one crossing to the other changes evenly; over ink, where a strip is seen
// no lighter than it is, whether it is nowhere darker than both. Along their middles, or, of broad
// ones, along a line for each module farther in than the widest element: a shadow shows bars.
bool is_plain(const GrayView& image, const FrameHomography& image_from_frame, const Row& above,
              const Crossing& begin, const Row& below, const Crossing& end) {
  const bool over_ink = above.beside == Beside::stroke;
  const double tolerance = (over_ink ? kProfile.odd / 2 : kProfile.odd) * above.contrast;
  const int broad = std::max(begin.count, end.count);
  const int lines = 1 + std::max(0, broad - 2 * kWidest) / kPlacesPerModule;
  for (int line = 0; line < lines; ++line) {
    const double share =
        lines == 1 ? 0.5 : static_cast<double>(kWidest + line * kPlacesPerModule) / broad;
    const auto place = [&](const Crossing& crossing) {
      const int along = crossing.begin + static_cast<int>(share * crossing.count);
      return static_cast<std::size_t>(along);
    };
    const std::size_t first = place(begin), last = place(end);
    const double from = above.level[first], to = below.level[last];
    const bool is_even = is_even_along(
        image, image_from_frame, {above.u[first], above.v}, {below.u[last], below.v}, tolerance,
        [&](double level, double t) {
          return over_ink ? std::min(from, to) - level : std::abs((1 - t) * from + t * to - level);
        });
    if (!is_even) return false;
  }
  return true;
}

// Where strips along the bars are searched: two rows, from above and below which they lead.
struct Between {
  Beside beside;
  double v_above, v_below;
  double spread;  // of the lines that a row is the mean of; 0 = one line
};

// The strips from one row above the bars to another below. Seen along one line alone, a row that
// shows less than half of what counts is clear.
std::vector<Occluder> strips_between(const GrayView& image, const FrameHomography& image_from_frame,
                                     const SymbolLayout& layout, std::span<const double> places,
                                     double contrast, const Between& rows) {
  const auto row_at = [&](double v) {
    return Row{rows.beside, v, places, levels_at(image, image_from_frame, places, v), contrast};
  };
  Row above = row_at(rows.v_above);
  if (is_clear(above)) return {};
  Row below = row_at(rows.v_below);
  if (is_clear(below)) return {};
  if (rows.spread > 0) {
    for (Row* row : {&above, &below}) add_neighbours(*row, image, image_from_frame, rows.spread);
  }
  const double bars_share = layout.bar_height() / (rows.v_below - rows.v_above);
  std::vector<Occluder> strips;
  const auto add = [&](const Crossing& begin, const Crossing& end) {
    if (!lies_along_bars(begin, end, bars_share)) return;
    if (!is_plain(image, image_from_frame, above, begin, below, end)) return;
    strips.push_back({place_in(above, begin.begin - 1), place_in(above, begin.begin + begin.count),
                      place_in(below, end.begin + end.count), place_in(below, end.begin - 1)});
  };
  const bool may_end_in_broad = rows.beside == Beside::stroke;
  const std::vector<Crossing> ends = crossings_of(below);
  for (const Crossing& begin : crossings_of(above)) {
    for (const Crossing& end : ends) {
      if (may_end_in_broad && is_much_broader(end.count, begin.count)) {
        add(begin, part_in_line(end, begin));
      } else if (may_end_in_broad && is_much_broader(begin.count, end.count)) {
        add(part_in_line(begin, end), end);
      } else {
        add(begin, end);
      }
    }
  }
  return strips;
}

// The stroke's thickness as a share of the inner height, of what feature frames have.
double stroke_share(const RefinedFrame& frame) {
  const double stroke_px = (frame.sides[0].stroke_px + frame.sides[2].stroke_px) / 2;
  return std::clamp(stroke_px / height_of(frame.corners), 0.02, 0.2);
}

}  // namespace

std::vector<Occluder> strips_along_bars(const GrayView& image, const RefinedFrame& frame,
                                        const SymbolLayout& layout) {
  const FrameHomography image_from_frame(frame.corners, frame.lens);
  const double stroke = stroke_share(frame);
  const std::vector<double> places = places_along(layout);
  const std::vector<double> bars = levels_at(image, image_from_frame, places, 0.5);
  const double contrast = quantile_of(bars, 0.9) - quantile_of(bars, 0.1);
  std::vector<Occluder> strips =
      strips_between(image, image_from_frame, layout, places, contrast,
                     {Beside::quiet_zone, layout.bars_top / 2, (1 + layout.bars_bottom) / 2, 0});
  const std::vector<Occluder> pale =
      strips_between(image, image_from_frame, layout, places, contrast,
                     {Beside::stroke, -stroke / 2, 1 + stroke / 2, stroke / 4});
  strips.insert(strips.end(), pale.begin(), pale.end());
  return strips;
}

std::vector<Occluder> find_occluders(const GrayView& image, const RefinedFrame& frame,
                                     const SymbolLayout& layout) {
  const FrameHomography image_from_frame(frame.corners, frame.lens);
  const double stroke = stroke_share(frame);
  const double quiet = layout.width_share(0);
  const double margin = std::min(layout.bars_top, 1 - layout.bars_bottom);
  const double stroke_u = stroke * quiet / margin;  // as thick on all sides
  Loop white = loop_at(image, image_from_frame, quiet / 2, margin / 2, quiet / 12, margin / 12);
  Loop black =
      loop_at(image, image_from_frame, -stroke_u / 2, -stroke / 2, stroke_u / 8, stroke / 8);
  expect(white, 0.7);
  expect(black, 0.3);
  const double contrast = quantile_of(white.expected, 0.5) - quantile_of(black.expected, 0.5);
  std::vector<Occluder> strips = strips_along_bars(image, frame, layout);
  if (!(contrast > 0)) return strips;
  add_strips(image, image_from_frame, white, contrast, strips);
  add_strips(image, image_from_frame, black, contrast, strips);
  return strips;
}

HiddenWidth hidden_width(const Occluder& occluder, double v) {
  HiddenWidth width{-std::numeric_limits<double>::infinity(),
                    std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < 4; ++i) {
    // Inside is on the right of every edge: along.x (v - from.y) >= along.y (u - from.x).
    const PixelPoint from = occluder[i], along = occluder[(i + 1) % 4] - from;
    const double across = along.x * (v - from.y);
    if (along.y > 0) width.end = std::min(width.end, from.x + across / along.y);
    if (along.y < 0) width.begin = std::max(width.begin, from.x + across / along.y);
    if (along.y == 0 && across < 0) return {};
  }
  const auto [top, bottom] =
      std::minmax({occluder[0].y, occluder[1].y, occluder[2].y, occluder[3].y});
  return top <= v && v <= bottom ? width : HiddenWidth{};
}

}  // namespace tagsmith::detail
