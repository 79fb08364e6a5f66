// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/frame_around.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/line_levels.hpp"

namespace tagsmith::detail {
namespace {

// A fall from white to dark on a scan line, in a block's coordinates.
struct Fall {
  double at = 0;   // along the side looked for
  double out = 0;  // outwards
};

// How many steps from `start` stay inside the image and clear of its last row and column, at most
// `count`.
int steps_inside(const GrayView& image, PixelPoint start, PixelPoint step, int count) {
  double most = count;
  const auto limit = [&](double at, double by, double end) {
    if (at < 0 || at > end) most = 0;
    if (by > 0) most = std::min(most, (end - at) / by);
    if (by < 0) most = std::min(most, at / -by);
  };
  limit(start.x, step.x, image.width - 1.001);
  limit(start.y, step.y, image.height - 1.001);
  return static_cast<int>(most);
}

// Adds where a scan line falls from white to dark: local maxima, not much less than the strongest.
// `step` is one pixel of the scan line, which ends at the border of the image;
// `levels` is room that is used again.
template <class ToFall>
void add_falls(const GrayView& image, PixelPoint start, PixelPoint step, int count,
               const ToFall& to_fall, std::vector<float>& levels, std::vector<Fall>& falls) {
  const int inside = steps_inside(image, start, step, count - 1);
  if (inside < 3) return;
  levels.resize(static_cast<std::size_t>(inside) + 1);
  sample_line_inside(image, {start, step}, levels);
  const auto drop_at = [&](std::size_t i) { return levels[i - 1] - levels[i + 1]; };
  for (std::size_t i = 1; i + 2 < levels.size(); ++i) {
    const float drop = drop_at(i);
    if (drop < static_cast<float>(kSide.least_fall) || (i > 1 && drop_at(i - 1) > drop) ||
        drop_at(i + 1) >= drop) {
      continue;
    }
    falls.push_back(to_fall(start + static_cast<double>(i) * step));
  }
}

// The number of falls on a line for so many slopes and distances, ordered by distance.
class LineVotes {
 public:
  LineVotes(std::size_t slopes, std::size_t distances)
      : distances_(distances), votes_(slopes * distances), most_(distances) {}

  int* of_slope(std::size_t k) { return votes_.data() + k * distances_; }
  int at(std::size_t k, std::size_t distance) const { return votes_[k * distances_ + distance]; }

  // Takes a distance's votes together with the next one's, for all slopes.
  void join_neighbours() {
    for (auto votes = votes_.begin(); votes != votes_.end();
         votes += static_cast<std::ptrdiff_t>(distances_)) {
      int* __restrict most = most_.data();
      for (std::size_t i = 0; i + 1 < distances_; ++i) {
        const auto at = static_cast<std::ptrdiff_t>(i);
        votes[at] += votes[at + 1];
        most[i] = std::max(most[i], votes[at]);
      }
    }
  }

  // The greatest number of votes of a distance, and of all.
  int most_at(std::size_t distance) const { return most_[distance]; }
  int most() const { return *std::ranges::max_element(most_); }

 private:
  std::size_t distances_;
  std::vector<int> votes_;
  std::vector<int> most_;
};

struct Line {
  double out = 0;    // where at = 0
  double slope = 0;  // pixels outwards a pixel along
};

// The straight lines on which enough of the scan lines have a fall, and not many fewer than on the
// most visible line, nearest first (Hough transform over slope and distance).
std::vector<Line> lines_of(const std::vector<Fall>& falls, double reach, std::size_t most) {
  const auto apart = static_cast<std::size_t>(kEdgeFit.thin_stroke);
  const auto bins = static_cast<std::size_t>(reach + 3);
  const auto slope_of = [](std::size_t k) {
    return kFrameAround.most_slope * (static_cast<double>(k) - kFrameAround.scan_lines) /
           kFrameAround.scan_lines;
  };
  const double least_shown = kSide.least_shown * kFrameAround.scan_lines;
  if (static_cast<double>(falls.size()) < least_shown) return {};
  constexpr std::size_t kAllSlopes = 2 * kFrameAround.scan_lines + 1;
  LineVotes votes(kAllSlopes, bins);
  for (std::size_t k = 0; k < kAllSlopes; ++k) {
    int* bin = votes.of_slope(k);
    const double slope = slope_of(k);
    for (const Fall& fall : falls) {
      const double out = fall.out - slope * fall.at;
      if (out >= 0 && out < static_cast<double>(bins)) ++bin[static_cast<std::size_t>(out)];
    }
  }
  votes.join_neighbours();
  const double least = std::max(least_shown, kFrameAround.of_best * votes.most());
  std::vector<Line> lines;
  for (std::size_t i = 0; i + 1 < bins && lines.size() < most; ++i) {
    if (votes.most_at(i) < least) continue;
    // Neighbouring slopes and distances share the line; the one with the most votes is taken.
    Line line;
    int votes_of_line = 0;
    std::size_t at = i;
    for (std::size_t near = i; near < std::min(i + apart, bins - 1); ++near) {
      for (std::size_t k = 0; k < kAllSlopes; ++k) {
        if (votes.at(k, near) <= votes_of_line) continue;
        votes_of_line = votes.at(k, near);
        line = {static_cast<double>(near) + 1, slope_of(k)};
        at = near;
      }
    }
    lines.push_back(line);
    i = at + apart;
  }
  return lines;
}

std::optional<Line> nearest_line(const std::vector<Fall>& falls, double reach) {
  const std::vector<Line> lines = lines_of(falls, reach, 1);
  return lines.empty() ? std::nullopt : std::optional(lines.front());
}

double reach_at_ends(const BarRegion& block) { return kFrameAround.beyond * block.height; }

// The frame's side beyond the ends of the bars, upwards (-1) or downwards (1): along the bars there
// is no other edge on the way.
std::vector<Fall> falls_at_ends(const GrayView& image, const BarRegion& block, double direction) {
  const double reach = reach_at_ends(block);
  const PixelPoint step = direction * block.along();
  std::vector<Fall> falls;
  std::vector<float> levels;
  for (int k = 0; k < kFrameAround.scan_lines; ++k) {
    const double at = 0.35 * block.length * (2.0 * k / (kFrameAround.scan_lines - 1) - 1);
    const PixelPoint start = block.centre + at * block.across;
    const auto to_fall = [&](PixelPoint point) {
      return Fall{at, dot(point - block.centre, step)};
    };
    add_falls(image, start, step, static_cast<int>(reach), to_fall, levels, falls);
  }
  return falls;
}

std::optional<Line> side_at_ends(const GrayView& image, const BarRegion& block, double direction) {
  return nearest_line(falls_at_ends(image, block, direction), reach_at_ends(block));
}

// The frame's side to the left (-1) or right (1) of the bars, by scan lines between the bars' ends
// and the frame's upper and lower sides.
std::optional<Line> side_beside(const GrayView& image, const BarRegion& block, const Line& upper,
                                const Line& lower, double direction) {
  const double reach = kFrameAround.beyond * block.length;
  const PixelPoint outward = direction * block.across;
  std::vector<Fall> falls;
  std::vector<float> levels;
  for (int k = 0; k < kFrameAround.scan_lines; ++k) {
    const int pair = k / 2, last_pair = kFrameAround.scan_lines / 2 - 1;
    const double share = 0.03 + 0.1 * pair / last_pair;
    const double v = k % 2 == 0 ? share : 1 - share;
    // Between the lines -upper.out + -upper.slope * at and lower.out + lower.slope * at.
    const double middle = (1 - v) * -upper.out + v * lower.out;
    const double slope = (1 - v) * -upper.slope + v * lower.slope;
    const PixelPoint start = block.centre + middle * block.along();
    const PixelPoint run = block.across + slope * block.along();
    const PixelPoint step = direction / length(run) * run;
    const auto to_fall = [&](PixelPoint point) {
      return Fall{dot(point - block.centre, block.along()), dot(point - block.centre, outward)};
    };
    add_falls(image, start, step, static_cast<int>(reach), to_fall, levels, falls);
  }
  return nearest_line(falls, reach);
}

// A line's points at both ends, from `begin` to `end` along the side.
SideLine side_line(const BarRegion& block, PixelPoint axis, PixelPoint outward, const Line& line,
                   double begin, double end) {
  const auto point = [&](double at) {
    return block.centre + at * axis + (line.out + line.slope * at) * outward;
  };
  return line_through(point(begin), point(end));
}

// How much more the bars show inside the frame than in its white margin above and below them, grey
// levels; the less, the worse the upper and lower sides suit.
double shown_between(const GrayView& image, const Quad& quad) {
  constexpr int kPlaces = 60;
  const Homography map = homography_to(quad);
  const auto change = [&](double v) {
    double sum = 0, before = 0;
    for (int k = 0; k < kPlaces; ++k) {
      const double value = sample_bilinear(image, map(0.12 + 0.76 * k / (kPlaces - 1), v));
      if (k > 0) sum += std::abs(value - before);
      before = value;
    }
    return sum / (kPlaces - 1);
  };
  const double bars = std::min(change(0.22), change(0.78));
  const double margins =
      std::max(std::max(change(0.05), change(0.11)), std::max(change(0.89), change(0.95)));
  return bars - margins;
}

}  // namespace

std::optional<Quad> frame_between(const GrayView& image, const BarRegion& block,
                                  const SideLine& left, const SideLine& right) {
  const double reach = reach_at_ends(block);
  const auto lines = [&](double direction) {
    return lines_of(falls_at_ends(image, block, direction), reach, kFrameAround.most_lines);
  };
  const double width = block.length / 2;
  const std::vector<Line> lowers = lines(1);
  std::optional<Quad> best;
  double most_shown = 0;
  for (const Line& upper : lines(-1)) {
    for (const Line& lower : lowers) {
      const auto quad = corners_of(
          {side_line(block, block.across, -1.0 * block.along(), upper, -width, width), right,
           side_line(block, block.across, block.along(), lower, width, -width), left});
      if (!quad) continue;
      const double shown = shown_between(image, *quad);
      if (best && shown <= most_shown) continue;
      best = quad;
      most_shown = shown;
    }
  }
  return best;
}

std::optional<Quad> frame_around(const GrayView& image, const BarRegion& block) {
  const auto upper = side_at_ends(image, block, -1);
  if (!upper) return std::nullopt;
  const auto lower = side_at_ends(image, block, 1);
  if (!lower) return std::nullopt;
  const auto left = side_beside(image, block, *upper, *lower, -1);
  if (!left) return std::nullopt;
  const auto right = side_beside(image, block, *upper, *lower, 1);
  if (!right) return std::nullopt;
  const double width = block.length / 2;
  const double height = block.height / 2;
  const PixelPoint across = block.across;
  const PixelPoint along = block.along();
  return corners_of({side_line(block, across, -1.0 * along, *upper, -width, width),
                     side_line(block, along, across, *right, -height, height),
                     side_line(block, across, along, *lower, width, -width),
                     side_line(block, along, -1.0 * across, *left, height, -height)});
}

}  // namespace tagsmith::detail
