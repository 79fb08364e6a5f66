// SPDX-License-Identifier: Apache-2.0
// Drafts of lists whose plates were measured at another point than P.
#include "tagsmith/tag/measured_point.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/cli/tag_list.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/exchange/drift_points.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

Eigen::Vector3d place_of(const MeasuredPoint& point, const PlacedTag& tag) {
  return tag.world_from_plate.translation +
         tag.world_from_plate.rotation.leftCols<2>() * Eigen::Vector2d(point.right, point.down);
}

Survey drafted(const fs::path& folder, const std::string& csv, const std::string& arguments) {
  fs::remove_all(folder / "out");
  const ProgramOutput made = draft(folder, csv, arguments);
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  return load_survey(folder / "out" / "survey.yaml").value();
}

// Metres.
double farthest_apart(const Survey& a, const Survey& b) {
  REQUIRE(a.tags.size() == b.tags.size());
  double most = 0;
  for (std::size_t i = 0; i < a.tags.size(); ++i) {
    CHECK(a.tags[i].name == b.tags[i].name);
    most = std::max(most, (a.tags[i].p_in_grid - b.tags[i].p_in_grid).norm());
  }
  return most;
}

}  // namespace

TEST_CASE("a table of plates measured at any point becomes the survey of their P") {
  constexpr double kRounded = 0.002;  // coordinates of the table are whole millimetres
  const TemporaryFolder folder;
  const PointWriter at_p = surveyed_drift(0);
  const Survey right = drafted(folder.path(), at_p.text("PENZD"), "--order PENZD");
  for (const MeasuredPoint& point : points_besides_p(right.tag_template)) {
    CAPTURE(std::string(point.option));
    PointWriter measured = at_p;
    for (PointWriter::Point& listed : measured.points) {
      for (const PlacedTag& tag : right.tags) {
        if ((tag.p_in_grid - listed.p).norm() < kRounded) listed.p = place_of(point, tag);
      }
    }
    const std::string csv = measured.text("PENZD");
    const Survey made =
        drafted(folder.path(), csv, "--order PENZD --point " + std::string(point.option));
    CHECK(farthest_apart(made, right) < kRounded);
    CHECK(farthest_apart(drafted(folder.path(), csv, "--order PENZD"), right) >
          std::hypot(point.right, point.down) - kRounded);
  }
}

TEST_CASE("a list of export whose positions are of another point becomes the survey of P") {
  const TemporaryFolder folder;
  const Survey right = load_survey("surveys/curved/survey.yaml").value();
  for (const MeasuredPoint& point : points_besides_p(right.tag_template)) {
    CAPTURE(std::string(point.option));
    Survey listed = right;
    for (PlacedTag& tag : listed.tags) {
      const Digits digits = tag.digits;
      tag = place_surveyed(listed, {tag.pair, tag.side},
                           grid_from_world(listed.grid, place_of(point, tag)));
      tag.digits = digits;
    }
    const Survey made = drafted(folder.path(), tags_csv(listed),
                                "--order own --point " + std::string(point.option));
    CHECK(farthest_apart(made, right) < 0.002);
    for (std::size_t i = 0; i < right.tags.size(); ++i) {
      CAPTURE(right.tags[i].name);
      CHECK(made.tags[i].digits == right.tags[i].digits);
      CHECK((made.tags[i].world_from_plate.rotation - right.tags[i].world_from_plate.rotation)
                .norm() < 0.02);
    }
  }
}

TEST_CASE("a plate's own direction is kept where it was measured at another point") {
  const TemporaryFolder folder;
  Survey right = load_survey("surveys/curved/survey.yaml").value();
  PlacedTag& turned = right.tags[5];
  PlateAttitude attitude{};
  attitude.facing = grid_heading_from_world(right.grid, facing_of(turned.world_from_plate)) + 0.2;
  turned = place_surveyed(right, {turned.pair, turned.side}, turned.p_in_grid, attitude);
  turned = with_own_digits(turned, right.code).value();
  const MeasuredPoint middle = points_besides_p(right.tag_template).front();
  Survey listed = right;
  for (PlacedTag& tag : listed.tags) {
    const Digits digits = tag.digits;
    tag = place_surveyed(listed, {tag.pair, tag.side},
                         grid_from_world(listed.grid, place_of(middle, tag)), tag.attitude);
    tag.digits = digits;
  }
  const Survey made =
      drafted(folder.path(), tags_csv(listed), "--order own --point " + std::string(middle.option));
  CHECK((made.tags[5].p_in_grid - turned.p_in_grid).norm() < 0.001);
  CHECK((made.tags[5].world_from_plate.rotation - turned.world_from_plate.rotation).norm() < 1e-4);
}

TEST_CASE("points that no plate has are refused") {
  const TemporaryFolder folder;
  const ProgramOutput refused =
      draft(folder.path(), surveyed_drift(0).text("PENZD"), "--order PENZD --point center");
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("--point") != std::string::npos);
  CHECK(refused.err.find("middle") != std::string::npos);
  const ProgramOutput no_tags =
      draft(folder.path(), "1,0,0,0,WL\n2,0,9,0,WL\n3,3,0,0,WR\n4,3,9,0,WR\n",
            "--order PENZD --point middle --height 1 --spacing 2");
  CHECK(no_tags.exit_code == 2);
  CHECK_MESSAGE(no_tags.err.find("--point") != std::string::npos, no_tags.err);
}
