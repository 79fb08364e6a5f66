// SPDX-License-Identifier: Apache-2.0
// The border between what is believed and what is refused for its doubt alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

// A tag so far away that its digits are at the limit.
View far_tag(double module_px, std::uint64_t seed, const char* code = "019000800402",
             SensorTone tone = SensorTone::srgb) {
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), *parse_digits(code));
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.cx = 79.5;
  camera.cy = 59.5;
  constexpr double kDistance = 3;  // metres
  camera.fx = camera.fy = module_px / plate.drawing.module * kDistance;
  plate.camera_from_plate = camera_from_turned_plate(
      camera, plate.drawing, Eigen::Vector2d(80.2, 59.1), kDistance, 0.3, 0.1, 0.05);
  ViewOptions options;
  options.seed = seed;
  options.sensor.noise_sigma = 4.5;
  options.sensor.tone = tone;
  return render_view(camera, std::span(&plate, 1), options);
}

// Two pictures of the same size, one beside the other.
GrayImage side_by_side(const GrayImage& left, const GrayImage& right) {
  GrayImage both;
  both.width = left.width + right.width;
  both.height = left.height;
  for (int y = 0; y < left.height; ++y) {
    for (const GrayImage* part : {&left, &right}) {
      const auto* row = part->view().row(y);
      both.samples.insert(both.samples.end(), row, row + part->width);
    }
  }
  return both;
}

}  // namespace

TEST_CASE("a tag is less doubtful beside one that shows the scheme of the check digits") {
  const GrayImage same = far_tag(1, 1).image;                   // sum10 alone holds
  const GrayImage other = far_tag(1, 1, "019000800404").image;  // gs1 alone
  const Digits code = *parse_digits("019000800402");
  int read = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    CAPTURE(seed);
    const GrayImage far = far_tag(0.4, seed).image;
    ReadOptions named;
    named.check = CheckDigit::sum10;
    const bool legible = !read_tags(far.view(), named).tags.empty();
    if (!legible || !read_tags(far.view()).tags.empty()) continue;
    const ReadResult beside_same = read_tags(side_by_side(same, far).view());
    read += beside_same.tags.size() == 2 && beside_same.tags[1].digits == code ? 1 : 0;
    CHECK(read_tags(side_by_side(other, far).view()).tags.size() == 1);
  }
  MESSAGE("read beside another: ", read);
  CHECK(read >= 5);
}

TEST_CASE("a reading below the border of confidence is refused, and said to be doubtful") {
  struct Case {
    std::vector<Digits> code_book;
    double border;
    double least_module_px;
  };
  const std::vector<Digits> book{*parse_digits("019000800402"), *parse_digits("019000900403")};
  for (const Case& one : {Case{{}, kSureInFrame, 0.36}, Case{book, kSureWithBook, 0.26}}) {
    CAPTURE(one.border);
    int doubtful = 0, by_other_curve = 0;
    for (int step = 0; step < 4; ++step) {
      const double module_px = one.least_module_px + 0.02 * step;
      for (std::uint64_t seed = 0; seed < 25; ++seed) {
        const View view = far_tag(module_px, seed);
        ReadOptions options;
        options.code_book = one.code_book;
        const ReadResult usual = read_tags(view.image.view(), options);
        for (const Reading& tag : usual.tags) CHECK(tag.confidence >= one.border);
        options.min_confidence = 0.5;
        const ReadResult anyhow = read_tags(view.image.view(), options);
        if (anyhow.tags.size() != 1 || anyhow.tags[0].confidence >= one.border) continue;
        CHECK(usual.tags.empty());
        const auto refused =
            std::ranges::find(usual.rejected, RejectionReason::doubtful, &Rejection::reason);
        // Without a border, another tone curve may have read what this one refuses otherwise.
        if (refused == usual.rejected.end()) {
          CHECK(!usual.rejected.empty());
          ++by_other_curve;
          continue;
        }
        ++doubtful;
        CHECK(refused->limit == one.border);
        CHECK(refused->measured == refused->symbol->decoding.confidence);
        CHECK(refused->measured < one.border);
      }
    }
    MESSAGE("doubtful: ", doubtful, ", by another curve: ", by_other_curve);
    CHECK(by_other_curve < doubtful / 2);
    CHECK(doubtful >= 1);
  }
}

TEST_CASE("tags of a camera without a tone curve are read from as far as others") {
  for (const double module_px : {0.42, 0.46, 0.5, 0.7, 1.0}) {
    CAPTURE(module_px);
    std::array<int, 2> read{};
    for (const SensorTone tone : {SensorTone::srgb, SensorTone::linear}) {
      for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const View view = far_tag(module_px, seed, "019000800402", tone);
        const ReadResult result = read_tags(view.image.view());
        for (const Reading& tag : result.tags) {
          CHECK(to_string(tag.digits) == "019000800402");
          CHECK(std::abs(growth_of(*tag.symbol).px) < 0.25);
        }
        read[tone == SensorTone::linear ? 1 : 0] += static_cast<int>(result.tags.size());
      }
    }
    MESSAGE(module_px, " px a module: sRGB ", read[0], ", linear ", read[1], " of 12");
    CHECK(read[1] >= (module_px < 0.5 ? 8 : 10));
    CHECK(read[1] >= read[0] - 2);
  }
}

TEST_CASE(
    "beside a tag of a camera without a tone curve, one that the border cuts is read in part") {
  const Digits whole = *parse_digits("019000800402"), cut = *parse_digits("019000900403");
  ReadOptions options;
  options.code_book = {whole, cut};
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const GrayImage left = far_tag(0.7, seed, "019000800402", SensorTone::linear).image;
    const GrayImage right = far_tag(1.3, seed, "019000900403", SensorTone::linear).image;
    const GrayImage both = side_by_side(left, right);
    GrayView seen = both.view();
    seen.width -= 70;
    const ReadResult result = read_tags(seen, options);
    REQUIRE(result.tags.size() == 1);
    CHECK(result.tags[0].digits == whole);
    CHECK(std::abs(growth_of(*result.tags[0].symbol).px) < 0.05);  // as linear
    REQUIRE(result.parts.size() == 1);
    const auto& candidates = result.parts[0].candidates;
    CHECK(std::ranges::find(candidates, cut, &PartCandidate::digits) != candidates.end());
  }
}
