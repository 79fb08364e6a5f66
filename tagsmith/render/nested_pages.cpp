// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/nested_pages.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {

// ---- Plates on a strip.

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

  // The highest place for a rectangle of this size, the leftmost of several; nothing when it is
  // wider than the strip.
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

// The parameters of a packing: plates before `change` stand in one way, the others in another.
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

// Ends with the first plate that does not fit.
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

// ---- Pages.

namespace {

// A plate's share of the page: itself and half the gap around it, which holds its crop marks.
double gap_of(double bleed) { return 2 * std::max(bleed, kPaperMarkGap + kPaperMarkLength); }

PlateSize room_of(const Rectangle& plate, double bleed) {
  const double gap = gap_of(bleed);
  return {plate.width + gap, plate.height + gap};
}

NestPlan plan_on(const Rectangle& plate, double width, double height, double bleed,
                 std::size_t plates, bool may_turn) {
  const Rectangle area = content_area(width, height);
  const PlateSize room = room_of(plate, bleed);
  const double most = area.width * area.height / (room.width * room.height) + 1;
  const auto count = static_cast<std::size_t>(std::min(most, static_cast<double>(plates)));
  return {width, height, pack_plates(room, count, area.width, area.height, may_turn).places,
          false, bleed,  0};
}

double page_height_of(const PlatePacking& packing) {
  const double least = kScaleBarLength + PaperBorder::kTop + PaperBorder::kBottom;
  return std::max(PaperBorder::kTop + packing.length + PaperBorder::kBottom, least);
}

// The plates on a piece of the roll.
PlatePacking pack_on_roll(const Rectangle& plate, std::size_t count, const NestPlan& plan) {
  const Rectangle area = content_area(plan.page_width, kLongestPage);
  return pack_plates(room_of(plate, plan.bleed), count, area.width, area.height, true);
}

// The tag in the room at this place, P on a whole dot. Turned, it stands on its left edge.
PageTag placed_tag(const NamedDrawing& tag, const PlatePlace& place, const NestPlan& plan) {
  const Rectangle area = content_area(plan.page_width, plan.page_height);
  const Rectangle& plate = tag.drawing.plate;
  const double left = area.x + place.x + gap_of(plan.bleed) / 2;
  const double top = area.y + place.y + gap_of(plan.bleed) / 2;
  const double p_right = place.turned ? -plate.y : -plate.x;  // of the plate's corner on the page
  const double p_down = place.turned ? plate.x + plate.width : -plate.y;
  const PlatePoint p{at_dot(left + p_right, plan.dots_per_inch),
                     at_dot(top + p_down, plan.dots_per_inch)};
  PageTag placed{tag.name, moved(tag.drawing, p.x, p.y)};
  if (place.turned) placed.turned_about = p;
  return placed;
}

std::string whole_mm(double metres) { return format_number(std::ceil(metres * 1000 - 1e-6)); }

}  // namespace

std::optional<NestPlan> plan_nest(const Rectangle& plate, const PrintPaper& paper, double bleed,
                                  int dots_per_inch, std::size_t plates) {
  NestPlan best;
  if (paper.roll()) {
    best = plan_on(plate, paper.width * paper.reach.right, kLongestPage * paper.reach.down, bleed,
                   std::min(plates, kMostNestedPlates), true);
    best.roll = true;
  } else {
    const auto attempt = [&](double width, double height, bool may_turn) {
      const bool lies = width > height;
      const PrinterScale reach = lies ? turned(paper.reach) : paper.reach;
      NestPlan plan = plan_on(plate, width * reach.right, height * reach.down, bleed,
                              kMostNestedPlates, may_turn);
      plan.lies = lies;
      if (best.places.empty() || plan.plates() > best.plates()) best = std::move(plan);
    };
    attempt(paper.width, paper.height, false);
    attempt(paper.height, paper.width, false);
    attempt(paper.width, paper.height, true);
  }
  if (best.places.empty()) return std::nullopt;
  best.dots_per_inch = dots_per_inch;
  return best;
}

std::string papers_for(const Rectangle& plate, double bleed, const PrinterScale& reach) {
  std::string text;
  for (PrintPaper paper : print_papers()) {
    paper.reach = reach;
    if (plan_nest(plate, paper, bleed, 0)) text += (text.empty() ? "" : ", ") + paper.name;
  }
  const PlateSize room = room_of(plate, bleed);
  const double across =
      std::min(room.width, room.height) + PaperBorder::kLeft + PaperBorder::kRight;
  return text + (text.empty() ? "" : " or ") + "a roll of " + whole_mm(across / reach.right) +
         " mm";
}

Page lay_out_nested(std::span<const NamedDrawing> tags, const PageNotes& notes,
                    const NestPlan& plan) {
  Page page;
  page.notes = notes;
  page.width =
      std::max(plan.page_width, kScaleBarLength + PaperBorder::kLeft + PaperBorder::kRight);
  page.height = plan.page_height;
  std::vector<PlatePlace> places = plan.places;
  if (plan.roll) {
    PlatePacking packing = pack_on_roll(tags.front().drawing.plate, tags.size(), plan);
    page.height = page_height_of(packing);
    places = std::move(packing.places);
  }
  for (std::size_t i = 0; i < std::min(tags.size(), places.size()); ++i) {
    page.tags.push_back(placed_tag(tags[i], places[i], plan));
    const PageTag& placed = page.tags.back();
    add_crop_marks(page, on_page(placed, placed.drawing.plate), kPaperMarkGap, kPaperMarkLength);
  }
  add_scale_bars(page, 0.007, page.height - 0.007);
  add_paper_notes(page, notes.title + "  \u00b7  " + notes.subject,
                  what_to_measure(tags.front().drawing),
                  page.width - PaperBorder::kLeft - PaperBorder::kRight);
  return page;
}

RollUse roll_use(const Rectangle& plate, const NestPlan& plan, std::size_t plates) {
  const auto length_of = [&](std::size_t count) {
    return count > 0 ? page_height_of(pack_on_roll(plate, count, plan)) : 0;
  };
  const std::size_t full = plates / plan.places.size();
  const double length = static_cast<double>(full) * length_of(plan.places.size()) +
                        length_of(plates % plan.places.size());
  return {length, length * plan.page_width,
          static_cast<double>(plates) * plate.width * plate.height};
}

}  // namespace tagsmith::detail
