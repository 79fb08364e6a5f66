// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/pack_plates.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace tagsmith::detail {
namespace {

constexpr double kPackRounding = 1e-9;

// The lower edge of what is already packed: level from each place to the next one's.
struct Step {
  double x = 0;
  double y = 0;
};

// The bottom-left heuristic on a skyline (Jylänki, A Thousand Ways to Pack the Bin, 2010, 2.2).
class Skyline {
 public:
  explicit Skyline(double width) : width_(width) {}

  // The highest place for a room of this size, the leftmost of several; nothing when it is wider
  // than the strip.
  std::optional<Step> find(const PlateSize& size) const {
    std::optional<Step> best;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const double right = steps_[i].x + size.width;
      if (right > width_ + kPackRounding) break;
      double y = 0;
      for (std::size_t j = i; j < steps_.size() && steps_[j].x < right - kPackRounding; ++j) {
        y = std::max(y, steps_[j].y);
      }
      if (!best || y < best->y - kPackRounding) best = Step{steps_[i].x, y};
    }
    return best;
  }

  void add(const Step& place, const PlateSize& size) {
    const double right = place.x + size.width;
    double level = 0;  // of the skyline right of the room
    std::vector<Step> steps;
    for (const Step& step : steps_) {
      if (step.x < right + kPackRounding) level = step.y;
      if (step.x < place.x - kPackRounding) steps.push_back(step);
    }
    steps.push_back({place.x, place.y + size.height});
    if (right < width_ - kPackRounding) steps.push_back({right, level});
    std::ranges::copy_if(steps_, std::back_inserter(steps),
                         [&](const Step& step) { return step.x > right + kPackRounding; });
    steps_ = std::move(steps);
  }

 private:
  double width_;
  std::vector<Step> steps_{{0, 0}};
};

PlateSize turned(const PlateSize& size) { return {size.height, size.width}; }

enum class Stand { as_it_is, turned, higher };  // higher: whichever ends higher on the strip

// How a packing comes about: plates before `change` stand in one way, the others in another.
struct Way {
  Stand first = Stand::as_it_is;
  Stand others = Stand::as_it_is;
  std::size_t change = 0;
};

struct Strip {
  double width = 0;
  double length = 0;
  bool may_turn = false;
};

// The room's place in this stand, or in the other where only that has room.
std::optional<PlatePlace> place_in(const Skyline& skyline, const PlateSize& size, Stand stand,
                                   bool may_turn) {
  std::optional<Step> as_it_is;
  std::optional<Step> on_side;
  if (stand != Stand::turned) as_it_is = skyline.find(size);
  if (may_turn && (stand != Stand::as_it_is || !as_it_is)) on_side = skyline.find(turned(size));
  if (!as_it_is && !on_side) as_it_is = skyline.find(size);
  if (!as_it_is && !on_side) return std::nullopt;
  const bool turn =
      !as_it_is || (on_side && on_side->y + size.width < as_it_is->y + size.height - kPackRounding);
  const Step& at = turn ? *on_side : *as_it_is;
  return PlatePlace{at.x, at.y, turn};
}

// Ends with the first plate that has no room.
PlatePacking pack(const PlateSize& plate, std::size_t count, const Strip& strip, const Way& way) {
  PlatePacking packing;
  Skyline skyline(strip.width);
  for (std::size_t i = 0; i < count; ++i) {
    const Stand stand = i < way.change ? way.first : way.others;
    const auto place = place_in(skyline, plate, stand, strip.may_turn);
    const PlateSize size = place && place->turned ? turned(plate) : plate;
    if (!place || place->y + size.height > strip.length + kPackRounding) return packing;
    packing.places.push_back(*place);
    packing.length = std::max(packing.length, place->y + size.height);
    skyline.add({place->x, place->y}, size);
  }
  return packing;
}

std::vector<Way> ways_to_pack(std::size_t plates, bool may_turn) {
  std::vector<Way> ways{{}};
  if (!may_turn) return ways;
  ways.push_back({Stand::turned, Stand::turned});
  ways.push_back({Stand::higher, Stand::higher});
  constexpr std::size_t kMostChanges = 100;
  const std::size_t step = plates / kMostChanges + 1;
  for (std::size_t change = step; change < plates; change += step) {
    ways.push_back({Stand::turned, Stand::as_it_is, change});
    ways.push_back({Stand::as_it_is, Stand::turned, change});
  }
  return ways;
}

bool better(const PlatePacking& a, const PlatePacking& b) {
  if (a.places.size() != b.places.size()) return a.places.size() > b.places.size();
  if (std::abs(a.length - b.length) > kPackRounding) return a.length < b.length;
  return std::ranges::count(a.places, true, &PlatePlace::turned) <
         std::ranges::count(b.places, true, &PlatePlace::turned);
}

}  // namespace

PlatePacking pack_plates(const PlateSize& plate, std::size_t count, double width, double length,
                         bool may_turn) {
  PlatePacking best;
  for (const Way& way : ways_to_pack(count, may_turn)) {
    PlatePacking packing = pack(plate, count, {width, length, may_turn}, way);
    if (better(packing, best)) best = std::move(packing);
  }
  return best;
}

}  // namespace tagsmith::detail
