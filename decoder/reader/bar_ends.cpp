// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/line_levels.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kWindows = 8;  // of the symbol, side by side
constexpr std::size_t kMost = kWindows / 2 + 1;
constexpr std::size_t kInWindow = 24;  // places: two a module
constexpr double kHalfShown = 0.5;     // of the bars' contrast: the end of a blurred bar

// Light (0-1) at the places of one window along the symbol.
using WindowLight = std::array<float, kInWindow>;

// A row of a window; in shadow, as shares of its own white.
struct WindowRow {
  WindowLight light{};
  float white = 1;  // light of what is 1
};

// The window's bars as light less its mean, and their levels.
struct Pattern {
  WindowLight bars{};
  float power = 0;  // sum of squares
  float white = 0;  // mean of the brighter places, of the darker ones
  float black = 0;
};

// The median of an odd number of rows at every place: a sort that exchanges neighbours, of all
// places at once.
template <std::size_t kRows>
WindowLight median_of(std::array<WindowLight, kRows> rows) {
  for (std::size_t round = 0; round < kRows; ++round) {
    for (std::size_t i = round % 2; i + 1 < kRows; i += 2) {
      for (std::size_t k = 0; k < kInWindow; ++k) {
        const float low = std::min(rows[i][k], rows[i + 1][k]);
        rows[i + 1][k] = std::max(rows[i][k], rows[i + 1][k]);
        rows[i][k] = low;
      }
    }
  }
  return rows[kRows / 2];
}

class Symbol {
 public:
  Symbol(const GrayView& image, const BarField& field)
      : tone_(ToneCurve::of(image)),
        image_(image),
        field_(field),
        image_from_unit_(field.corners, field.lens) {}

  // The places are evenly spaced between a window's ends: perspective and the lens displace them by
  // the same distance in all rows of the window.
  WindowRow row(std::size_t window, double v) const {
    const double width = (field_.last - field_.first) / kWindows;
    const double u = field_.first + static_cast<double>(window) * width;
    const PixelPoint begin = image_from_unit_(u, v), end = image_from_unit_(u + width, v);
    const PixelPoint step = (1.0 / kInWindow) * (end - begin);
    std::array<double, kInWindow> levels;
    sample_line(image_, {begin + 0.5 * step, step}, levels);
    WindowRow row;
    std::ranges::transform(levels, row.light.begin(),
                           [&](double level) { return tone_.light_near(level); });
    if (field_.in_shadow) even_out(row);
    return row;
  }

  float light(double u, double v) const {
    return tone_.light_near(sample_bilinear(image_, image_from_unit_(u, v)));
  }

  double middle_of(std::size_t window) const {
    return field_.first +
           (field_.last - field_.first) * (static_cast<double>(window) + 0.5) / kWindows;
  }

  // The bars around the middle of their height: the median of some rows at every place.
  Pattern pattern(std::size_t window) const {
    constexpr std::size_t rows = kBarEnds.rows;
    std::array<WindowLight, rows> seen;
    for (std::size_t i = 0; i < rows; ++i) {
      const double share = 0.15 + 0.7 * (static_cast<double>(i) + 0.5) / static_cast<double>(rows);
      seen[i] = row(window, field_.top + share * (field_.bottom - field_.top)).light;
    }
    Pattern pattern{.bars = median_of(seen)};
    float mean = 0;
    for (const float value : pattern.bars) mean += value / kInWindow;
    float bright = 0, dark = 0;
    for (float& value : pattern.bars) {
      value -= mean;
      pattern.power += value * value;
      (value > 0 ? pattern.white : pattern.black) += value;
      (value > 0 ? bright : dark) += 1;
    }
    pattern.white = mean + pattern.white / std::max(bright, 1.0F);
    pattern.black = mean + pattern.black / std::max(dark, 1.0F);
    return pattern;
  }

  // Pixels from (u, v) to (u, v + dv), per unit of v.
  double pixels_per_v(double u, double v) const {
    constexpr double kStep = 0.01;
    return distance(image_from_unit_(u, v - kStep), image_from_unit_(u, v + kStep)) / (2 * kStep);
  }

 private:
  // At least a third of the window is white, both amid the bars and beyond them.
  static void even_out(WindowRow& row) {
    WindowLight ordered = row.light;
    std::ranges::nth_element(ordered, ordered.end() - kInWindow / 6);
    row.white = std::max(*(ordered.end() - kInWindow / 6), 1e-3F);
    for (float& light : row.light) light /= row.white;
  }

  // In light a blurred end is where half of the contrast is left; in grey levels it is not.
  const ToneCurve& tone_;
  GrayView image_;
  BarField field_;
  FrameHomography image_from_unit_;
};

// How much of the bars' contrast a row shows.
float share_of(const Pattern& pattern, const WindowRow& row) {
  float sum = 0;
  for (std::size_t k = 0; k < kInWindow; ++k) sum += pattern.bars[k] * row.light[k];
  return sum / pattern.power;
}

// Light of a row between the bars' black (0) and white (1), as they are where white has this light.
float level_of(const Pattern& pattern, const WindowRow& row, float white) {
  float mean = 0;
  for (const float value : row.light) mean += value / kInWindow;
  return (mean * row.white / white - pattern.black) / (pattern.white - pattern.black);
}

bool has_contrast(const Pattern& pattern) { return pattern.white > pattern.black; }

// Between two rows that both show the bars, so close together, too few rows can be white for an
// end.
constexpr int kAtOnce = static_cast<int>(kBarEnds.beyond_px) + 1;

// The rows of a window at steps from some height on. Those that were last looked at are kept: the
// row so many steps ahead is looked at again in its turn.
class SeenRows {
 public:
  struct Seen {
    WindowRow row;
    double share = 0;  // of the bars' contrast
  };

  SeenRows(const Symbol& symbol, const Pattern& pattern, std::size_t window, double from,
           double step)
      : symbol_(symbol), pattern_(pattern), window_(window), from_(from), step_(step) {
    numbers_.fill(-1);
  }

  const Seen& at(int k) {
    const auto place = static_cast<std::size_t>(k % (kAtOnce + 1));
    if (std::exchange(numbers_[place], k) != k) {
      Seen& seen = kept_[place];
      seen.row = symbol_.row(window_, from_ + k * step_);
      seen.share = static_cast<double>(share_of(pattern_, seen.row));
    }
    return kept_[place];
  }

 private:
  const Symbol& symbol_;
  const Pattern& pattern_;
  std::size_t window_;
  double from_, step_;
  std::array<int, kAtOnce + 1> numbers_;
  std::array<Seen, kAtOnce + 1> kept_;
};

// Where a window's bars end between two heights; nothing where no end is visible.
std::optional<double> end_in_window(const Symbol& symbol, const Pattern& pattern,
                                    std::size_t window, double from, double to) {
  const double u = symbol.middle_of(window);
  const double pixels = std::abs(to - from) * symbol.pixels_per_v(u, (from + to) / 2);
  const int steps = std::clamp(static_cast<int>(pixels), 4, 400);
  const double step = (to - from) / steps;
  const double step_px = pixels / steps;
  SeenRows rows(symbol, pattern, window, from, step);
  std::optional<double> end;
  double before = 0;
  float white = 1;  // of the last row in which the bars show
  double white_px = 0;
  for (int k = 0; k <= steps; ++k) {
    while (rows.at(k).share >= kHalfShown && k + kAtOnce <= steps &&
           rows.at(k + kAtOnce).share >= kHalfShown) {
      k += kAtOnce;
    }
    const auto& [row, share] = rows.at(k);
    if (share >= kHalfShown) {
      end.reset();
      white = row.white;
      white_px = 0;
    } else if (k > 0 && before >= kHalfShown) {
      end = from + k * step - step * (kHalfShown - share) / (before - share);
    }
    const float level = level_of(pattern, row, white);
    // Something dark in front cuts the bars off before they end.
    if (end && level < kBarEnds.dark) return std::nullopt;
    if (end && share < static_cast<double>(kBarEnds.dark) && level > kHalfShown) {
      white_px += step_px;
      if (white_px >= kBarEnds.beyond_px) return end;
    }
    before = share;
  }
  return std::nullopt;
}

struct WindowEnd {
  double u = 0;
  double v = 0;
};

// The line that most of the ends are near, fitted to these.
// Why: docs/decisions/0004-covered-tags.md.
std::optional<BarEnds> line_through(const std::vector<WindowEnd>& ends, double pixels_per_v) {
  constexpr std::size_t kLeast = kWindows / 2;
  std::vector<WindowEnd> best;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = i + 1; j < ends.size(); ++j) {
      const double slope = (ends[j].v - ends[i].v) / (ends[j].u - ends[i].u);
      std::vector<WindowEnd> near;
      for (const WindowEnd& end : ends) {
        const double off = end.v - ends[i].v - slope * (end.u - ends[i].u);
        if (std::abs(off) * pixels_per_v < kSide.tolerance) near.push_back(end);
      }
      if (near.size() > best.size()) best = std::move(near);
    }
  }
  if (best.size() < kLeast) return std::nullopt;
  const auto count = static_cast<double>(best.size());
  double u = 0, v = 0, uu = 0, uv = 0;
  for (const WindowEnd& end : best) {
    u += end.u / count;
    v += end.v / count;
  }
  for (const WindowEnd& end : best) {
    uu += (end.u - u) * (end.u - u);
    uv += (end.u - u) * (end.v - v);
  }
  const double slope = uv / uu;
  double squares = 0;
  for (const WindowEnd& end : best) squares += std::pow(end.v - v - slope * (end.u - u), 2);
  // The error that neighbouring windows have in common is added to their scatter.
  const double variance = squares / std::max(1.0, count - 2);
  const double reach = std::max(u, 1 - u);
  const double at_ends = variance * (1 / count + reach * reach / uu) * pixels_per_v * pixels_per_v;
  return BarEnds{v - slope * u, v + slope * (1 - u),
                 std::sqrt(at_ends + kBarEnds.systematic_px * kBarEnds.systematic_px)};
}

// The pattern of each window.
using Patterns = std::array<Pattern, kWindows>;

Patterns patterns_of(const Symbol& symbol) {
  Patterns patterns;
  for (std::size_t window = 0; window < kWindows; ++window) {
    patterns[window] = symbol.pattern(window);
  }
  return patterns;
}

std::optional<BarEnds> ends_between(const Symbol& symbol, const Patterns& patterns, double from,
                                    double to) {
  std::vector<WindowEnd> ends;
  for (std::size_t window = 0; window < kWindows; ++window) {
    if (!has_contrast(patterns[window])) continue;
    const auto end = end_in_window(symbol, patterns[window], window, from, to);
    if (end) ends.push_back({symbol.middle_of(window), *end});
  }
  return line_through(ends, symbol.pixels_per_v(0.5, (from + to) / 2));
}

// How much farther outwards a window's bars fade from half of their contrast to a sixth than they
// do from five sixths to half, pixels; nothing where they do not fade out at their end.
std::optional<double> fading(const Symbol& symbol, const Pattern& pattern, std::size_t window,
                             double end, double v_per_px, int reach_px) {
  std::array<double, 3> places{};
  std::size_t found = 0;
  const auto sought = [&] { return (2.0 * static_cast<double>(found) + 1) / 6; };
  double before = 0;
  for (int k = -reach_px; k <= reach_px && found < places.size(); ++k) {
    const double lost =
        1 - static_cast<double>(share_of(pattern, symbol.row(window, end + k * v_per_px)));
    if (k == -reach_px && lost > sought()) return std::nullopt;
    for (; found < places.size() && lost >= sought(); ++found) {
      places[found] = k - (lost - sought()) / (lost - before);
    }
    before = lost;
  }
  if (found < places.size()) return std::nullopt;
  return places[0] + places[2] - 2 * places[1];
}

}  // namespace

BarField bar_field(const Quad& corners, const SymbolLayout& layout, const LensDistortion& lens,
                   bool in_shadow) {
  const double first = layout.width_share(0);
  return {corners, first, 1 - first, layout.bars_top, layout.bars_bottom, lens, in_shadow};
}

std::optional<BarEnds> find_bar_ends(const GrayView& image, const BarField& field, double from,
                                     double to) {
  const Symbol symbol(image, field);
  return ends_between(symbol, patterns_of(symbol), from, to);
}

BothEnds find_both_ends(const GrayView& image, const BarField& field) {
  const Symbol symbol(image, field);
  const Patterns patterns = patterns_of(symbol);
  const auto end = [&](double v, double outwards) {
    return ends_between(symbol, patterns, v - outwards * kBarEnds.inside,
                        v + outwards * kBarEnds.outside);
  };
  return {field, end(field.top, -1), end(field.bottom, 1)};
}

std::optional<Lopsidedness> lopsidedness_along_bars(const GrayView& image, const BothEnds& ends,
                                                    double blur_px) {
  const Symbol symbol(image, ends.field);
  const Patterns patterns = patterns_of(symbol);
  const int reach_px = static_cast<int>(std::ceil(5 * blur_px));
  // What is the same outwards above and below, such as sharpening, is no displacement and is left
  // in the scatter.
  std::vector<double> downwards;
  for (const auto& [line, outwards] : {std::pair{ends.upper, -1}, std::pair{ends.lower, 1}}) {
    for (std::size_t window = 0; line && window < kWindows; ++window) {
      if (!has_contrast(patterns[window])) continue;
      const double u = symbol.middle_of(window), end = line->at(u);
      const auto here = fading(symbol, patterns[window], window, end,
                               outwards / symbol.pixels_per_v(u, end), reach_px);
      if (here) downwards.push_back(outwards * *here);
    }
  }
  if (downwards.size() < kWindows) return std::nullopt;
  const auto count = static_cast<double>(downwards.size());
  double sum = 0, squares = 0;
  for (const double px : downwards) sum += px;
  for (const double px : downwards) squares += std::pow(px - sum / count, 2);
  return Lopsidedness{sum / count, std::sqrt(squares / (count * (count - 1)))};
}

double ends_tolerance_px(const Quad& corners) {
  return kBarEnds.tolerance_px + 2 * kBarEnds.layout * height_of(corners);
}

bool bars_end_near(const GrayView& image, const BarField& field) {
  const Symbol symbol(image, field);
  const double near = std::max(1.5, ends_tolerance_px(field.corners)) / height_of(field.corners);
  std::size_t above = 0, below = 0;
  for (std::size_t window = 0; window < kWindows; ++window) {
    const Pattern pattern = symbol.pattern(window);
    if (!has_contrast(pattern)) continue;
    const auto shown = [&](double v) {
      return static_cast<double>(share_of(pattern, symbol.row(window, v))) > kHalfShown;
    };
    above += shown(field.top + near) && !shown(field.top - near) ? 1U : 0U;
    below += shown(field.bottom - near) && !shown(field.bottom + near) ? 1U : 0U;
  }
  return above >= kMost && below >= kMost;
}

namespace {

// By how much ends that were seen in a field lie off a height in a frame, pixels.
double missed_px(const BarField& field, const BarEnds& ends, const Quad& frame, double v) {
  const FrameHomography seen(field.corners, field.lens);
  const FrameHomography expected(frame, field.lens);
  const PixelPoint left = seen(0, ends.at_left), right = seen(1, ends.at_right);
  const auto miss = [&](PixelPoint at) { return std::abs(expected.unit_of(at).y - v); };
  return std::max(miss(left), miss(right)) * height_of(frame);
}

// Whether something dark lies along a side between where the bars end and v = `side`: it is the
// frame's own stroke, and that side is not its inner edge.
bool is_stroke_between(const Symbol& symbol, const BarEnds& ends, double side) {
  std::size_t dark = 0;
  for (std::size_t window = 0; window < kWindows; ++window) {
    const Pattern pattern = symbol.pattern(window);
    if (!has_contrast(pattern)) continue;
    const double u = symbol.middle_of(window);
    const double end = ends.at(u);
    const double pixels = std::abs(side - end) * symbol.pixels_per_v(u, (side + end) / 2);
    const float white = symbol.row(window, end).white;
    const int steps = static_cast<int>(pixels);
    const int margin = static_cast<int>(kBarEnds.beyond_px);
    for (int k = margin; k < steps - margin; ++k) {
      const double v = end + (side - end) * k / steps;
      if (static_cast<double>(level_of(pattern, symbol.row(window, v), white)) > kHalfShown)
        continue;
      ++dark;
      break;
    }
  }
  return dark >= kMost;
}

// Whether the frame's own stroke shows at its upper (0) or lower (2) side, or so much of the
// frame's height beyond: along most of it dark, with white on both sides, as thick as the layout
// has it, and white beside one of its ends at least. Other edges have something else behind, and
// stripes of light and shade go on.
bool shows_stroke(const Symbol& symbol, const SymbolLayout& layout, std::size_t side,
                  double beyond = 0) {
  const double outward = side == 0 ? -1 : 1;
  const double edge = (side == 0 ? 0 : 1) + outward * beyond;
  const double stroke = layout.frame.stroke / layout.frame.height;
  const auto light = [&](double u, double out) { return symbol.light(u, edge + outward * out); };
  std::size_t shown = 0;
  float least_white = 1;
  for (std::size_t window = 0; window < kWindows; ++window) {
    const double u = symbol.middle_of(window);
    const float white = std::min(light(u, -0.3 * layout.bars_top), light(u, 1.6 * stroke));
    if (light(u, stroke / 2) >= kHalfShown * white) continue;
    ++shown;
    least_white = std::min(least_white, white);
  }
  const double beside = 1.6 * layout.frame.stroke / layout.frame.length;
  const float at_ends = std::max(light(-beside, stroke / 2), light(1 + beside, stroke / 2));
  return shown >= kMost && at_ends > kHalfShown * least_white;
}

}  // namespace

FrameByEnds frame_by_ends(const Quad& corners, std::size_t side, const BarField& field,
                          const BarEnds& ends, const SymbolLayout& layout) {
  const double v = side == 0 ? layout.bars_top : layout.bars_bottom;
  const FrameHomography image_from_field(field.corners, field.lens);
  const PixelPoint left = image_from_field(0, ends.at_left);
  const PixelPoint right = image_from_field(1, ends.at_right);
  Quad shown = corners;
  (side == 0 ? shown[0] : shown[3]) = left;
  (side == 0 ? shown[1] : shown[2]) = right;
  // `shown` spans v to 1 of the plate, or 0 to v.
  const FrameHomography image_from_shown(shown, field.lens);
  Quad completed = corners;
  if (side == 0) {
    completed[0] = image_from_shown(0, -v / (1 - v));
    completed[1] = image_from_shown(1, -v / (1 - v));
  } else {
    completed[2] = image_from_shown(1, 1 / v);
    completed[3] = image_from_shown(0, 1 / v);
  }
  const double seen_share = side == 0 ? 1 - v : v;
  return {completed,
          std::hypot(ends.sigma_px / seen_share, kBarEnds.layout * height_of(completed))};
}

std::optional<double> off_bar_ends(const BothEnds& ends, std::size_t side, const Quad& corners,
                                   const SymbolLayout& layout) {
  const auto& seen = side == 0 ? ends.upper : ends.lower;
  if (!seen) return std::nullopt;
  const double v = side == 0 ? layout.bars_top : layout.bars_bottom;
  return missed_px(ends.field, *seen, corners, v);
}

EndsVerdict judge_by_bar_ends(const GrayView& image, const BothEnds& ends, const Quad& corners,
                              const SymbolLayout& layout) {
  const auto& [seen_in, upper, lower] = ends;
  const double tolerance = ends_tolerance_px(corners);
  const auto off = [&](const std::optional<BarEnds>& end, double v) {
    return end && missed_px(seen_in, *end, corners, v) > tolerance + 3 * end->sigma_px;
  };
  const bool upper_off = off(upper, layout.bars_top);
  const bool lower_off = off(lower, layout.bars_bottom);
  const BarField field = bar_field(corners, layout, seen_in.lens, seen_in.in_shadow);
  const bool both_suit = upper && lower && !upper_off && !lower_off;
  if (both_suit || bars_end_near(image, field)) return {EndsVerdict::suited, corners, 0, 0};
  const Symbol symbol(image, field);
  if (!upper && !shows_stroke(symbol, layout, 0)) return {EndsVerdict::odd, corners, 0, 0};
  if (!lower && !shows_stroke(symbol, layout, 2)) return {EndsVerdict::odd, corners, 0, 0};
  if (!upper_off && !lower_off) return {EndsVerdict::suited, corners, 0, 0};
  if (!upper || !lower) return {EndsVerdict::odd, corners, 0, 0};
  std::optional<EndsVerdict> found;
  for (const std::size_t side : {0U, 2U}) {
    const BarEnds& own = side == 0 ? *upper : *lower;
    const BarEnds& other = side == 0 ? *lower : *upper;
    const double v = side == 0 ? layout.bars_top : layout.bars_bottom;
    const auto [completed, sigma] = frame_by_ends(corners, side, seen_in, own, layout);
    if (!is_convex(completed)) continue;
    const double miss =
        missed_px(seen_in, other, completed, layout.bars_top + layout.bars_bottom - v);
    if (miss > tolerance + 3 * other.sigma_px) continue;
    // Something crosses the bars; these are not their ends.
    if (shows_stroke(symbol, layout, side)) return {EndsVerdict::odd, corners, 0, 0};
    // Where both may be the case, neither is certain.
    if (found) return {EndsVerdict::odd, corners, 0, 0};
    found = {EndsVerdict::hidden, completed, side, sigma};
  }
  if (found) return *found;
  const double middle = (upper->at(0.5) + lower->at(0.5)) / 2;
  // As far off above as below: another layout's frame, unless its own stroke lies within.
  const bool even =
      std::abs(middle - (layout.bars_top + layout.bars_bottom) / 2) * height_of(corners) <
          tolerance &&
      !is_stroke_between(symbol, *upper, 0) && !is_stroke_between(symbol, *lower, 1);
  return {even ? EndsVerdict::other_layout : EndsVerdict::odd, corners, 0, 0};
}

bool is_stroke_beyond(const GrayView& image, const BarField& field, const SymbolLayout& layout,
                      std::size_t side) {
  const Symbol symbol(image, field);
  const double stroke = layout.frame.stroke / layout.frame.height;
  const int steps = static_cast<int>(std::ceil(4 * kBarEnds.outside / stroke));
  for (int k = 2; k < steps; ++k) {
    if (shows_stroke(symbol, layout, side, k * stroke / 4)) return true;
  }
  return false;
}

}  // namespace tagsmith::detail
