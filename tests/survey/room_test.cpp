// SPDX-License-Identifier: Apache-2.0
// Tunnels whose section changes, walls as surveyed, plates with an attitude of their own.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;
using Eigen::Vector3d;

namespace {

Diagnosed<Survey> reading_of(const std::string& text) { return read_survey_text("s.yaml", text); }

// A straight drive of 30 m along +y from the origin; `room` are the keys of its walls and roof.
std::string drive(const std::string& room, const std::string& rest = "") {
  return "survey: drive\ntunnel:\n" + room +
         "  centerline: { start: [0, 0, 0], heading: 0, elements: [ { line: 30.0 } ] }\n"
         "tags: { template: tag-400x300, height: 1.4, spacing: 1.6, first: 1.0, pairs: 14 }\n"
         "code: { check_digit: gs1, digits: [3, 5, 3], origin: [-4, -1, -1] }\n" +
         rest;
}

const char* kPlain = "  width: 3.8\n  height: 3.0\n";

Vector3d middle_of(const Survey& survey, const PlacedTag& tag) {
  return tag.world_from_plate * Vector3d(survey.tag_template.frame_inner_length / 2, 0, 0);
}

Vector3d facing(const PlacedTag& tag) { return -tag.world_from_plate.rotation.col(2); }

}  // namespace

TEST_CASE("sections: walls and roof are linear between them and step where two stand together") {
  const Survey survey =
      survey_of(drive("  sections:\n"
                      "    - { at: 0, width: 3.8, height: 3.0 }\n"
                      "    - { at: 12.5, width: 4.2 }\n"
                      "    - { at: 20.05, width: 4.2 }\n"
                      "    - { at: 20.05, width: 6.0, height: 3.6 }\n"));
  CHECK(width_at(survey.tunnel, 0) == Approx(3.8));
  CHECK(width_at(survey.tunnel, 6.25) == Approx(4.0));
  CHECK(width_at(survey.tunnel, 20) == Approx(4.2));
  CHECK(width_at(survey.tunnel, 21) == Approx(6.0));
  CHECK(survey.tunnel.height.at(20.05 / 2) == Approx(3.3));
  CHECK(width_text(survey.tunnel) == "3.8 to 6");
  for (const PlacedTag& tag : survey.tags) {
    CAPTURE(tag.name);
    const CenterlineAddress at = survey.tunnel.centerline.locate(middle_of(survey, tag).head<2>());
    CHECK(behind_wall(survey.tunnel, tag.side, at) == Approx(0).epsilon(1e-9));
    // 0.2 m in 12.5 m to either side.
    const double out = at.chainage < 12 ? 0.2 / 12.5 : 0.0;
    const double along = tag.side == Side::left ? 1 : -1;
    const Vector3d wall = Vector3d(along * (tag.side == Side::left ? -out : out), along, 0);
    CHECK((tag.world_from_plate.rotation.col(0) - wall.normalized()).norm() < 2e-3);
    CHECK(std::abs(tag.world_from_plate.rotation.determinant() - 1) < 1e-12);
  }
}

TEST_CASE("walls are distances to the rock; plates stand off it, as far in front as is said") {
  const Survey survey =
      survey_of(drive("  height: 3.0\n  stand_off: 0.03\n"
                      "  walls:\n    left: [[0, 1.83], [30, 2.13]]\n    right: [[0, 2.03]]\n"));
  CHECK(survey.tunnel.left.at(15) == Approx(-1.95));
  CHECK(survey.tunnel.right.at(15) == Approx(2.0));
  CHECK(rock_of(survey.tunnel, Side::left).at(15) == Approx(-1.98));
  const PlacedTag& left = *find_tag(survey, "005L");
  CHECK(wall_distance(survey.tunnel, Side::left, left.chainage) < 1.95);
  const double turned = std::atan2(facing(left).y(), facing(left).x());
  CHECK(turned == Approx(std::atan(0.01)));  // the wall opens: the plate looks ahead a little
  const PlacedTag& right = *find_tag(survey, "005R");
  CHECK(right.p_in_grid.x() == Approx(2.0));
}

TEST_CASE("one wall surveyed, the other by the width") {
  const Survey survey =
      survey_of(drive("  width: 4\n  height: 3\n  walls: { left: [[0, 1.7]] }\n"));
  CHECK(wall_distance(survey.tunnel, Side::left, 3) == Approx(1.7));
  CHECK(wall_distance(survey.tunnel, Side::right, 3) == Approx(2.0));
}

TEST_CASE("a theta moves the right plates by the width at their pair") {
  const std::string room =
      "  height: 3\n  sections: [ { at: 0, width: 3 }, { at: 30, width: 6 } ]\n";
  const Survey survey = survey_of(replaced(drive(room), "pairs: 14", "pairs: 12, theta: 10"));
  for (int pair = 0; pair < 12; ++pair) {
    const double abreast = left_middle(survey, pair);
    const double shift = width_at(survey.tunnel, abreast) * std::tan(radians(10)) - 0.343;
    const PlacedTag& right = survey.tags[static_cast<std::size_t>(2 * pair + 1)];
    const Vector3d middle = middle_of(survey, right);
    CHECK(survey.tunnel.centerline.locate(middle.head<2>()).chainage == Approx(abreast + shift));
  }
}

TEST_CASE("what a section or wall may not say is said with its place") {
  struct Row {
    const char* room;
    const char* code;
    int line;
  };
  for (const Row& row : {
           Row{"  height: 3\n", "missing-key", -1},
           Row{"  width: 3\n", "missing-key", -1},
           Row{"  width: 3\n  height: 3\n  sections: [ { at: 0, width: 3 } ]\n", "conflicting-keys",
               3},
           Row{"  width: 3\n  sections: [ { at: 5, height: 3 }, { at: 1, height: 3 } ]\n",
               "bad-station", 4},
           Row{"  width: 3\n  sections: [ { at: 5, height: 3 }, { at: 5, height: 2.9 }, { at: 5, "
               "height: 3 } ]\n",
               "bad-station", 4},
           Row{"  width: 3\n  height: 3\n  sections: [ { at: 5 } ]\n", "missing-key", 5},
           Row{"  height: 3\n  walls: { left: [[0, 2]], right: [[0]] }\n", "wrong-length", 4},
           Row{"  height: 3\n  walls: { left: [[0, -2]], right: [[0, 2]] }\n", "out-of-range", 4},
           Row{"  height: 3\n  stand_off: 0.1\n  walls: { left: [[0, 2]], right: [[0, 0.1]] }\n",
               "out-of-range", 5},
           Row{"  width: 4\n  height: 3\n  walls: { left: [[0, 2]], right: [[0, 2]] }\n",
               "conflicting-keys", 5},
           Row{"  width: 4\n  height: 3\n  stand_of: 0.03\n", "unknown-key", 5},
       }) {
    CAPTURE(row.room);
    const Diagnosed<Survey> reading = reading_of(drive(row.room));
    CAPTURE(to_string(reading.diagnostics));
    CHECK_FALSE(reading.value.has_value());
    CHECK(count_findings(reading.diagnostics, row.code, row.line) == 1);
  }
}

TEST_CASE("an arc must be wider than its inner wall is far, wherever that is") {
  std::string text = drive("  height: 3\n  walls: { left: [[0, 2]], right: [[0, 2], [20, 7]] }\n");
  text = replaced(text, "{ line: 30.0 }", "{ line: 10.0 }, { arc: 6, turn: right, angle: 90 }");
  CHECK(count_findings(reading_of(text).diagnostics, "tight-arc") == 1);
  text = replaced(text, "turn: right", "turn: left");
  CHECK(count_findings(reading_of(text).diagnostics, "tight-arc") == 0);
}

TEST_CASE("a plate over a step of its wall is warned of, regular ones together") {
  const Diagnosed<Survey> reading =
      reading_of(drive("  height: 3\n  sections: [ { at: 0, width: 4 }, { at: 5.1, width: 4 }, { "
                       "at: 5.1, width: 5 } "
                       "]\n"));
  CHECK(reading.value.has_value());
  CHECK(count_findings(reading.diagnostics, "wall-step") == 1);
}

TEST_CASE("a low roof is found where it is low") {
  const Diagnosed<Survey> reading = reading_of(
      drive("  width: 4\n  sections: [ { at: 0, height: 3 }, { at: 18, height: 1.3 } ]\n"));
  CHECK(count_findings(reading.diagnostics, "outside-tunnel") == 1);
}

TEST_CASE("facing, tilt and roll turn a plate as a viewer would say") {
  const auto placed = [&](const std::string& keys, const std::string& side = "left") {
    const std::string name = side == "left" ? "040L" : "040R";
    const std::string x = side == "left" ? "-1.5" : "1.5";
    return *find_tag(survey_of(drive(kPlain, "placed:\n  - { tag: " + name + ", side: " + side +
                                                 ", p: [" + x + ", 29.5, 1.4]" + keys + " }\n")),
                     name);
  };
  CHECK((facing(placed("")) - Vector3d(1, 0, 0)).norm() < 1e-12);
  const PlacedTag ahead = placed(", facing: 30");  // from +y towards +x
  CHECK((facing(ahead) - Vector3d(0.5, std::sqrt(0.75), 0)).norm() < 1e-12);
  // Its upper edge forward: it looks down, and P, which is measured, stays.
  const PlacedTag leaning = placed(", tilt: 3");
  CHECK((facing(leaning) - Vector3d(std::cos(radians(3)), 0, -std::sin(radians(3)))).norm() < 1e-9);
  CHECK((leaning.world_from_plate.translation - Vector3d(-1.5, 29.5, 1.4)).norm() == 0);
  const PlacedTag rolled = placed(", roll: 10", "right");
  CHECK((facing(rolled) - Vector3d(-1, 0, 0)).norm() < 1e-9);
  CHECK(rolled.world_from_plate.rotation(2, 0) == Approx(-std::sin(radians(10))));  // F goes down
  CHECK(std::abs(leaning.world_from_plate.rotation.determinant() - 1) < 1e-12);
}

TEST_CASE("plates that state no attitude have the one that all are said to have") {
  const std::string plain =
      drive(kPlain,
            "placed:\n"
            "  - { tag: 040L, side: left, p: [-1.9, 29.5, 1.4] }\n"
            "  - { tag: 041R, side: right, p: [1.9, 29.5, 1.4], tilt: 0 }\n"
            "  - { tag: 042L, side: left, p: [-1.9, 28.5, 1.4], facing: 95 }\n");
  const auto with = [&](const std::string& keys) {
    return survey_of(replaced(plain, "pairs: 14", "pairs: 14, " + keys));
  };
  const Survey upright = survey_of(plain);
  CHECK(usual_attitudes_text(upright).empty());
  const Survey leaning = with("tilt: 4");
  CHECK(usual_attitudes_text(leaning) == "every plate leans 4 degrees forward");
  for (std::size_t i = 0; i < upright.tags.size(); ++i) {
    const PlacedTag& tag = leaning.tags[i];
    CAPTURE(tag.name);
    CHECK((tag.p_in_grid - upright.tags[i].p_in_grid).norm() == 0);
    CHECK(tag.digits == upright.tags[i].digits);
    CHECK(facing(tag).z() == Approx(tag.name == "041R" ? 0 : -std::sin(radians(4))));
    CHECK(has_own_attitude(leaning, tag) == (tag.name == "041R" || tag.name == "042L"));
  }
  CHECK(find_tag(leaning, "042L")->attitude->facing == Approx(radians(95)));
  const Survey by_side = with("tilt: { left: 4, right: -2 }, roll: { left: -3, right: 3 }");
  CHECK(facing(*find_tag(by_side, "003L")).z() == Approx(-std::sin(radians(4))));
  CHECK(facing(*find_tag(by_side, "003R")).z() == Approx(std::sin(radians(2))));
  // Both rise along the drive: the left plate's right edge, the right plate's left one.
  CHECK(find_tag(by_side, "003L")->world_from_plate.rotation(2, 0) > 0.05);
  CHECK(find_tag(by_side, "003R")->world_from_plate.rotation(2, 0) < -0.05);
  CHECK(survey_revision(leaning) != survey_revision(upright));
  CHECK(usual_attitudes_text(by_side) ==
        "every left plate leans 4 degrees forward, is turned 3 degrees anticlockwise; every right "
        "one leans 2 degrees back, is turned 3 degrees clockwise");
  for (const char* wrong : {"tilt: 90", "tilt: { left: 50 }", "tilt: [1, 2]", "roll: upright",
                            "tilt: { both: 3 }", "roll: -46"}) {
    CAPTURE(std::string(wrong));
    CHECK(has_errors(
        reading_of(replaced(plain, "pairs: 14", std::string("pairs: 14, ") + wrong)).diagnostics));
  }
}

TEST_CASE("attitudes are the same in a grid with x to the left, seen by a viewer") {
  const std::string keys =
      "placed:\n  - { tag: 040L, side: left, p: [1.9, 29.5, 1.4], facing: 60, "
      "tilt: 5, roll: 20 }\n";
  std::string text =
      replaced(drive(kPlain, keys), "survey: drive", "survey: drive\ngrid: { x_axis: left }");
  const PlacedTag tag = *find_tag(survey_of(text), "040L");
  const Vector3d out = facing(tag);
  // In the world x is mirrored: 60 degrees from +y towards the grid's +x are towards -x.
  CHECK(std::atan2(out.x(), out.y()) == Approx(radians(-60)));
  CHECK(out.z() == Approx(-std::sin(radians(5))));
  CHECK(tag.world_from_plate.rotation(2, 0) < 0);  // clockwise: F lower than P
}

TEST_CASE("a plate on a pillar is no plate off its wall, one that faces the rock is warned of") {
  const auto findings = [&](const std::string& entry) {
    return reading_of(drive(kPlain, "placed:\n  - { tag: 040L, side: left, " + entry + " }\n"))
        .diagnostics;
  };
  const std::vector<Diagnostic> pillar = findings("p: [-1.0, 29.0, 1.4], facing: 180");
  CHECK_FALSE(has_errors(pillar));
  CHECK(count_findings(pillar, "off-wall") == 0);
  CHECK(count_findings(pillar, "faces-rock") == 0);
  CHECK(count_findings(findings("p: [-1.0, 29.0, 1.4]"), "off-wall") == 1);
  CHECK(count_findings(findings("p: [-1.9, 29.0, 1.4], facing: 270"), "faces-rock") == 1);
  CHECK(count_findings(findings("p: [-1.9, 29.0, 1.4], facing: 90, tilt: 95"), "out-of-range") ==
        1);
  CHECK(count_findings(findings("p: [-1.9, 29.0, 1.4], facing: 90, tilt: 45"), "steep-tilt") == 1);
  CHECK(count_findings(findings("p: [-1.9, 29.0, 1.4], tilt: 25"), "steep-tilt") == 0);
  CHECK(count_findings(findings("p: [-1.0, 29.0, 1.4], facing: 180, tilt: 45"), "steep-tilt") == 0);
  // Behind the rock is an error whatever it faces.
  CHECK(count_findings(findings("p: [-2.3, 29.0, 1.4], facing: 180"), "off-wall") == 1);
}

TEST_CASE("how deep a plate lies in the rock is counted from the wall, not from the stand-off") {
  const auto findings = [&](const std::string& x) {
    return reading_of(drive(std::string(kPlain) + "  stand_off: 0.1\n",
                            "placed:\n  - { tag: 040L, side: left, p: [" + x + ", 29.0, 1.4] }\n"))
        .diagnostics;
  };
  CHECK(count_findings(findings("-1.95"), "off-wall") == 0);
  CHECK(count_findings(findings("-2.05"), "off-wall") == 1);  // 0.15 m behind the other plates
  CHECK_FALSE(has_errors(findings("-2.05")));
  CHECK(has_errors(findings("-2.15")));
}

TEST_CASE("sections, walls, stand-off, design and attitude change the revision") {
  const auto revision = [&](const std::string& text) { return survey_revision(survey_of(text)); };
  const std::string base = drive(kPlain);
  CHECK(revision(drive("  height: 3.0\n  sections: [ { at: 0, width: 3.8 } ]\n")) ==
        revision(base));
  CHECK(revision(drive("  height: 3.0\n  walls: { left: [[0, 1.9]], right: [[0, 1.9]] }\n")) ==
        revision(base));
  CHECK(revision(drive("  width: 3.8\n  height: 3.0\n  stand_off: 0.02\n")) != revision(base));
  const auto placed = [&](const std::string& keys) {
    return revision(drive(
        kPlain, "placed:\n  - { tag: 040L, side: left, p: [-1.9, 29.5, 1.4]" + keys + " }\n"));
  };
  CHECK(placed(", tilt: 1") != placed(""));
  CHECK(placed(", facing: 91") != placed(", facing: 92"));
  CHECK(placed(", design: [-1.9, 29.4, 1.4]") != placed(""));
}

TEST_CASE("long lists of stations are read without loss") {
  std::string room = "  height: 3\n  walls:\n    left:\n";
  for (int i = 0; i < 20'000; ++i) {
    room += "      - [" + std::to_string(i) + ", " + (i % 2 == 0 ? "2.0" : "2.1") + "]\n";
  }
  room += "    right: [[0, 2]]\n";
  const Survey survey = survey_of(drive(room));
  CHECK(wall_distance(survey.tunnel, Side::left, 10'001) == Approx(2.1));
  CHECK(wall_distance(survey.tunnel, Side::left, 10'000.5) == Approx(2.05));
}

TEST_CASE("a drive passes over itself where walls that face each other overlap") {
  struct Row {
    const char* name;
    std::string room;
    double radius;
    bool passes;
  };
  const std::string near_left = "  walls: { left: [[0, 1.2], [100, 1.2]], right: [[0, 3.8]] }\n";
  const std::string halls =
      "  sections: [ { at: 0, width: 6 }, { at: 12, width: 6 }, { at: 14, width: 3 },\n"
      "    { at: 40, width: 3 }, { at: 42, width: 6 }, { at: 70, width: 6 } ]\n";
  for (const Row& row : {Row{"a center line beside one wall", near_left, 2, false},
                         Row{"one wall", "  width: 5\n  walls: { left: [[0, 1]] }\n", 1.5, false},
                         Row{"halls narrower between", halls, 2.2, true},
                         Row{"halls farther apart", halls, 3.2, false}}) {
    CAPTURE(std::string(row.name));
    const std::string legs = "{ line: 25, grade: 12 }";
    const auto read = reading_of(
        "survey: drive\ntunnel:\n" + row.room +
        "  height: 3\n  centerline:\n    start: [0, 0, 0]\n    heading: 0\n    elements: [ " +
        legs + ", { arc: " + std::to_string(row.radius) +
        ", turn: left, angle: 180, grade: 12 }, " + legs +
        " ]\ntags: { template: tag-400x300, height: 1.2, spacing: 3, first: 2, pairs: 12 }\n"
        "code: { check_digit: gs1, resolution: 0.01, digits: [4, 4, 3], origin: [-20, -20, -1] "
        "}\n");
    const bool passes = std::ranges::any_of(read.diagnostics, [](const Diagnostic& diagnostic) {
      return diagnostic.code == "passes-over";
    });
    CHECK(passes == row.passes);
  }
}
