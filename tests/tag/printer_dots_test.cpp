// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "tagsmith/tag/printer.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;
using doctest::Approx;

namespace {

bool on_a_dot(double length, int dots_per_inch) {
  const double dots = length / (kMetresPerInch / dots_per_inch);
  return std::abs(dots - std::round(dots)) < 1e-6;
}

}  // namespace

TEST_CASE("modules become whole dots, quiet zones never fewer than 9 modules") {
  const TagTemplate wanted = test::corridor_template();
  for (const int dpi : {72, 150, 203, 300, 360, 600, 720, 1200, 1440}) {
    CAPTURE(dpi);
    const TagTemplate fitted = fitted_to_dots(wanted, dpi);
    CHECK(on_a_dot(module_width(fitted), dpi));
    CHECK(module_width(fitted) <= module_width(wanted));
    CHECK(fitted.quiet_zone_modules >= 9 - 1e-9);
    CHECK(fitted.frame_inner_length == wanted.frame_inner_length);
    CHECK(bar_height(fitted) == Approx(bar_height(wanted)));
    CHECK_FALSE(describe_rounding(wanted, fitted, dpi).empty());
    CHECK(describe_rounding(fitted, fitted_to_dots(fitted, dpi), dpi).empty());
  }
  CHECK(describe_rounding(wanted, fitted_to_dots(wanted, 300), 300) ==
        "module 3.0354 mm = 35.85 dots of 300 dpi, printed as 35 dots = 2.9633 mm; quiet zone 9 -> "
        "10.374 modules");
}

TEST_CASE("every edge of frame and bars stands on a dot as counted from P") {
  const TagTemplate tag = fitted_to_dots(test::corridor_template(), 300);
  const Digits digits = *parse_digits("019000000404");
  const TagDrawing exact = draw_tag(tag, digits);
  for (const double adjustment : {0.0, -0.0002, 0.0001}) {
    const TagDrawing drawing = with_bar_adjustment(on_whole_dots(exact, 300), adjustment, 300);
    REQUIRE(drawing.bars.size() == exact.bars.size());
    for (std::size_t i = 0; i < exact.bars.size(); ++i) {
      CHECK(on_a_dot(drawing.bars[i].x, 300));
      CHECK(on_a_dot(drawing.bars[i].width, 300));
      const double dot = kMetresPerInch / 300;
      CHECK(std::abs(drawing.bars[i].width - exact.bars[i].width - adjustment) <= 1.01 * dot);
    }
    CHECK(on_a_dot(drawing.frame_outer.x, 300));
    CHECK(on_a_dot(drawing.frame_inner.width, 300));
  }
}

TEST_CASE("a template without dots keeps its layout, and every edge goes to a dot") {
  const TagTemplate wanted = test::corridor_template();
  const TagDrawing exact = draw_tag(wanted, *parse_digits("019000000404"));
  for (const int dpi : {72, 150, 203, 300, 360, 600, 720, 1200, 1440}) {
    CAPTURE(dpi);
    const double dot = kMetresPerInch / dpi;
    const TagTemplate drawn = drawn_on_dots(wanted, dpi);
    const TagDrawing drawing = on_whole_dots(draw_tag(drawn, *parse_digits("019000000404")), dpi);
    const double module = module_width(drawn);
    for (std::size_t i = 0; i < exact.bars.size(); ++i) {
      CHECK(on_a_dot(drawing.bars[i].x, dpi));
      CHECK(on_a_dot(drawing.bars[i].width, dpi));
      CHECK(std::abs(drawing.bars[i].x - exact.bars[i].x) <= 1.01 * dot + 0.1 * module);
    }
    const Rectangle& last = drawing.bars.back();
    CHECK(drawing.bars.front().x >= 9 * module - 0.02 * dot);
    CHECK(drawing.frame_inner.width - last.x - last.width >= 9 * module - 0.02 * dot);
    CHECK_FALSE(describe_rounding(wanted, drawn, dpi).empty());
  }
  CHECK(describe_rounding(wanted, drawn_on_dots(wanted, 300), 300) ==
        "module 3.0354 mm = 35.85 dots of 300 dpi, printed as 35 or 36 dots, every edge on the "
        "nearest one; quiet zone not under 9 modules");
}

TEST_CASE("a module that is nearly whole becomes whole without a word in the template") {
  TagTemplate tag = test::corridor_template();
  tag.frame_inner_length = 113 * 36.02 * kMetresPerInch / 300;
  const TagTemplate drawn = drawn_on_dots(tag, 300);
  CHECK(module_width(drawn) == Approx(36 * kMetresPerInch / 300));
  CHECK(describe_rounding(tag, drawn, 300).find(" 36 dots") != std::string::npos);
  CHECK(describe_rounding(drawn, drawn_on_dots(drawn, 600), 600).empty());
}

TEST_CASE("bars lose what the ink adds, on both sides; the frame's stroke too") {
  const TagDrawing exact = draw_tag(test::corridor_template(), *parse_digits("019000000404"));
  const TagDrawing thinner = with_bar_adjustment(exact, -0.0002);
  CHECK(thinner.bars[3].width == Approx(exact.bars[3].width - 0.0002));
  CHECK(thinner.bars[3].x == Approx(exact.bars[3].x + 0.0001));
  CHECK(thinner.frame_inner.width == Approx(exact.frame_inner.width + 0.0002));
  CHECK(thinner.frame_outer.width == Approx(exact.frame_outer.width - 0.0002));
  CHECK(thinner.frame_inner.y == Approx(exact.frame_inner.y - 0.0001));
  CHECK(thinner.frame_inner.height == Approx(exact.frame_inner.height + 0.0002));
  CHECK(thinner.frame_outer.height == Approx(exact.frame_outer.height - 0.0002));
}

TEST_CASE("a module narrower than a dot stays, one of a dot and a half becomes a dot") {
  TagTemplate tiny = test::corridor_template();
  tiny.frame_inner_length = 0.005;
  CHECK(module_width(fitted_to_dots(tiny, 72)) == module_width(tiny));
  const double dot = kMetresPerInch / 72;
  tiny.frame_inner_length = 113 * 1.5 * dot;
  CHECK(module_width(fitted_to_dots(tiny, 72)) == Approx(dot));
}
