// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/compare.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

namespace tagsmith::detail::test {
TEST_CASE("an unchanged survey leaves nothing to do") {
  CHECK(compare_surveys(survey_of(right_survey()), survey_of(right_survey())).empty());
}

TEST_CASE("fewer pairs remove plates, more print new ones") {
  const Survey four = survey_of(right_survey());
  const Survey three = survey_of(replaced(right_survey(), "pairs: 4", "pairs: 3"));
  const std::vector<TagDifference> removed = compare_surveys(four, three);
  REQUIRE(removed.size() == 2);
  CHECK(removed[0].tag == "003L");
  CHECK(removed[0].change == TagChange::remove);
  const std::vector<TagDifference> added = compare_surveys(three, four);
  REQUIRE(added.size() == 2);
  CHECK(added[1].tag == "003R");
  CHECK(added[1].change == TagChange::print);
}

TEST_CASE("other digits reprint, other places with the same digits move, other plates reprint") {
  const Survey before = survey_of(right_survey());
  const PlacedTag& tag = before.tags[2];
  const auto with_p = [&](double shift, const std::string& digits) {
    return survey_of(replaced(right_survey(), "placed:\n",
                              "placed:\n  - { tag: " + tag.name + ", side: left, p: [" +
                                  std::to_string(tag.p_in_grid.x()) + ", " +
                                  std::to_string(tag.p_in_grid.y() + shift) + ", " +
                                  std::to_string(tag.p_in_grid.z()) + "]" + digits + " }\n"));
  };
  const std::string same = ", digits: \"" + to_string(tag.digits) + "\"";
  CHECK(compare_surveys(before, with_p(0.0001, same)).empty());
  const std::vector<TagDifference> moved = compare_surveys(before, with_p(0.03, same));
  REQUIRE(moved.size() == 1);
  CHECK(moved[0].change == TagChange::move);
  CHECK(moved[0].distance == doctest::Approx(0.03));
  const auto misread = read_elsewhere(before, with_p(0.03, same));
  REQUIRE(misread.size() == 1);
  CHECK(misread[0].read_as == tag.name);
  CHECK(misread[0].distance == doctest::Approx(0.03));
  CHECK(read_elsewhere(before, with_p(0.0001, same)).empty());
  CHECK(read_elsewhere(before, with_p(0.03, "")).empty());
  // What was measured anew hangs where it is said to.
  CHECK(read_elsewhere(before, with_p(0.03, same + ", date: 2026-03-31")).empty());
  const std::vector<TagDifference> recoded = compare_surveys(before, with_p(0.03, ""));
  REQUIRE(recoded.size() == 1);
  CHECK(recoded[0].change == TagChange::reprint);
  Survey other_plate = before;
  other_plate.tag_template.frame_stroke += 0.001;
  const std::vector<TagDifference> all = compare_surveys(before, other_plate);
  CHECK(all.size() == before.tags.size());
  CHECK(all[0].reason == "the frame's stroke becomes 13 mm (was 12)");
  other_plate = before;
  other_plate.tag_template.white_on_black = true;
  CHECK(compare_surveys(before, other_plate).front().change == TagChange::reprint);
}

TEST_CASE("a plate that is turned in its place is to be hung again") {
  const Survey before = survey_of(right_survey());
  const auto turned = [&](double angle) {
    Survey after = before;
    after.tags[2].world_from_plate.rotation *=
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return compare_surveys(before, after);
  };
  CHECK(turned(0.002).empty());
  REQUIRE(turned(0.1).size() == 1);
  CHECK(turned(0.1)[0].change == TagChange::move);
  CHECK(turned(0.1)[0].distance == 0);
  CHECK(turned(0.1)[0].reason == "turned by 5.7 degrees clockwise");
  CHECK(turned(-0.1)[0].reason == "turned by 5.7 degrees counterclockwise");
  // Moved a little, and its right edge and its top turned out of the wall.
  Survey after = before;
  Pose& hung = after.tags[2].world_from_plate;
  const Eigen::Vector3d right = hung.rotation.col(0), into_wall = hung.rotation.col(2);
  hung.translation += Eigen::Vector3d(0, 0, 0.001);
  hung.rotation =
      hung.rotation * Eigen::AngleAxisd(0.1, Eigen::Vector3d(0, 1, 0)).toRotationMatrix();
  CHECK(hung.rotation.col(0).dot(into_wall) < 0);
  std::string reason = compare_surveys(before, after)[0].reason;
  CHECK(reason.starts_with("by 1 mm, from "));
  CHECK(reason.ends_with("; turned by 5.7 degrees right edge out"));
  hung.rotation = before.tags[2].world_from_plate.rotation *
                  Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 0, 0)).toRotationMatrix();
  CHECK(hung.rotation.col(1).dot(into_wall) > 0);  // what points down goes in
  CHECK(hung.rotation.col(0).isApprox(right));
  CHECK(compare_surveys(before, after)[0].reason.ends_with("; turned by 5.7 degrees top out"));
}

TEST_CASE("a place at the grid's axes has no sign") {
  const Survey before = survey_of(right_survey());
  Survey after = before;
  PlacedTag& tag = after.tags[2];
  tag.p_in_grid.setConstant(-0.0);
  tag.world_from_plate.translation += Eigen::Vector3d(0, 0, 0.5);
  const std::vector<TagDifference> moved = compare_surveys(before, after);
  REQUIRE(moved.size() == 1);
  CHECK(moved[0].reason.ends_with("(0.000, 0.000, 0.000)"));
}

TEST_CASE("setting-out: offsets are negative on the left, heights count from the floor there") {
  const Survey survey = survey_of(right_survey());
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) tags.push_back(&tag);
  for (const SettingOut& place : setting_out(survey, tags, usual_tolerance(survey))) {
    CAPTURE(place.tag->name);
    CHECK(place.height == doctest::Approx(1.4));
    const double side = place.tag->side == Side::left ? -1 : 1;
    CHECK(side * place.offset == doctest::Approx(2.0).epsilon(0.01));
    CHECK(place.chainage == doctest::Approx(place.tag->chainage));
    CHECK(place.tolerance == doctest::Approx(0.006));
  }
}

}  // namespace tagsmith::detail::test
