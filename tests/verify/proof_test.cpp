// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/proof.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kDotsPerInch = 150;

// The page in black and white.
GrayImage picture_of(const Page& page) {
  constexpr double kPixels = kDotsPerInch / 0.0254;  // in a metre
  const auto pixel = [](double metres) { return static_cast<int>(std::lround(metres * kPixels)); };
  GrayImage image{pixel(page.width), pixel(page.height), {}};
  image.samples.assign(static_cast<std::size_t>(image.width * image.height), 255);
  const auto fill = [&](const Rectangle& area, std::uint8_t level) {
    for (int y = pixel(area.y); y < pixel(area.y + area.height); ++y) {
      for (int x = pixel(area.x); x < pixel(area.x + area.width); ++x) {
        image.samples[static_cast<std::size_t>(y * image.width + x)] = level;
      }
    }
  };
  for (const PageTag& tag : page.tags) {
    fill(tag.drawing.frame_outer, 0);
    fill(tag.drawing.frame_inner, 255);
    for (const Rectangle& bar : tag.drawing.bars) fill(bar, 0);
  }
  return image;
}

}  // namespace

TEST_CASE("a proof names what is read, and fails where the survey says something else") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const PlacedTag& tag = survey.tags[0];
  const test::TemporaryFolder folder;
  for (const PlacedTag* printed : {&survey.tags[0], &survey.tags[2]}) {
    CAPTURE(printed->name);
    Page page;
    page.width = 0.5;
    page.height = 0.4;
    page.tags = {{tag.name, moved(draw_tag(survey.tag_template, printed->digits), 0.08, 0.09)}};
    const ProofPage proof_page{folder.path() / "a.png", 0, &page};
    REQUIRE(save_gray_image(proof_page.file, picture_of(page).view()));
    const auto proofs = prove_pages(survey, std::span(&proof_page, 1), kDotsPerInch);
    REQUIRE_MESSAGE(proofs, proofs.error().message);
    REQUIRE(proofs->size() == 1);
    const TagProof& proof = proofs->front();
    CHECK(proof.tag == tag.name);
    CHECK(proof.digits == to_string(printed->digits));
    CHECK(proof.problem.empty() == (printed == &tag));
    CHECK(proof.corner_error < 0.0254 / kDotsPerInch);
  }
}

}  // namespace tagsmith::detail
