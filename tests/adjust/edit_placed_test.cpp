// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_placed.hpp"

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/contents.hpp"

namespace tagsmith::detail::test {
namespace {

const std::string& corridor() {
  static const std::string text = contents("surveys/corridor/survey.yaml");
  return text;
}

Survey survey_of(const std::string& text) {
  const Diagnosed<Survey> reading = read_survey_text("surveys/corridor/survey.yaml", text);
  REQUIRE_MESSAGE(reading.value, to_string(reading.diagnostics, true));
  return *reading.value;
}

AsBuiltPlace place_of(const std::string& tag, double z) {
  AsBuiltPlace place{tag, {1.9, 0.8, z}, {}, 0.0012, "2026-03-31"};
  place.attitude = {radians(269.5), radians(1), radians(-0.5)};
  return place;
}

std::string changed(const std::string& text, const std::vector<AsBuiltPlace>& places) {
  const Result<std::string> result = survey_with_places(text, survey_of(text), places);
  REQUIRE_MESSAGE(result, result.error().message);
  return *result;
}

}  // namespace

TEST_CASE("a regular tag gets an entry of its own, and keeps its digits") {
  const std::string text = changed(corridor(), {place_of("001L", 0.43)});
  CHECK(text.starts_with(corridor()));
  CHECK(text.substr(corridor().size()) ==
        "placed:\n"
        "  - { tag: 001L, side: left, p: [1.9000, 0.8000, 0.4300], sigma: 0.0012, date: "
        "2026-03-31, facing: 269.500, tilt: 1.000, roll: -0.500, digits: \"019000800402\" }\n");
  const Survey survey = survey_of(text);
  const PlacedTag& tag = *find_tag(survey, std::string_view("001L"));
  CHECK(to_string(tag.digits) == "019000800402");
  CHECK(tag.design_in_grid->z() == 0.4);
  const PlateAttitude attitude = attitude_of(survey.grid, tag.world_from_plate);
  CHECK(std::remainder(degrees(*attitude.facing) - 269.5, 360) == doctest::Approx(0));
  CHECK(degrees(attitude.tilt) == doctest::Approx(1));
  CHECK(degrees(attitude.roll) == doctest::Approx(-0.5));
}

TEST_CASE("entries are changed as they are laid out, and their comments stay") {
  const std::string text = corridor() +
                           "placed:\n"
                           "  # by the total station\n"
                           "  - { tag: 001L, p: [1.9, 0.8, 0.4], side: left }  # in brackets\n"
                           "  - tag: 009L  # on lines\n"
                           "    side: left\n"
                           "    p: [1.9, 7.2, 0.4]   # P\n"
                           "    digits: \"019000720403\"\n"
                           "  - { tag: 000R, side: right, p: [0, 0.343, 0.4], control: true }\n"
                           "# the end";
  AsBuiltPlace ninth = place_of("009L", 0.41);
  ninth.p_in_grid.y() = 7.21;
  const std::string edited = changed(text, {place_of("001L", 0.43), ninth, place_of("002L", 0.4)});
  CHECK(edited.substr(corridor().size()) ==
        "placed:\n"
        "  # by the total station\n"
        "  - { tag: 001L, p: [1.9000, 0.8000, 0.4300], side: left, sigma: 0.0012, date: "
        "2026-03-31, facing: 269.500, tilt: 1.000, roll: -0.500, digits: \"019000800402\" }  # in "
        "brackets\n"
        "  - tag: 009L  # on lines\n"
        "    side: left\n"
        "    p: [1.9000, 7.2100, 0.4100]   # P\n"
        "    digits: \"019000720403\"\n"
        "    sigma: 0.0012\n"
        "    date: 2026-03-31\n"
        "    facing: 269.500\n"
        "    tilt: 1.000\n"
        "    roll: -0.500\n"
        "    design: [1.9000, 7.2000, 0.4000]\n"
        "  - { tag: 000R, side: right, p: [0, 0.343, 0.4], control: true }\n"
        "  - { tag: 002L, side: left, p: [1.9000, 0.8000, 0.4000], sigma: 0.0012, date: "
        "2026-03-31, facing: 269.500, tilt: 1.000, roll: -0.500, digits: \"019001600401\" }\n"
        "# the end");
}

TEST_CASE("what cannot be changed as it is laid out is refused") {
  const std::string text = corridor() +
                           "placed:\n"
                           "  - tag: 001L\n"
                           "    side: left\n"
                           "    p:\n"
                           "      - 1.9\n"
                           "      - 0.8\n"
                           "      - 0.4\n";
  CHECK_FALSE(survey_with_places(text, survey_of(text), {place_of("001L", 0.43)}));
  const std::string empty = corridor() + "placed: []\n";
  const auto refused = survey_with_places(empty, survey_of(empty), {place_of("001L", 0.43)});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message.find("remove it where it is empty") != std::string::npos);
}

}  // namespace tagsmith::detail::test
