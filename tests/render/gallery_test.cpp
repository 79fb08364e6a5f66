// SPDX-License-Identifier: Apache-2.0
// The pictures and the table of docs/templates.md.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/svg.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tests/render/sample_survey.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

TagTemplate template_in(const fs::path& path) {
  const Result<Diagnosed<TagTemplate>> reading = read_template(path);
  REQUIRE(reading);
  REQUIRE(reading->value);
  return *reading->value;
}

// Fonts differ from machine to machine; what is said does not.
std::string without_outlines(std::string svg) {
  constexpr std::string_view kBegin = "\" d=\"";
  for (std::size_t at = svg.find(kBegin); at != std::string::npos; at = svg.find(kBegin, at + 1)) {
    const std::size_t from = at + kBegin.size();
    const std::size_t end = svg.find('"', from);
    if (svg.compare(end, 9, "\"><title>") == 0) svg.erase(from, end - from);
  }
  return svg;
}

}  // namespace

TEST_CASE("the gallery shows every template as it prints") {
  const std::string page = read_file("docs/templates.md").value();
  int count = 0;
  for (const auto& entry : fs::directory_iterator("templates")) {
    const TagTemplate tag = template_in(entry.path());
    CAPTURE(tag.name);
    ++count;
    const std::string svg = render_svg(sheet_of(sample_page(tag)));
    const fs::path picture = "docs/images/" + tag.name + ".svg";
    if (std::getenv("TAGSMITH_WRITE_GALLERY") != nullptr) REQUIRE(write_file(picture, svg));
    const Result<std::string> kept = read_file(picture);
    REQUIRE_MESSAGE(kept, "missing: ./dev gallery draws it");
    CHECK_MESSAGE(without_outlines(*kept) == without_outlines(svg), "old: ./dev gallery");
    CHECK(page.find("](images/" + tag.name + ".svg)") != std::string::npos);
    const auto mm = [](double metres, int digits) { return format_number(metres * 1000, digits); };
    const std::string row =
        fmt::format("](../templates/{}.yaml) | {} x {} | {} x {} | {} |", tag.name,
                    mm(tag.plate_length, 1), mm(tag.plate_height, 1), mm(tag.frame_inner_length, 1),
                    mm(tag.frame_inner_height, 1), mm(module_width(tag), 3));
    CHECK_MESSAGE(page.find(row) != std::string::npos, row);
  }
  CHECK(count == 4);
}

TEST_CASE("patches, holes and cut contours keep clear of frame and quiet zones") {
  for (const auto& entry : fs::directory_iterator("templates")) {
    const TagTemplate tag = template_in(entry.path());
    CAPTURE(tag.name);
    const TagDrawing drawing = draw_tag(tag, Digits{});
    const Rectangle& frame = drawing.frame_outer;
    const auto clear = [&](double left, double top, double right, double bottom) {
      constexpr double kWhite = 0.002;  // of the plate around the frame
      return right < frame.x - kWhite || left > frame.x + frame.width + kWhite ||
             bottom < frame.y - kWhite || top > frame.y + frame.height + kWhite;
    };
    if (tag.patch_size > 0) {
      REQUIRE(drawing.patches);
      for (const Rectangle& box : {drawing.patches->white, drawing.patches->black}) {
        CHECK(clear(box.x, box.y, box.x + box.width, box.y + box.height));
        CHECK(box.width == doctest::Approx(tag.patch_size));
      }
    }
    for (const HoleOutline& hole : drawing.holes) {
      const auto& [x, y] = hole.centre;
      CHECK(clear(x - hole.radius, y - hole.radius, x + hole.radius, y + hole.radius));
    }
    CHECK(tag.quiet_zone_modules >= 9 - 1e-9);
  }
}
