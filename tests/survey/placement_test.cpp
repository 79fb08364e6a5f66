// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

std::string without_placed(std::string text) { return text.substr(0, text.find("placed:")); }

// The middle of the inner frame's upper edge, world frame.
Eigen::Vector3d upper_middle(const Survey& survey, const PlacedTag& tag) {
  return tag.world_from_plate * Eigen::Vector3d(survey.tag_template.frame_inner_length / 2, 0, 0);
}

}  // namespace

TEST_CASE("names are three digits or more and a side") {
  CHECK(tag_name(0, Side::left) == "000L");
  CHECK(tag_name(12345, Side::right) == "12345R");
  const auto name = parse_tag_name("042R");
  REQUIRE(name.has_value());
  CHECK(name->pair == 42);
  CHECK(name->side == Side::right);
  for (const std::string wrong : {"", "L", "42R", "0042R", "042", "042r", "-01L", "+01L", "0 1L"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_tag_name(wrong).has_value());
  }
}

TEST_CASE("regular plates stand at their chainage, tangent to the wall, facing the tunnel") {
  const Survey survey = survey_of(without_placed(right_survey()));
  REQUIRE(survey.tags.size() == 8);
  const double half_inner = survey.tag_template.frame_inner_length / 2;
  for (const PlacedTag& tag : survey.tags) {
    CAPTURE(tag.name);
    const Eigen::Vector3d middle = upper_middle(survey, tag);
    const auto address = survey.tunnel.centerline.locate(middle.head<2>());
    CHECK(address.chainage == doctest::Approx(1.0 + half_inner + tag.pair * 1.0));
    CHECK(address.offset == doctest::Approx(tag.side == Side::left ? -2.0 : 2.0));
    const CenterlinePoint point = survey.tunnel.centerline.at(address.chainage);
    const Eigen::Vector3d into_wall = tag.world_from_plate.rotation.col(2);
    const double to_right = tag.side == Side::left ? -1.0 : 1.0;
    CHECK((into_wall - to_right * right_of(point.heading)).norm() < 1e-12);
    CHECK(tag.world_from_plate.rotation.determinant() == doctest::Approx(1.0));
    CHECK(tag.world_from_plate.rotation.col(1) == Eigen::Vector3d(0, 0, -1));
    CHECK(tag.p_in_grid.z() == doctest::Approx(1.4));
  }
}

TEST_CASE("on an arc with a grade, P is mount_height above the floor at its own chainage") {
  std::string text = without_placed(right_survey());
  text = replaced(text, "      - { line: 12.0 }\n", "");
  const Survey survey = survey_of(text);
  for (const PlacedTag& tag : survey.tags) {
    CAPTURE(tag.name);
    CHECK(tag.p_in_grid.z() == doctest::Approx(1.4 + 0.01 * tag.chainage));
    const auto address = survey.tunnel.centerline.locate(upper_middle(survey, tag).head<2>());
    CHECK(std::abs(address.offset) == doctest::Approx(2.0));
  }
}

TEST_CASE("a mirrored grid has the same tunnel with x to the other side") {
  const std::string right = without_placed(right_survey());
  std::string left = replaced(right, "x_axis: right", "x_axis: left");
  left = replaced(left, "[10.0, 20.0, 0.0]", "[-10.0, 20.0, 0.0]");
  left = replaced(left, "origin: [0, 0, -1]", "origin: [-20, 0, -1]");
  const Survey a = survey_of(right);
  const Survey b = survey_of(left);
  REQUIRE(a.tags.size() == b.tags.size());
  for (std::size_t i = 0; i < a.tags.size(); ++i) {
    CHECK((a.tags[i].world_from_plate.translation - b.tags[i].world_from_plate.translation).norm() <
          1e-12);
    CHECK(a.tags[i].p_in_grid.x() == doctest::Approx(-b.tags[i].p_in_grid.x()));
  }
}

TEST_CASE("headings are the grid's: from +y towards +x, wherever x points") {
  for (const std::string axis : {"right", "left"}) {
    CAPTURE(axis);
    std::string text = replaced(without_placed(right_survey()), "x_axis: right", "x_axis: " + axis);
    text = replaced(text, "heading: 0", "heading: 30");
    const Survey survey = survey_of(text);
    const Eigen::Vector3d along =
        grid_from_world(survey.grid, survey.tunnel.centerline.at(5).position -
                                         survey.tunnel.centerline.at(0).position) /
        5;
    CHECK(along.x() == doctest::Approx(std::sin(radians(30))));
    CHECK(along.y() == doctest::Approx(std::cos(radians(30))));
  }
}

TEST_CASE("turn: right is to the right of the drive, wherever x points") {
  for (const std::string axis : {"right", "left"}) {
    CAPTURE(axis);
    std::string text = replaced(without_placed(right_survey()), "x_axis: right", "x_axis: " + axis);
    text = replaced(text, "turn: left", "turn: right");
    const Survey survey = survey_of(text);
    CHECK(survey.tunnel.centerline.locate(survey.tunnel.centerline.at(20).position.head<2>())
              .offset == doctest::Approx(0));
    CHECK(survey.tunnel.centerline.at(20).heading > survey.tunnel.centerline.at(0).heading);
  }
}

TEST_CASE("theta moves the right plates only, to W_T tan(theta) ahead of the left P") {
  const std::string text =
      replaced(without_placed(right_survey()), "pairs: 4", "pairs: 4\n  theta: 7");
  const Survey survey = survey_of(text);
  for (int pair = 0; pair < 4; ++pair) {
    const PlacedTag* left = find_tag(survey, tag_name(pair, Side::left));
    const PlacedTag* right = find_tag(survey, tag_name(pair, Side::right));
    REQUIRE(left != nullptr);
    REQUIRE(right != nullptr);
    CHECK(right->p_in_grid.y() - left->p_in_grid.y() ==
          doctest::Approx(4.0 * std::tan(radians(7))));
    CHECK(left->p_in_grid.y() == doctest::Approx(21.0 + pair));
  }
}

TEST_CASE("to: counts the pairs whose left P it reaches") {
  for (const auto& [to, pairs] : {std::pair{"1.0", 1}, {"1.9", 1}, {"2.0", 2}, {"6.6", 6}}) {
    CAPTURE(to);
    const Survey survey =
        survey_of(replaced(without_placed(right_survey()), "pairs: 4", std::string("to: ") + to));
    CHECK(survey.series->pairs == pairs);
    CHECK(survey.tags.size() == 2 * static_cast<std::size_t>(pairs));
  }
}

TEST_CASE("a surveyed tag replaces the designed one, and others join in their order") {
  const Survey survey = survey_of(right_survey());
  REQUIRE(survey.tags.size() == 9);
  CHECK(survey.tags[3].name == "001R");
  CHECK(survey.tags[3].surveyed);
  CHECK(survey.tags[3].p_in_grid == Eigen::Vector3d(12.0, 22.4, 1.4));
  CHECK(to_string(survey.tags[3].digits).substr(0, 11) == "12002240240");
  CHECK(survey.tags[8].name == "004L");
  CHECK_FALSE(survey.tags[2].surveyed);
}

TEST_CASE("printed digits are kept although they say another position") {
  const Survey survey = survey_of(right_survey());
  const PlacedTag* tag = find_tag(survey, "004L");
  REQUIRE(tag != nullptr);
  CHECK(to_string(tag->digits) == "000000000017");
  CHECK(tag->p_in_grid == Eigen::Vector3d(8.0, 25.0, 1.4));
  CHECK((tag->coded_in_grid - Eigen::Vector3d(0, 0, -0.99)).norm() < 1e-12);
  CHECK(find_tag(survey, parse_digits("000000000017").value()) == tag);
}

TEST_CASE("eleven printed digits get their check digit") {
  const Survey survey = survey_of(replaced(right_survey(), "\"000000000017\"", "\"00000000001\""));
  CHECK(to_string(find_tag(survey, "004L")->digits) == "000000000017");
}

TEST_CASE("a surveyed P on an arc hangs tangent at its frame's middle") {
  std::string text = replaced(right_survey(), "      - { line: 12.0 }\n", "");
  text = without_placed(text);
  const Survey designed = survey_of(text);
  for (const PlacedTag& tag : designed.tags) {
    CAPTURE(tag.name);
    const PlacedTag again = place_surveyed(designed, {tag.pair, tag.side}, tag.p_in_grid);
    CHECK((again.world_from_plate.rotation - tag.world_from_plate.rotation).norm() < 1e-9);
    CHECK(again.chainage == doctest::Approx(tag.chainage));
  }
}

TEST_CASE("a survey may have surveyed tags only") {
  const Survey survey = survey_of(R"(survey: as-built
tunnel:
  width: 4.0
  height: 3.0
  centerline: { start: [10, 20, 0], heading: 0, elements: [ { line: 12 } ] }
tags: { template: tag-400x300 }
code: { check_digit: gs1 }
placed:
  - { tag: 007L, side: left, p: [8, 25, 1.4] }
)");
  REQUIRE(survey.tags.size() == 1);
  CHECK_FALSE(survey.series.has_value());
  CHECK(survey.code.resolution[0] == 0.01);
}

TEST_CASE("a measured tag keeps its sigma, its date and the design it replaces") {
  const TemporaryFolder folder;
  const auto load = [&](const std::string& extra) {
    const std::string entry = "p: [12.0, 22.4, 1.4]";
    return load_survey(
        write_text(folder.path() / "s.yaml", replaced(right_survey(), entry, entry + extra)));
  };
  const Survey plain = load("").value();
  const PlacedTag& unmeasured = *find_tag(plain, "001R");
  CHECK(unmeasured.sigma == 0.003);
  CHECK(unmeasured.date.empty());
  REQUIRE(unmeasured.design_in_grid);
  const PlacedTag regular = place_in_series(plain, 1, Side::right);
  CHECK((*unmeasured.design_in_grid - regular.p_in_grid).norm() == 0);
  CHECK_FALSE(find_tag(plain, "004L")->design_in_grid);  // no regular pair has this name
  CHECK_FALSE(find_tag(plain, "000L")->design_in_grid);  // hangs as designed

  const Survey survey = load(", sigma: 0.001, date: 2026-03-31, design: [12.0, 22.6, 1.4]").value();
  const PlacedTag& tag = *find_tag(survey, "001R");
  CHECK(tag.sigma == 0.001);
  CHECK(tag.date == "2026-03-31");
  CHECK(tag.design_in_grid->y() == 22.6);
  CHECK(find_tag(survey, "000L")->sigma == 0.003);
  for (const char* wrong : {", date: 31.03.2026", ", date: 2026-02-30", ", date: 2026-3-31",
                            ", sigma: -1", ", design: [1, 2]"}) {
    CAPTURE(wrong);
    CHECK_FALSE(load(wrong));
  }
}
