// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/expected_place.hpp"

#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/survey/read_survey.hpp"

using namespace tagsmith::detail;

namespace {

const char* const kStraight = R"(survey: straight
tunnel:
  width: 4.0
  height: 6.0
  centerline: { start: [10.0, 0.0, 0.0], heading: 0, elements: [ { line: 60.0 } ] }
tags: { template: tag-400x300, height: 0.4, first: 2.0, spacing: 1.6, pairs: 20 }
code: { check_digit: gs1, resolution: 0.01, digits: [4, 4, 3], origin: [0, 0, 0] }
)";

}  // namespace

TEST_CASE("three tags on either side say where one is expected, the same up a wall as down it") {
  const Diagnosed<Survey> reading = read_survey_text("straight.yaml", kStraight);
  REQUIRE_MESSAGE(reading.value, to_string(reading.diagnostics, true));
  for (const double rise : {0.1, -0.1}) {
    CAPTURE(rise);
    std::vector<SourcedTag> tags;
    for (const PlacedTag& tag : reading.value->tags) {
      if (tag.side != Side::left) continue;
      tags.emplace_back().tag = tag;
      tags.back().tag.p_in_grid.z() = 3 + rise * tag.pair;
    }
    std::vector<const SourcedTag*> wall;
    for (const SourcedTag& tag : tags) wall.push_back(&tag);
    REQUIRE(wall.size() == 20);
    const auto places = expected_places(*reading.value, wall);
    for (std::size_t i = 3; i + 3 < wall.size(); ++i) {
      CAPTURE(i);
      REQUIRE(places[i]);
      const PlateAddress own = plate_address(*reading.value, Side::left, wall[i]->tag.p_in_grid);
      CHECK(places[i]->height == doctest::Approx(own.height));
      CHECK(places[i]->chainage == doctest::Approx(own.chainage));
    }
  }
}
