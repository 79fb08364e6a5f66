// SPDX-License-Identifier: Apache-2.0
// Plates on papers: which carry them, nested and in tiles.
#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include <doctest/doctest.h>

#include "tagsmith/render/nested_pages.hpp"
#include "tagsmith/render/tiled_pages.hpp"
#include "tests/render/sample_survey.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

TagDrawing drawing_of(const TagTemplate& tag) {
  return draw_tag(tag, *parse_digits("019012340400"), {{"000L left", "corridor"}});
}

PrintPaper paper(const char* name) { return parse_print_paper(name).value(); }

// Every point of the plate, in steps, lies in some tile's window.
bool cover_the_plate(const std::vector<Page>& pages) {
  for (double right = 0; right <= 1; right += 0.05) {
    for (double down = 0; down <= 1; down += 0.05) {
      const bool shown = std::ranges::any_of(pages, [&](const Page& page) {
        const PageTag& tag = page.tags.front();
        if (!tag.window) return false;
        const double x = tag.drawing.plate.x + right * tag.drawing.plate.width - tag.window->x;
        const double y = tag.drawing.plate.y + down * tag.drawing.plate.height - tag.window->y;
        return x >= 0 && y >= 0 && x <= tag.window->width && y <= tag.window->height;
      });
      if (!shown) return false;
    }
  }
  return true;
}

std::vector<Rectangle> rooms_of(const PlateSize& plate, const PlatePacking& packing) {
  std::vector<Rectangle> rooms;
  for (const auto& [x, y, turned] : packing.places) {
    rooms.push_back(
        {x, y, turned ? plate.height : plate.width, turned ? plate.width : plate.height});
  }
  return rooms;
}

bool overlap_visibly(const Rectangle& a, const Rectangle& b) {
  constexpr double kRounding = 1e-6;
  return std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x) > kRounding &&
         std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y) > kRounding;
}

constexpr double kLongestStrip = 1e9;

// Each room lies on the strip, and over no other.
void check_apart(const std::vector<Rectangle>& rooms, double width, double length) {
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    const Rectangle& room = rooms[i];
    const bool inside = room.x >= 0 && room.y >= 0 && room.x + room.width < width + 1e-6 &&
                        room.y + room.height < length + 1e-6;
    CHECK(inside);
    CHECK(std::ranges::none_of(std::span(rooms).first(i), [&](const Rectangle& other) {
      return overlap_visibly(room, other);
    }));
  }
}

}  // namespace

TEST_CASE("papers are named, given in millimetres, or rolls") {
  CHECK(paper("a4").width == Approx(0.210));
  CHECK(paper("TABLOID").height == Approx(0.4318));
  CHECK(paper("700x500").width == Approx(0.5));
  CHECK(paper("roll:914").roll());
  for (const char* wrong : {"A9", "", "x", "210x", "50x50", "roll:", "roll:60", "9000x9000",
                            "nanxnan", "1e999x5", "210x297x1"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_print_paper(wrong));
  }
}

TEST_CASE("as many plates a page as the paper holds, none over another or beyond the borders") {
  const TagDrawing tag = drawing_of(small_template());
  for (const char* name : {"A2", "A1", "A0", "roll:914", "roll:400"}) {
    CAPTURE(name);
    const std::optional<NestPlan> plan = plan_nest(tag.plate, paper(name), 0.003, 0);
    REQUIRE(plan);
    const std::vector<NamedDrawing> tags(static_cast<std::size_t>(plan->plates()), {"000L", tag});
    const Page page = lay_out_nested(tags, {}, *plan);
    const Rectangle area = content_area(page.width, page.height);
    std::set<std::pair<double, double>> places;
    for (const PageTag& placed : page.tags) {
      const Rectangle plate = on_page(placed, placed.drawing.plate);
      places.emplace(plate.x, plate.y);
      CHECK(plate.x >= area.x);
      CHECK(plate.y >= area.y);
      CHECK(plate.x + plate.width <= area.x + area.width);
      CHECK(plate.y + plate.height <= area.y + area.height);
    }
    CHECK(places.size() == tags.size());
  }
  CHECK(plan_nest(tag.plate, paper("A1"), 0.003, 0)->plates() == 2);
  CHECK(plan_nest(tag.plate, paper("A0"), 0.003, 0)->plates() == 5);  // 4 as they are
}

TEST_CASE("a paper too small is told, with what would do") {
  const TagDrawing tag = drawing_of(small_template());
  CHECK_FALSE(plan_nest(tag.plate, paper("A3"), 0.003, 0));
  CHECK(papers_for(tag.plate, 0.003, {}) == "A2, A1, A0 or a roll of 332 mm");
  CHECK(papers_for(drawing_of(large_template()).plate, 0.003, {}) == "A1, A0 or a roll of 462 mm");
}

TEST_CASE("the last page of a roll ends below its last row") {
  const TagDrawing tag = drawing_of(small_template());
  const NestPlan plan = plan_nest(tag.plate, paper("roll:914"), 0.003, 0).value();
  const std::vector<NamedDrawing> three(3, {"000L", tag});
  CHECK(lay_out_nested(three, {}, plan).height < 0.7);
}

TEST_CASE("plates are packed apart on the shortest strip; those too large take no place") {
  struct Row {
    PlateSize plate;
    double strip;
    std::size_t count;
    double least, most;  // of the length
  };
  for (const Row& row :
       {Row{{0.41, 0.31}, 0.978, 16, 2.08, 2.27}, Row{{0.2, 0.1}, 0.4, 8, 0.4, 0.4},
        Row{{0.3, 0.2}, 0.4, 7, 1.05, 1.1}, Row{{0.5, 0.1}, 0.3, 3, 0.5, 0.5},
        Row{{0.02, 0.01}, 1.5, 2000, 0.266, 0.28}}) {
    CAPTURE(row.plate.width);
    const PlatePacking packing = pack_plates(row.plate, row.count, row.strip, kLongestStrip, true);
    CHECK(packing.places.size() == row.count);
    CHECK(packing.length >= row.least - 1e-6);
    CHECK(packing.length <= row.most + 1e-6);
    check_apart(rooms_of(row.plate, packing), row.strip, packing.length);
    const PlatePacking part = pack_plates(row.plate, row.count, row.strip, row.most / 2, true);
    CHECK(part.places.size() < row.count);
    check_apart(rooms_of(row.plate, part), row.strip, row.most / 2);
  }
  const PlateSize large{0.5, 0.6};
  CHECK(pack_plates(large, 1, 0.4, kLongestStrip, true).places.empty());
  CHECK(pack_plates(large, 1, 0.7, 0.4, true).places.empty());
  CHECK(pack_plates(large, 0, 0.7, kLongestStrip, true).places.empty());
}

TEST_CASE("what a roll loses is said, over all its pages") {
  const Rectangle plate{0, 0, 0.4, 0.3};
  const NestPlan plan = plan_nest(plate, paper("roll:1000"), 0.003, 0, 200).value();
  const RollUse use = roll_use(plate, plan, 200);
  CHECK(plan.plates() < 200);
  CHECK(use.plates == Approx(24));
  CHECK(use.area == Approx(use.length));
  CHECK(use.waste() > 0.05);
  CHECK(use.waste() < 0.15);
}

TEST_CASE("tiles cover the plate, overlap as asked and agree on where things are") {
  for (const TagTemplate& shape : {small_template(), large_template()}) {
    const TagDrawing tag = drawing_of(shape);
    for (const char* name : {"A4", "A3", "Letter", "Tabloid", "roll:420", "210x140"}) {
      CAPTURE(shape.name);
      CAPTURE(name);
      const TilePlan plan = plan_tiles(tag.plate, paper(name), 0.010, 0).value();
      const std::vector<Page> pages = lay_out_tiles("000L", tag, {"t", "s"}, plan);
      CHECK(pages.size() == static_cast<std::size_t>(plan.tiles() + 1));
      CHECK(cover_the_plate(pages));
      CHECK(pages[0].name == "assembly");
      CHECK_FALSE(pages[0].tags[0].at_true_scale);
      if (plan.columns < 2) continue;
      const double step = pages[1].tags[0].drawing.plate.x - pages[2].tags[0].drawing.plate.x;
      CHECK(plan.window.width - step == Approx(0.010));
    }
  }
  CHECK(plan_tiles(drawing_of(small_template()).plate, paper("A4"), 0.01, 0)->tiles() == 4);
  CHECK_FALSE(plan_tiles(drawing_of(small_template()).plate, paper("130x130"), 0.06, 0));
}

TEST_CASE("with a printer's dots every tile shifts the plate by whole dots") {
  const double dot = 0.0254 / 300;
  const TagDrawing tag = drawing_of(small_template());
  const TilePlan plan = plan_tiles(tag.plate, paper("A4"), 0.010, 300).value();
  const std::vector<Page> pages = lay_out_tiles("000L", tag, {}, plan);
  for (std::size_t i = 1; i < pages.size(); ++i) {
    const double dots = pages[i].tags[0].drawing.frame_inner.x / dot;
    CHECK(std::abs(dots - std::round(dots)) < 1e-6);
  }
}

TEST_CASE("tiles have addresses by row and column") {
  CHECK(tile_address(0, 0) == "A1");
  CHECK(tile_address(11, 1) == "B12");
  CHECK(tile_address(0, 26) == "AA1");
}
