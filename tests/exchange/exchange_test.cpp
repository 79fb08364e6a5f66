// SPDX-License-Identifier: Apache-2.0
// Surveys out to other programs and back from surveyed points.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/tag_list.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/survey_exchange.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/exchange/drift_points.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

const char* kGradedSurvey = R"(survey: graded
tunnel:
  width: 4.2
  height: 3.4
  centerline:
    start: [51200.0, 38100.0, -412.0]
    heading: 35
    elements:
      - { line: 120.0, grade: 1.5 }
      - { arc: 60.0, turn: left, angle: 70 }
      - { line: 80.0, grade: -0.8 }
      - { arc: 30.0, turn: right, angle: 120 }
      - { line: 50.0 }
tags: { template: tag-800x430, height: 1.5, spacing: 9.2, first: 5, to: 320, sigma: 0.003 }
code: { check_digit: gs1, resolution: [0.1, 0.1, 0.1], digits: [4, 4, 3], origin: [50800, 37900, -420] }
placed:
  - { tag: 003R, side: right, p: [51222.18, 38128.01, -409.95], digits: "42222280101", sigma: 0.001, date: 2026-03-31 }
  - { tag: 900L, side: left, p: [51201.15, 38105.3, -411.0], design: [51201.15, 38105.33, -411.0] }
)";

// Niches whose steps lie between neighbouring plates, in a straight and in a bend.
const char* kNicheSurvey = R"(survey: niches
tunnel:
  height: 3.0
  walls:
    left:
      [[0, 2], [10, 2], [10, 2.8], [13, 2.8], [13, 2], [25, 2], [25, 2.8], [28, 2.8], [28, 2], [60, 2]]
    right: [[0, 2], [15, 2], [15, 3.5], [23, 3.5], [23, 2], [60, 2]]
  centerline:
    start: [500, 1200, 312]
    heading: 15
    elements: [ { line: 20 }, { arc: 20, turn: left, angle: 60 }, { line: 20 } ]
tags: { template: tag-400x300, height: 1.5, spacing: 0.9, first: 1, to: 56, sigma: 0.003 }
code: { check_digit: gs1, resolution: 0.01, digits: [4, 4, 3], origin: [430, 1190, 310] }
)";

// A passing bay, walls as surveyed, a low roof, plates on a pillar and leaning.
const char* kRealSurvey = R"(survey: real
tunnel:
  stand_off: 0.03
  sections:
    - { at: 0, height: 3.0 }
    - { at: 40, height: 3.4 }
  walls:
    left:
      - [0, 2.1]
      - [20, 2.4]
      - [32, 2.2]
      - [50, 2.1]
      - [80, 2.3]
    right:
      - [0, 2.0]
      - [24, 2.1]
      - [24, 3.6]
      - [40, 3.6]
      - [40, 2.0]
  centerline:
    start: [200.0, 100.0, 10.0]
    heading: 35
    elements:
      - { line: 25.0, grade: 2 }
      - { arc: 30.0, turn: right, angle: 60, grade: 2 }
      - { line: 24.0 }
tags: { template: tag-400x300, height: 1.4, spacing: 2.6, first: 2, to: 76, sigma: 0.004 }
code: { check_digit: gs1, digits: [4, 4, 3], origin: [195, 95, 5] }
placed:
  - { tag: 003R, side: right, p: [208.17, 108.15, 11.62], sigma: 0.001, date: 2026-03-31, tilt: 3, roll: -1.5 }
  - { tag: 900L, side: left, p: [207.21, 112.04, 11.68], facing: 215, date: 2026-04-01, design: [207.21, 112.0, 11.7] }
)";

}  // namespace

TEST_CASE("new writes a survey and a rig that read without findings, and never overwrites") {
  const TemporaryFolder folder;
  const fs::path drift_folder = folder.path() / "drift-7";
  const ProgramOutput made = run_tagsmith("new " + quoted(drift_folder));
  CHECK(made.exit_code == 0);
  const ProgramOutput valid = run_tagsmith("validate " + quoted(drift_folder / "survey.yaml") +
                                           " --rig " + quoted(drift_folder / "rig.yaml"));
  CHECK(valid.err == "2 files: 0 errors, 0 warnings\n");
  CHECK(load_survey(drift_folder / "survey.yaml").value().name == "drift-7");
  const ProgramOutput again = run_tagsmith("new " + quoted(drift_folder));
  CHECK(again.exit_code == 2);
  CHECK(again.err.find(drift_folder.string()) != std::string::npos);
  CHECK(run_tagsmith("new 12").exit_code == 2);
  CHECK_FALSE(fs::exists("12"));
}

TEST_CASE("export and new --from lose nothing of any tag") {
  const TemporaryFolder folder;
  write_text(folder.path() / "graded.yaml", kGradedSurvey);
  write_text(folder.path() / "real.yaml", kRealSurvey);
  write_text(folder.path() / "niches.yaml", kNicheSurvey);
  for (const fs::path& file :
       {fs::path("surveys/corridor/survey.yaml"), fs::path("surveys/corridor-table4/survey.yaml"),
        fs::path("surveys/curved/survey.yaml"), folder.path() / "graded.yaml",
        folder.path() / "real.yaml", folder.path() / "niches.yaml"}) {
    CAPTURE(file.string());
    const Survey before = load_survey(file).value();
    const fs::path csv = folder.path() / (before.name + ".csv");
    REQUIRE(run_tagsmith("export " + quoted(file) + " -o " + quoted(csv)).exit_code == 0);
    const fs::path out = folder.path() / before.name;
    const ProgramOutput made =
        run_tagsmith("new " + quoted(out) + " --from " + quoted(csv) + " --order own");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey after = load_survey(out / "survey.yaml").value();
    CHECK(after.grid.x_axis_left == before.grid.x_axis_left);
    CHECK(after.code.digit_counts == before.code.digit_counts);
    CHECK(after.code.origin == before.code.origin);
    if (before.name != "real" && before.name != "niches") {
      CHECK(width_at(after.tunnel, 0) == Approx(width_at(before.tunnel, 0)).epsilon(0.002));
    }
    REQUIRE(after.tags.size() == before.tags.size());
    for (std::size_t i = 0; i < after.tags.size(); ++i) {
      const PlacedTag& a = before.tags[i];
      const PlacedTag& b = after.tags[i];
      CAPTURE(a.name);
      CHECK(b.name == a.name);
      CHECK(b.digits == a.digits);
      CHECK(b.side == a.side);
      CHECK((b.p_in_grid - a.p_in_grid).cwiseAbs().maxCoeff() < 1e-6);
      CHECK((b.coded_in_grid - a.coded_in_grid).norm() < 1e-9);
      CHECK(b.sigma == Approx(a.sigma));
      CHECK(b.date == a.date);
      CHECK(b.design_in_grid.has_value() == a.design_in_grid.has_value());
      if (a.design_in_grid) CHECK((*b.design_in_grid - *a.design_in_grid).norm() < 2e-6);
      CHECK((b.world_from_plate.rotation - a.world_from_plate.rotation).norm() < 0.02);
    }
  }
}

TEST_CASE("shipped surveys come back with directions and positions within their stated accuracy") {
  struct Way {
    const char* survey;
    const char* file;
    const char* options;
  };
  for (const Way& way :
       {Way{"corridor", "c.csv", "--order own"}, Way{"corridor", "c.gsi", ""},
        Way{"corridor", "c.landxml", ""}, Way{"corridor-table4", "c.gsi", ""},
        Way{"curved", "c.csv", "--order own"}, Way{"curved", "c.gsi", ""},
        Way{"curved", "c.gsi", "--walls measured"}, Way{"curved", "c.landxml", ""},
        Way{"curved", "c.landxml", "--walls measured"}, Way{"drift", "c.csv", "--order own"}}) {
    CAPTURE(std::string(way.survey));
    CAPTURE(std::string(way.file));
    CAPTURE(std::string(way.options));
    const TemporaryFolder folder;
    const fs::path survey = fs::path("surveys") / way.survey / "survey.yaml";
    const fs::path list = folder.path() / way.file;
    REQUIRE(run_tagsmith("export " + quoted(survey) + " -o " + quoted(list)).exit_code == 0);
    const fs::path out = folder.path() / "out";
    const std::string command =
        "new " + quoted(out) + " --from " + quoted(list) + " " + way.options;
    ProgramOutput made = run_tagsmith(command);
    for (const char* unsaid : {" --tunnel-height 3", " --mount-height 0.5 --tunnel-height 3"}) {
      if (made.exit_code == 2) made = run_tagsmith(command + unsaid);
    }
    REQUIRE_MESSAGE(made.exit_code != 2, made.err);
    const Survey before = load_survey(survey).value();
    const Survey after = load_survey(out / "survey.yaml").value();
    CHECK(after.angle_sigma < radians(1));
    REQUIRE(after.tags.size() == before.tags.size());
    for (std::size_t i = 0; i < after.tags.size(); ++i) {
      const PlacedTag& tag = after.tags[i];
      CAPTURE(tag.name);
      const double off = std::remainder(
          facing_of(tag.world_from_plate) - facing_of(before.tags[i].world_from_plate),
          2 * std::numbers::pi);
      CHECK(std::abs(off) < 2 * after.angle_sigma + radians(0.001));
      CHECK((tag.p_in_grid - before.tags[i].p_in_grid).norm() < std::max(tag.sigma, 1e-4));
    }
  }
}

TEST_CASE("an assumed sigma is exported as none, and drawn as assumed") {
  const TemporaryFolder folder;
  std::string unstated = *read_file("surveys/curved/survey.yaml");
  const std::string key = "  sigma: 0.002\n";
  unstated.erase(unstated.find(key), key.size());
  const fs::path file = folder.path() / "unstated.yaml";
  write_text(file, unstated);
  const Survey survey = load_survey(file).value();
  CHECK(parsed_json(tags_json(survey))["assumed"] ==
        nlohmann::json::array({"survey curved states no sigma: 3 mm assumed"}));
  const fs::path csv = folder.path() / "tags.csv";
  write_text(csv, tags_csv(survey));
  PointListOptions own;
  own.order = "own";
  const auto points = read_point_list(csv, own).value();
  for (const SurveyedPoint& point : points.value.value().points) {
    CHECK_FALSE(point.sigma.has_value());
  }
  const auto drawn = [&](const fs::path& of) {
    const fs::path pdf = folder.path() / "drawing.pdf";
    REQUIRE(run_tagsmith("draw " + quoted(of) + " -o " + quoted(pdf)).exit_code == 0);
    return run_shell("pdftotext -layout " + quoted(pdf) + " -").out;
  };
  CHECK(drawn(file).find("survey accuracy not stated: 3 mm assumed") != std::string::npos);
  const std::string words = drawn("surveys/curved/survey.yaml");
  CHECK(words.find("a coordinate is surveyed to 0.002 m") != std::string::npos);
  CHECK(words.find("assumed") == std::string::npos);
}

TEST_CASE("the center line of a list without noise is found again") {
  const TemporaryFolder folder;
  const fs::path csv = folder.path() / "c.csv";
  REQUIRE(run_tagsmith("export surveys/curved/survey.yaml -o " + quoted(csv)).exit_code == 0);
  REQUIRE(
      run_tagsmith("new " + quoted(folder.path() / "c") + " --from " + quoted(csv) + " --order own")
          .exit_code == 0);
  const Survey before = load_survey("surveys/curved/survey.yaml").value();
  const Survey after = load_survey(folder.path() / "c" / "survey.yaml").value();
  const auto& elements = after.tunnel.centerline.elements();
  REQUIRE(elements.size() == 2);
  CHECK(elements[0].length == Approx(2).epsilon(1e-4));
  CHECK(elements[0].curvature == 0);
  CHECK(1 / elements[1].curvature == Approx(8).epsilon(1e-5));
  for (std::size_t i = 0; i < after.tags.size(); ++i) {
    CHECK(after.tags[i].chainage == Approx(before.tags[i].chainage).epsilon(1e-4));
  }
}

TEST_CASE("points of walls, floor, roof and tags with 5 mm of noise become the tunnel") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    const TemporaryFolder folder;
    const PointWriter points = surveyed_drift(0.005, seed);
    const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    CHECK(made.out.find("70 points: tunnel 4.") != std::string::npos);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    CHECK(std::abs(width_at(survey.tunnel, 0) - 4.2) < 0.005);
    CHECK(std::abs(survey.tunnel.height.at(0) - 3.1) < 0.01);
    REQUIRE(survey.tags.size() == 6);
    CHECK(survey.tags[5].name == "002R");
    // The noise of 5 mm, measured over 54 points and rounded up, stands in the draft.
    CHECK(survey.states_sigma);
    CHECK(survey.sigma >= 0.004);
    CHECK(survey.sigma <= 0.006);
    CHECK(survey.tags[0].sigma == survey.sigma);
    for (const CenterlineElement& element : survey.tunnel.centerline.elements()) {
      CHECK(element.grade == Approx(0.015).epsilon(0.1));
    }
    for (double chainage = 3; chainage < 70; chainage += 5) {
      const CenterlinePoint at = drift().at(chainage);
      CHECK(std::abs(survey.tunnel.centerline.locate(at.position.head<2>()).offset) < 0.02);
    }
  }
}

TEST_CASE("grades follow a sag as far as the floor's points show it, and not their noise") {
  struct Row {
    double sag;  // metres over 40 m
    double noise;
    double off;
    std::size_t elements;
  };
  for (const Row& row : {Row{0.75, 0.003, 0.018, 13}, Row{0, 0.025, 0.03, 2}}) {
    CAPTURE(row.sag);
    std::mt19937 random(3);
    std::normal_distribution<double> error(0, row.noise);
    const auto height = [&](double at) { return row.sag * std::pow(at / 20 - 1, 2); };
    std::string csv;
    for (int i = 0; i <= 40; ++i) {
      csv += fmt::format("p,-2,{},1,WL\np,2,{},1,WR\np,0,{},{:.3f},FL\n", i, i, i,
                         height(i) + error(random));
    }
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), csv, "--order PENZD --tunnel-height 3 --height 1.4 --spacing 1.6");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    const Centerline& line = survey.tunnel.centerline;
    CHECK(line.elements().size() <= row.elements);
    for (double at = 0; at <= 40; at += 0.5) {
      CAPTURE(at);
      const double chainage = line.locate({0, at}).chainage;
      CHECK(std::abs(line.at(chainage).position.z() - height(at)) < row.off);
    }
  }
}

TEST_CASE("tags that scatter more than the walls say the draft's sigma") {
  const TemporaryFolder folder;
  PointWriter points = surveyed_drift(0.0005);
  const auto is_tag_code = [](const auto& point) { return point.code.starts_with('T'); };
  std::erase_if(points.points, is_tag_code);
  PointWriter rougher(0.008, 2);
  for (int i = 0; i < 20; ++i) {
    rougher.add(4 + 3 * i, -2.1, 1.4, "TL");
    rougher.add(4 + 3 * i, 2.1, 1.4, "TR");
  }
  points.points.insert(points.points.end(), rougher.points.begin(), rougher.points.end());
  const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(survey.states_sigma);
  CHECK(survey.sigma >= 0.007);
  CHECK(survey.sigma <= 0.011);
}

TEST_CASE("walls that run through their points are drafted when they are asked for") {
  PointWriter points(0, 1);
  const auto left = [](double at) { return 2.0 + 0.02 * at; };
  for (int i = 0; i < 24; ++i) points.add(1 + 3 * i, -left(1 + 3 * i), 1.3, "WL");
  for (int i = 0; i < 24; ++i) points.add(1.7 + 3 * i, i < 12 ? 2.1 : 3.4, 1.3, "WR");
  for (int i = 0; i < 24; ++i) points.add(1 + 3 * i, 0, 0, "CL");
  for (int i = 0; i < 5; ++i) points.add(5 + 15 * i, 0, 3.1 + 0.01 * i, "RF");
  for (int i = 0; i < 3; ++i) points.add(4 + 9 * i, -left(4 + 9 * i), 1.4, "TL");
  const TemporaryFolder folder;
  const std::string csv = points.text("PENZD");
  const ProgramOutput even = draft(folder.path(), csv, "--order PENZD");
  CHECK(even.exit_code == 2);  // no one width
  const ProgramOutput made = draft(folder.path(), csv, "--order PENZD --walls measured");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  CHECK(made.err.find("survey.yaml written: 0 errors") != std::string::npos);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK_FALSE(survey.states_sigma);  // walls through their points measure nothing
  const Tunnel& tunnel = survey.tunnel;
  for (double chainage = 2; chainage < 65; chainage += 7) {
    CAPTURE(chainage);
    const CenterlinePoint at = drift().at(chainage);
    const double here = tunnel.centerline.locate(at.position.head<2>()).chainage;
    CHECK(wall_distance(tunnel, Side::left, here) == Approx(left(chainage)).epsilon(0.005));
    const bool beside_step = std::abs(chainage - 36.2) < 3;
    if (beside_step) continue;
    CHECK(wall_distance(tunnel, Side::right, here) ==
          Approx(chainage < 36 ? 2.1 : 3.4).epsilon(0.001));
  }
  CHECK(tunnel.height.greatest() == Approx(3.14).epsilon(0.002));
  CHECK_FALSE(tunnel.height.is_constant());
}

TEST_CASE(
    "plates on rough rock face along the drive within the angle_sigma that their draft states") {
  const double heading = radians(30);
  const Centerline line({500, 1200, 312}, heading, {{40, 0, 0}});
  for (const double roughness : {0.003, 0.01, 0.02}) {
    CAPTURE(roughness);
    std::mt19937 random(8);
    std::normal_distribution<double> rock(0, roughness);
    std::string csv;
    const auto add = [&](double chainage, double offset, double height, const char* code) {
      const CenterlinePoint at = line.at(chainage);
      const Eigen::Vector3d p = at.position + offset * right_of(at.heading);
      csv += fmt::format("p,{:.3f},{:.3f},{:.3f},{}\n", p.x(), p.y(), p.z() + height, code);
    };
    for (int i = 0; i <= 80; ++i) add(0.5 * i, -2 + rock(random), 1.2, "WL");
    for (int i = 0; i <= 80; ++i) add(0.5 * i, 2 + rock(random), 1.2, "WR");
    for (int i = 0; i <= 20; ++i) add(2 * i, 0, 0, "CL");
    for (int i = 1; i < 19; ++i) add(2 * i, -1.99, 1.2, "TL");
    for (int i = 1; i < 19; ++i) add(2 * i, 1.99, 1.2, "TR");
    const TemporaryFolder folder;
    const ProgramOutput made = draft(
        folder.path(), csv, "--order PENZD --walls measured --tolerance 100 --tunnel-height 3");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    CHECK(made.err.find("rough-wall") == std::string::npos);
    const fs::path file = folder.path() / "out" / "survey.yaml";
    const Survey survey = load_survey(file).value();
    CHECK(survey.states_angle_sigma);
    CHECK(survey.angle_sigma < radians(4));
    for (const PlacedTag& tag : survey.tags) {
      const double away = tag.side == Side::left ? radians(90) : radians(-90);
      const double off =
          std::remainder(facing_of(tag.world_from_plate) - heading - away, 2 * std::numbers::pi);
      CHECK(std::abs(off) < 3.5 * survey.angle_sigma);
    }
    if (roughness < 0.01) continue;
    // The same walls, written by hand.
    const std::string text = read_file(file).value();
    const std::regex stated("  angle_sigma:.*\n.*\n");
    write_text(file, std::regex_replace(text, stated, "  angle_sigma: 0.3\n"));
    CHECK(run_tagsmith("validate " + quoted(file)).out.find("[rough-wall]") != std::string::npos);
    write_text(file, std::regex_replace(text, stated, ""));
    CHECK(load_survey(file).value().angle_sigma == Approx(survey.angle_sigma));
  }
}

TEST_CASE("new says what validate says of its draft, and exits with 1 for errors") {
  const TemporaryFolder folder;
  PointWriter points = surveyed_drift(0);
  points.add(4.1, -2.1, 1.4, "000L");  // on the spot of another one
  points.add(4.2, -2.1, 1.4, "001L");
  const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
  CHECK(made.exit_code == 1);
  CHECK(made.err.find("[overlap]") != std::string::npos);
  CHECK(made.err.find(" errors, ") != std::string::npos);
  CHECK(fs::exists(folder.path() / "out" / "survey.yaml"));
}

TEST_CASE("several drives are drawn in one plan, if they have one grid") {
  const TemporaryFolder folder;
  const fs::path pdf = folder.path() / "all.pdf";
  const ProgramOutput drawn =
      run_tagsmith("draw surveys/curved/survey.yaml surveys/drift/survey.yaml -o " + quoted(pdf));
  CHECK_MESSAGE(drawn.exit_code == 0, drawn.err);
  CHECK(fs::exists(pdf));
  const ProgramOutput refused =
      run_tagsmith("draw surveys/curved/survey.yaml surveys/corridor/survey.yaml -o " +
                   quoted(folder.path() / "no.pdf"));
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("x_axis") != std::string::npos);
}

TEST_CASE("exports carry walls, stand-off and attitudes") {
  const TemporaryFolder folder;
  write_text(folder.path() / "real.yaml", kRealSurvey);
  const Survey survey = load_survey(folder.path() / "real.yaml").value();
  const auto json = parsed_json(tags_json(survey));
  CHECK(json["tunnel"]["stand_off"] == 0.03);
  CHECK(json["tunnel"]["walls"]["left"].size() == 5);
  CHECK(json["tunnel"]["walls"]["right"][2] == nlohmann::json::array({24.0, 3.6}));
  CHECK(json["tunnel"]["sections"][1]["height"] == 3.4);
  for (const auto& tag : json["tags"]) {
    if (tag["tag"] == "003R") CHECK(tag["tilt_deg"].get<double>() == Approx(3));
    if (tag["tag"] == "900L") CHECK(tag["facing_deg"].get<double>() == Approx(215));
  }
  const auto layout = parsed_json(field_layout_json(survey));
  const auto& turn = layout["tags"][7]["pose"]["rotation"]["quaternion"];  // 003R
  const Eigen::Quaterniond q(turn["W"].get<double>(), turn["X"].get<double>(),
                             turn["Y"].get<double>(), turn["Z"].get<double>());
  const PlacedTag& leaning = *find_tag(survey, "003R");
  CHECK((q * Eigen::Vector3d::UnitX() + leaning.world_from_plate.rotation.col(2)).norm() < 1e-9);
  CHECK((q * Eigen::Vector3d::UnitZ() + leaning.world_from_plate.rotation.col(1)).norm() < 1e-9);
  // The step of the passing bay is a line across in the DXF.
  const std::string dxf = render_dxf(survey);
  const CenterlinePoint at = survey.tunnel.centerline.at(24);
  for (const double offset : {2.1, 3.6}) {
    const Eigen::Vector3d p = at.position + offset * right_of(at.heading);
    CHECK(dxf.find(fmt::format("{:.6f}\n 20\n{:.6f}\n", p.x(), p.y())) != std::string::npos);
  }
}

TEST_CASE("the same points in another declared order give the same survey") {
  const TemporaryFolder folder;
  const PointWriter points = surveyed_drift(0);
  REQUIRE(draft(folder.path(), points.text("PENZD"), "--order PENZD").exit_code == 0);
  const std::string first = read_file(folder.path() / "out" / "survey.yaml").value();
  fs::remove_all(folder.path() / "out");
  REQUIRE(draft(folder.path(), points.text("DNEZP"), "--order DNEZP").exit_code == 0);
  CHECK(read_file(folder.path() / "out" / "survey.yaml").value() == first);
}

TEST_CASE("what fits no tunnel is refused with its point and its line, and nothing is written") {
  PointWriter good = surveyed_drift(0.003);
  PointWriter jump = good;
  jump.points[29].p.y() += 27;  // 147.19 for 174.19
  PointWriter codes = good;
  codes.points[3].code = "XX";
  PointWriter one_wall = good;
  std::erase_if(one_wall.points, [](const auto& point) { return point.code != "WL rib"; });
  PointWriter no_floor = good;
  std::erase_if(no_floor.points, [](const auto& point) { return point.code == "FL"; });
  PointWriter no_roof = good;
  std::erase_if(no_roof.points, [](const auto& point) { return point.code == "RF"; });
  PointWriter floor_jump = good;
  floor_jump.points[50].p.z() += 2;
  PointWriter floor_beyond = good;
  floor_beyond.add(110, 0, 1, "FL");
  PointWriter exchanged_tags = good;
  for (auto& point : exchanged_tags.points) {
    if (point.code.starts_with('T')) point.code = point.code == "TL" ? "TR" : "TL";
  }
  PointWriter bay = good;
  for (std::size_t i = 34; i < 42; ++i) bay.points[i].p += 1.5 * right_of(radians(-10));
  std::string decimal_commas = good.text("PENZD");
  std::ranges::replace(decimal_commas, '.', ',');
  struct Row {
    const char* name;
    std::string csv;
    const char* order;
    const char* message;
    const char* more = "";
  };
  for (const Row& row :
       {Row{"a wrong coordinate", jump.text("PENZD"), "PENZD", "line 30: point 30 (right wall)"},
        Row{"east and north exchanged", good.text("PNEZD"), "PENZD",
            "the left points lie to the right"},
        Row{"an unknown description", codes.text("PENZD"), "PENZD",
            "points.csv:4:5: error: point 4 has the description `XX`"},
        Row{"one wall", one_wall.text("PENZD"), "PENZD", "no points on the right wall",
            " --height 1 --spacing 1"},
        Row{"no floor", no_floor.text("PENZD"), "PENZD", "--mount-height"},
        Row{"no roof", no_roof.text("PENZD"), "PENZD", "--tunnel-height"},
        Row{"a wrong floor height", floor_jump.text("PENZD"), "PENZD", "line 51: point 51 (floor)"},
        Row{"a floor beyond the walls", floor_beyond.text("PENZD"), "PENZD",
            "beyond the points of walls"},
        Row{"tags of the other side", exchanged_tags.text("PENZD"), "PENZD",
            "are left and right exchanged in their names"},
        Row{"a bay without a center line", bay.text("PENZD"), "PENZD", "or list points CL",
            " --walls measured"},
        Row{"decimal commas", decimal_commas, "PENZD", "with decimal commas, semicolons or tabs"},
        Row{"points between thousands", "1;1.200,5;2,5;3,5;WL\n2;1.210,5;2,5;3,5;WL\n", "PENZD",
            "without signs between the thousands"},
        Row{"a comment", "# surveyed\n" + good.text("PENZD"), "PENZD",
            "take out lines that are no points"},
        Row{"a header", "point,east,north,z,code\n" + good.text("PENZD"), "PENZD", "--header"},
        Row{"another separator", "1 2 3 4 WL\n", "PENZD", "1 by commas"},
        Row{"nothing", "", "PENZD", "has no points"},
        Row{"two points", "1,0,0,0,WL\n2,3,0,0,WR\n", "PENZD", "too few points",
            " --height 1 --spacing 1"},
        Row{"an order without heights", good.text("PENZD"), "PEND", "expected all of P"},
        Row{"a list that is not ours", good.text("PENZD"), "own",
            "not those of `tagsmith export`"}}) {
    CAPTURE(std::string(row.name));
    const TemporaryFolder folder;
    const ProgramOutput refused =
        draft(folder.path(), row.csv, std::string("--order ") + row.order + row.more);
    CHECK(refused.exit_code == 2);
    CHECK_MESSAGE(refused.err.find(row.message) != std::string::npos, refused.err);
    CHECK_FALSE(fs::exists(folder.path() / "out"));
  }
}

TEST_CASE("walls without tags become a layout that validate, plan and print accept") {
  const TemporaryFolder folder;
  PointWriter points = surveyed_drift(0.003);
  std::erase_if(points.points, [](const auto& point) { return point.code.starts_with('T'); });
  const std::string csv = points.text("PENZD");
  const ProgramOutput asked = draft(folder.path(), csv, "--order PENZD");
  CHECK(asked.exit_code == 2);
  for (const char* option : {"--height", "--spacing", "--first", "--to"}) {
    CHECK(asked.err.find(option) != std::string::npos);
  }
  CHECK_FALSE(fs::exists(folder.path() / "out"));
  const ProgramOutput roof = draft(folder.path(), csv, "--order PENZD --height 3.1 --spacing 2.6");
  CHECK(roof.exit_code == 2);
  CHECK(roof.err.find("[outside-tunnel]") != std::string::npos);
  const ProgramOutput none =
      draft(folder.path(), csv, "--order PENZD --height 1 --spacing 2 --first 50 --to 40");
  CHECK(none.exit_code == 2);
  CHECK(none.err.find("--first") != std::string::npos);
  CHECK_FALSE(fs::exists(folder.path() / "out"));

  const ProgramOutput made = draft(folder.path(), csv, "--order PENZD --height 1.4 --spacing 2.6");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  CHECK(made.err.find("0 errors, 0 warnings") != std::string::npos);
  const fs::path file = folder.path() / "out" / "survey.yaml";
  const Survey survey = load_survey(file).value();
  REQUIRE(survey.series.has_value());
  // Every 3 m from the first to the last points of the walls, 69.7 m apart.
  CHECK(survey.series->pairs == 24);
  CHECK(survey.tags.size() == 48);
  CHECK(survey.code.resolution[0] == Approx(0.01));
  const Centerline& line = survey.tunnel.centerline;
  for (const PlacedTag& tag : survey.tags) {
    const double floor = line.at(tag.chainage).position.z();
    CHECK(tag.p_in_grid.z() - floor == Approx(1.4));
    CHECK(tag.chainage > 0.3);
    CHECK(tag.chainage < line.length() - 0.4);
  }
  const ProgramOutput plan =
      run_tagsmith("plan " + quoted(file) + " --rig surveys/corridor/rig.yaml --json");
  CHECK(plan.exit_code < 2);  // 1: the corridor's crawler does not see all of it
  CHECK(parsed_json(plan.out).is_object());
  for (const std::string& command :
       {"draw " + quoted(file) + " -o " + quoted(folder.path() / "drawing.pdf"),
        "print " + quoted(file) + " --tags 000L,023R -o " + quoted(folder.path() / "print")}) {
    CHECK_MESSAGE(run_tagsmith(command).exit_code == 0, command);
  }
  const ProgramOutput again = draft(folder.path(), surveyed_drift(0.003).text("PENZD"),
                                    "--order PENZD --height 1.4 --spacing 2.6");
  CHECK(again.exit_code == 2);  // tags hang already
}

TEST_CASE("the table for people says in millimetres what JSON says in metres") {
  const TemporaryFolder folder;
  const std::string csv = surveyed_drift(0.003).text("PENZD");
  const auto lines_of = [&](const std::string& arguments) {
    fs::remove_all(folder.path() / "out");
    const ProgramOutput output = draft(folder.path(), csv, "--order PENZD" + arguments);
    REQUIRE_MESSAGE(output.exit_code == 0, output.err);
    return split(output.out, '\n');
  };
  const std::vector<std::string> objects = lines_of(" --json");
  const std::vector<std::string> table = lines_of("");
  int compared = 0;
  for (std::size_t i = 0; i + 1 < table.size() && objects[i].starts_with("{\"line\""); ++i) {
    const auto across = parsed_json(objects[i])["across"];
    if (!across.is_number()) continue;
    const std::string words = fmt::format("{:+.1f}", 1000 * across.get<double>() + 0.0);
    CHECK_MESSAGE(table[i + 1].find(" " + words + " ") != std::string::npos, table[i + 1]);
    ++compared;
  }
  CHECK(compared > 20);
}

TEST_CASE(
    "lists too sparse to show a bend are refused with the remedy that more points are listed") {
  const auto refused_with = [](double pitch) {
    PointWriter points(0.002, 1);
    for (double at = 1; at < 74; at += pitch) {
      points.add(at, -2.1, 1.4, "TL");
      points.add(at, 2.1, 1.4, "TR");
    }
    points.points[4].p += 0.6 * right_of(radians(20));
    const TemporaryFolder folder;
    const ProgramOutput made = draft(folder.path(), points.text("PENZD"),
                                     "--order PENZD --tunnel-height 3 --mount-height 1.4");
    REQUIRE(made.exit_code == 2);
    CHECK(made.err.find("exchanged in their names") == std::string::npos);
    return made.err.find("list more points of its walls") != std::string::npos;
  };
  CHECK(refused_with(7));
  CHECK_FALSE(refused_with(2));
}

TEST_CASE("rough rock is refused with its scatter and the tolerance that takes it") {
  const TemporaryFolder folder;
  PointWriter points = surveyed_drift(0.003);
  std::mt19937 random(5);
  std::normal_distribution<double> rock(0, 0.15);
  for (auto& point : points.points) {
    const bool is_wall = point.code == "WL rib" || point.code == "wr";
    const Eigen::Vector2d at = point.p.head<2>();
    const double heading = drift().at(drift().locate(at).chainage).heading;
    if (is_wall) point.p += rock(random) * right_of(heading);
  }
  std::erase_if(points.points, [](const auto& point) { return point.code.starts_with('T'); });
  const std::string layout = "--order PENZD --height 1.4 --spacing 2.6 ";
  const ProgramOutput refused = draft(folder.path(), points.text("PENZD"), layout);
  REQUIRE(refused.exit_code == 2);
  const std::string key = "--tolerance ";
  const std::size_t at = refused.err.find(key);
  REQUIRE_MESSAGE(at != std::string::npos, refused.err);
  const double mm = std::stod(refused.err.substr(at + key.size()));
  CHECK(mm >= 300);
  CHECK(mm <= 700);
  for (const char* walls : {"parallel", "measured"}) {
    const ProgramOutput made = draft(folder.path(), points.text("PENZD"),
                                     layout + fmt::format("--tolerance {} --walls {}", mm, walls));
    CHECK_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    CHECK(survey.tunnel.left.is_constant() == (std::string(walls) == "parallel"));
    CHECK_FALSE(survey.states_sigma);
    fs::remove_all(folder.path() / "out");
  }
}

// The list is refused by this rule at the line of its point `index`.
void check_refused_at(const PointWriter& points, std::size_t index, const std::string& rule) {
  const TemporaryFolder folder;
  const ProgramOutput refused = draft(folder.path(), points.text("PENZD"), "--order PENZD");
  CHECK(refused.exit_code == 2);
  const std::string place = fmt::format("points.csv:{}: error: ", index + 1);
  CHECK_MESSAGE(refused.err.find(place) != std::string::npos, refused.err);
  CHECK(refused.err.find("[" + rule + "]") != std::string::npos);
}

TEST_CASE("one point with east and north exchanged is named, whatever it is") {
  for (const std::size_t index : {0U, 30U, 50U, 61U, 65U}) {
    CAPTURE(index);
    PointWriter points = surveyed_drift(0.003);
    std::swap(points.points[index].p.x(), points.points[index].p.y());
    check_refused_at(points, index, "exchanged-axes");
  }
}

TEST_CASE("one point with a mistyped digit far from the others is named, whatever it is") {
  for (const std::size_t index : {0U, 15U, 30U, 50U, 61U, 65U}) {
    for (const Eigen::Vector3d& slip :
         {Eigen::Vector3d(90, 0, 0), Eigen::Vector3d(0, -20'000, 0), Eigen::Vector3d(0, 0, 2000)}) {
      CAPTURE(index);
      CAPTURE(slip.transpose());
      PointWriter points = surveyed_drift(0.003);
      points.points[index].p += slip;
      check_refused_at(points, index, "far-point");
    }
  }
}

TEST_CASE("a point that continues the tunnel after a gap is not far from it") {
  PointWriter points(0.003, 1);
  for (int i = 0; i < 6; ++i) points.add(1 + 3 * i, -2.1, 1.3, "WL");
  for (int i = 0; i < 6; ++i) points.add(1 + 3 * i, 2.1, 1.3, "WR");
  for (int i = 0; i < 3; ++i) points.add(2 + 6 * i, 0, 0, "FL");
  points.add(5, 0, 3.1, "RF");
  points.add(4, -2.1, 1.4, "TL");
  points.add(29.5, -2.1, 1.3, "WL");  // 13 m beyond the others, in line with them
  const TemporaryFolder folder;
  const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
  CHECK_MESSAGE(made.exit_code == 0, made.err);
}

TEST_CASE("a slip of 100 mm in one height is named where the others keep to 3 mm") {
  for (const std::size_t index : {4U, 30U, 51U, 55U}) {  // walls, floor
    for (const double slip : {-0.1, 0.1}) {
      CAPTURE(index);
      const TemporaryFolder folder;
      PointWriter points = surveyed_drift(0.003);
      points.points[index].p.z() += slip;
      const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
      REQUIRE_MESSAGE(made.exit_code == 0, made.err);
      const std::string place = fmt::format("points.csv:{}: warning: ", index + 1);
      CHECK_MESSAGE(made.err.find(place) != std::string::npos, made.err);
      std::size_t count = 0;
      for (auto at = made.err.find("[height-slip]"); at != std::string::npos;
           at = made.err.find("[height-slip]", at + 1)) {
        ++count;
      }
      CHECK(count == 1);
      const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
      for (const CenterlineElement& element : survey.tunnel.centerline.elements()) {
        CHECK(element.grade == Approx(0.015).epsilon(0.1));
      }
    }
  }
  const TemporaryFolder folder;
  const PointWriter good = surveyed_drift(0.003);
  CHECK(draft(folder.path(), good.text("PENZD"), "--order PENZD").err.find("height-slip") ==
        std::string::npos);
}

TEST_CASE("plates that are proposed where no wall was surveyed are named") {
  const auto said_without = [](double from, double to, const char* code) {
    PointWriter points(0.003, 1);
    for (int i = 0; i < 60; ++i) {
      for (const char* wall : {"WL", "WR"}) {
        const bool left_out = std::string(wall) == code && i > from && i < to;
        if (!left_out) points.add(1 + i, wall == std::string("WL") ? -2.1 : 2.1, 1.3, wall);
      }
    }
    for (int i = 0; i < 60; i += 3) points.add(1 + i, 0, 0, "FL");
    const TemporaryFolder folder;
    const ProgramOutput made = draft(folder.path(), points.text("PENZD"),
                                     "--order PENZD --tunnel-height 3 --height 1.4 --spacing 1.6");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    return made.err;
  };
  CHECK(said_without(0, 0, "WR").find("no-wall") == std::string::npos);
  const std::string side_drift = said_without(17, 25, "WR");
  CHECK(side_drift.find("no point of the right wall between 17.4 and 25.4 m, others are 1.0 m "
                        "apart [no-wall]") != std::string::npos);
  CHECK(side_drift.find("tags 009R to 012R: ") != std::string::npos);
  const std::string half = said_without(17, 60, "WL");
  CHECK(half.find("no point of the left wall beyond 17.4 m") != std::string::npos);
  CHECK(half.find("right wall") == std::string::npos);
}

TEST_CASE("a bend that hardly more points than it needs show is warned of") {
  const std::string floor = "7,500.1,1201.0,312,FL\n8,502.1,1208.7,312,FL\n";
  const auto said = [&](const std::string& walls) {
    const TemporaryFolder folder;
    const ProgramOutput made = draft(folder.path(), walls + floor,
                                     "--order PENZD --tunnel-height 2.8 --height 1.2 --spacing 2");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    return made.err;
  };
  // Of a straight drive, with errors of a decimetre.
  const std::string rough =
      "1,498.746,1200.388,313.2,WL\n2,500.064,1205.218,313.2,WL\n3,501.151,1210.047,313.2,WL\n"
      "4,501.336,1199.612,313.2,WR\n5,502.581,1204.441,313.2,WR\n6,504.044,1209.271,313.2,WR\n";
  CHECK(said(rough).find("points.csv:1: warning: 6 points determine a drive of 2 elements, and "
                         "none is left to check it [unchecked-shape]") != std::string::npos);
  const std::string straight =
      "1,498.5,1200,313.2,WL\n2,498.5,1205,313.2,WL\n3,498.5,1210,313.2,WL\n"
      "4,501.5,1200,313.2,WR\n5,501.5,1205,313.2,WR\n6,501.5,1210,313.2,WR\n";
  CHECK(said(straight).find("unchecked-shape") == std::string::npos);
}

TEST_CASE("a point that the fitted tunnel follows alone is named") {
  const std::string walls =
      "1,498.553,1200.388,313.2,WL\n2,499.847,1205.218,313.2,WL\n3,501.141,1210.047,313.2,WL\n"
      "4,501.451,1199.612,313.2,WR\n5,502.745,1204.441,313.2,WR\n6,504.039,1209.271,313.2,WR\n"
      "7,500.259,1200.966,312.0,FL\n8,502.330,1208.693,312.0,FL\n9,502.098,1202.026,313.2,TR\n";
  const auto said = [&](const std::string& left_tag) {
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), walls + left_tag, "--order PENZD --tunnel-height 2.8");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    return made.err;
  };
  CHECK(said("10,498.941,1201.837,313.2,TL\n").find("unchecked-shape") == std::string::npos);
  // Ten metres too far north: an arc at the end of the drive leads to it.
  CHECK(said("10,498.941,1211.837,313.2,TL\n")
            .find("points.csv:10: warning: the tunnel follows point 10 (left tag) alone") !=
        std::string::npos);
}

TEST_CASE("a slip of 15 mm across is named where the others keep to 1 mm") {
  for (const std::size_t index : {4U, 30U, 65U}) {  // walls, a tag
    CAPTURE(index);
    const TemporaryFolder folder;
    PointWriter points = surveyed_drift(0.001);
    points.points[index].p += 0.015 * right_of(radians(20));
    const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const std::string place = fmt::format("points.csv:{}: warning: ", index + 1);
    CHECK_MESSAGE(made.err.find(place) != std::string::npos, made.err);
    CHECK(made.err.find("[across-slip]") == made.err.rfind("[across-slip]"));
  }
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    const TemporaryFolder folder;
    const PointWriter good = surveyed_drift(0.003, seed);
    CHECK(draft(folder.path(), good.text("PENZD"), "--order PENZD").err.find("across-slip") ==
          std::string::npos);
  }
}

TEST_CASE("a drive that passes over itself is refused as that") {
  struct Row {
    const char* name;
    double turn;  // degrees
    bool passes;
  };
  for (const Row& row :
       {Row{"a spiral", 500, true}, Row{"a loop that crosses its begin", 330, true},
        Row{"a switchback", 180, false}}) {
    CAPTURE(std::string(row.name));
    const double radius = row.passes ? 20 : 5;  // the switchback's walls are 6 m apart
    const Centerline line(
        {500, 1200, 312}, 0,
        {{20, 0, 0.14}, {radius * radians(row.turn), 1 / radius, 0.14}, {20, 0, 0.14}});
    std::string csv;
    for (const char* code : {"WL", "WR", "FL", "RF"}) {
      for (double at = 0; at < line.length(); at += 2) {
        const CenterlinePoint place = line.at(at);
        const double offset = code == std::string("WL") ? -2 : code == std::string("WR") ? 2 : 0;
        const double height = code == std::string("FL") ? 0 : code == std::string("RF") ? 3 : 1.2;
        const Eigen::Vector3d p = place.position + offset * right_of(place.heading);
        csv += fmt::format("p,{:.3f},{:.3f},{:.3f},{}\n", p.x(), p.y(), p.z() + height, code);
      }
    }
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), csv, "--order PENZD --height 1.2 --spacing 1.6");
    CHECK_MESSAGE(made.exit_code == (row.passes ? 2 : 0), made.err);
    CHECK((made.err.find("the drive passes over itself") != std::string::npos) == row.passes);
    const fs::path file = folder.path() / "ramp.yaml";
    write_text(
        file,
        fmt::format(
            "survey: ramp\ntunnel:\n  width: 4\n  height: 3\n  centerline:\n"
            "    start: [500, 1200, 312]\n    heading: 0\n    elements:\n"
            "      - {{ line: 20, grade: 14 }}\n"
            "{}      - {{ line: 20, grade: 14 }}\n"
            "tags: {{ template: tag-400x300, height: 1.2, spacing: 1.6, first: 1, pairs: 3 }}\n"
            "code: {{ check_digit: gs1, digits: [4, 4, 3], origin: [450, 1150, 300] }}\n",
            fmt::format("      - {{ arc: {}, turn: right, angle: {}, grade: 14 }}\n"
                        "      - {{ arc: {}, turn: right, angle: {}, grade: 14 }}\n",
                        radius, row.turn / 2, radius, row.turn / 2)));
    const std::string said = run_tagsmith("validate " + quoted(file)).out;
    CHECK_MESSAGE((said.find("[passes-over]") != std::string::npos) == row.passes, said);
    CHECK(said.find("roof") == std::string::npos);  // of another turn
  }
}

TEST_CASE("roof points in cross sections are no slips of height") {
  PointWriter points = surveyed_drift(0.003);
  for (int section = 0; section < 20; ++section) {
    for (const double offset : {-1.9, -1.0, 0.0, 1.0, 1.9}) {
      points.add(3 * section, offset, 3.5 - 0.4 * std::abs(offset), "RF");
    }
  }
  const TemporaryFolder folder;
  const ProgramOutput made = draft(folder.path(), points.text("PENZD"), "--order PENZD");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  CHECK_MESSAGE(made.err.find("height-slip") == std::string::npos, made.err);
}

TEST_CASE("a drive of 1.2 km is coded coarsely and says so, or is split") {
  const TemporaryFolder folder;
  const Centerline line({1000, 2000, 100}, radians(40),
                        {{500, 0, 0.01}, {300 * radians(50), 1 / 300.0, 0.01}, {440, 0, 0.01}});
  std::string csv;
  const auto add = [&](double chainage, double offset, double height, const std::string& code) {
    const CenterlinePoint at = line.at(chainage);
    const Eigen::Vector3d p = at.position + offset * right_of(at.heading);
    csv += fmt::format("p,{:.3f},{:.3f},{:.3f},{}\n", p.x(), p.y(), p.z() + height, code);
  };
  for (double at = 0; at < 1200; at += 10) {
    add(at, -2, 1, "WL");
    add(at, 2, 1, "WR");
    add(at, 0, 0, "CL");
    add(at + 2, -2, 1.4, "TL");
    add(at + 2.4, 2, 1.4, "TR");
  }
  const std::string arguments = "--order PENZD --tunnel-height 3 --json";
  const ProgramOutput coarse = draft(folder.path(), csv, arguments);
  REQUIRE_MESSAGE(coarse.exit_code == 0, coarse.err);
  CHECK(coarse.err.find("--split") != std::string::npos);
  fs::remove_all(folder.path() / "out");
  const ProgramOutput split = draft(folder.path(), csv, arguments + " --split");
  REQUIRE_MESSAGE(split.exit_code == 0, split.err);
  const auto last = split.out.rfind('\n', split.out.size() - 2);
  const auto summary = parsed_json(split.out.substr(last + 1))["summary"];
  std::vector<fs::path> files;
  std::size_t tags = 0;
  double reached = 0;
  for (const auto& part : summary["surveys"]) {
    CHECK(part["resolution"] == 0.01);
    CHECK(part["from"].get<double>() <= reached);
    reached = part["to"].get<double>();
    files.emplace_back(part["file"].get<std::string>());
    tags += part["tags"].get<std::size_t>();
  }
  CHECK(tags == 240);
  CHECK(files.size() >= 6);
  CHECK(files.size() <= 16);
  CHECK(reached == Approx(summary["length"].get<double>()));
  // Each part is drafted from its own points: all 600 together.
  std::size_t points = 0;
  for (const fs::path& file : files) {
    const std::string text = *read_file(file);
    std::smatch found;
    REQUIRE(std::regex_search(text, found, std::regex(R"(# Drafted from .*: (\d+) points)")));
    points += std::stoul(found[1].str());
  }
  CHECK(points == 600);
  // Together they are valid, and every tag hangs where it was measured.
  const std::vector<Survey> surveys = load_surveys(files).value();
  std::map<std::string, int> names;
  for (const Survey& survey : surveys) {
    for (const PlacedTag& tag : survey.tags) {
      ++names[tag.name];
      CHECK(tag.chainage >= 0);
      CHECK(tag.chainage <= survey.tunnel.centerline.length());
    }
  }
  CHECK(names.size() == 240);
  const ProgramOutput again = draft(folder.path(), csv, arguments + " --split");
  CHECK(again.exit_code == 2);  // never overwrites
}

TEST_CASE("parts of a split draft never share a code, also with plates at whole metres") {
  std::string csv;
  for (int y = 0; y <= 1500; y += 10) {
    for (const auto& [aside, code] : {std::pair(-2, "WL"), {2, "WR"}, {0, "CL"}}) {
      csv += fmt::format("p,{},{},100,{}\n", 5000 + y, 2000 - aside, code);
    }
  }
  const TemporaryFolder folder;
  const ProgramOutput made = draft(
      folder.path(), csv, "--order PENZD --tunnel-height 2.8 --height 1.2 --spacing 0.6 --split");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  std::set<Digits> codes;
  std::size_t tags = 0;
  for (const char* name : {"survey-1.yaml", "survey-2.yaml"}) {
    const Survey part = load_survey(folder.path() / "out" / name).value();
    for (const PlacedTag& tag : part.tags) {
      codes.insert(tag.digits);
      ++tags;
    }
  }
  CHECK(tags > 2900);
  CHECK(codes.size() == tags);
}

TEST_CASE("rows of a list of export that contradict each other, or options, are refused") {
  const TemporaryFolder folder;
  const fs::path csv = folder.path() / "tags.csv";
  REQUIRE(run_tagsmith("export surveys/curved/survey.yaml -o " + quoted(csv)).exit_code == 0);
  const std::string whole = read_file(csv).value();
  const auto with_last = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.rfind(from), from.size(), to);
    return text;
  };
  struct Case {
    std::string text;
    const char* arguments;
    const char* told;
  };
  for (const Case& each :
       {Case{with_last("tag-800x430", "tag-400x300"), "", "but line 2 says `tag-800x430`"},
        Case{with_last(",gs1,", ",sum10,"), "", "check_digit is `sum10`"},
        Case{with_last(",right,", ",left,"), "", "[conflicting-rows]"},
        Case{with_last("R,right,", "R,left,"), "", "[side-mismatch]"},
        Case{whole, " --x-axis left", "the list says right"},
        Case{whole, " --check-digit sum10", "the list says gs1"},
        Case{whole, " --template tag-400x300",
             "the list says the template tag-800x430, not tag-400x300"},
        Case{whole, " --tunnel-height 5", "--tunnel-height is for lists"},
        Case{whole, " --mount-height 5", "--mount-height is for lists"}}) {
    CAPTURE(std::string(each.told));
    const ProgramOutput refused =
        draft(folder.path(), each.text, "--order own" + std::string(each.arguments));
    CHECK(refused.exit_code == 2);
    CHECK_MESSAGE(refused.err.find(each.told) != std::string::npos, refused.err);
  }
}

TEST_CASE("a list of export is not read with another plate of the same name") {
  const TemporaryFolder folder;
  std::string plate = read_file("templates/tag-400x300.yaml").value();
  const std::regex inner(R"(inner: \[[^\]]*\])");
  REQUIRE(std::regex_search(plate, inner));
  plate = std::regex_replace(plate, inner, "inner: [0.3087, 0.1512]");
  fs::create_directories(folder.path() / "mine");
  write_text(folder.path() / "mine" / "tag-400x300.yaml", plate);
  const std::string survey = read_file("surveys/corridor/survey.yaml").value();
  write_text(folder.path() / "mine" / "survey.yaml", survey);
  for (const auto& [format, arguments] : {std::pair("csv", "--order own"),
                                          {"landxml", "--tunnel-height 3"},
                                          {"gsi", "--tunnel-height 3 --mount-height 1"}}) {
    CAPTURE(std::string(format));
    const fs::path list = folder.path() / ("tags." + std::string(format));
    const ProgramOutput exported = run_tagsmith(
        "export " + quoted(folder.path() / "mine" / "survey.yaml") + " -o " + quoted(list));
    REQUIRE_MESSAGE(exported.exit_code == 0, exported.err);
    const std::string text = read_file(list).value();
    const ProgramOutput other = draft(folder.path(), text, arguments);
    CHECK(other.exit_code == 2);
    CHECK_MESSAGE(other.err.find("with a frame of 0.3087 x 0.1512 m") != std::string::npos,
                  other.err);
    const ProgramOutput same =
        draft(folder.path(), text, std::string(arguments) + " --template ../mine/tag-400x300.yaml");
    CHECK_MESSAGE(same.exit_code == 0, same.err);
    fs::remove_all(folder.path() / "out");
  }
}

TEST_CASE("fields that no column is for, and a first point that was to name columns, are refused") {
  const TemporaryFolder folder;
  const std::string text = surveyed_drift(0).text("PDENZ");
  std::string comma = text;
  const std::size_t end = comma.find('\n');
  comma.replace(comma.rfind('.', end), 1, ",");  // a decimal comma in one height
  const ProgramOutput more = draft(folder.path(), comma, "--order PDENZ");
  CHECK(more.exit_code == 2);
  CHECK_MESSAGE(more.err.find("points.csv:1: error: the line has 6 fields, expected 5 "
                              "[wrong-length]") != std::string::npos,
                more.err);
  const ProgramOutput header = draft(folder.path(), text, "--order PDENZ --header");
  CHECK(header.exit_code == 2);
  CHECK_MESSAGE(header.err.find("leave --header out") != std::string::npos, header.err);
  std::string blank = text;
  blank.insert(blank.find('\n'), ",, ");
  CHECK(draft(folder.path(), blank, "--order PDENZ").exit_code == 0);
  fs::remove_all(folder.path() / "out");
  CHECK(draft(folder.path(), "name,what,east,north,height\n" + text, "--order PDENZ --header")
            .exit_code == 0);
}

TEST_CASE("a list of export keeps how well attitudes are known, and which tags are control tags") {
  const TemporaryFolder folder;
  Survey listed = load_survey("surveys/drift/survey.yaml").value();
  listed.angle_sigma = radians(2);
  listed.tags[3].control = true;
  REQUIRE(draft(folder.path(), tags_csv(listed), "--order own").exit_code == 0);
  const Survey made = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(made.states_angle_sigma);
  CHECK(made.angle_sigma == Approx(radians(2)));
  for (std::size_t i = 0; i < made.tags.size(); ++i) CHECK(made.tags[i].control == (i == 3));
}

TEST_CASE("a tag of a list of export is left out by its name") {
  const TemporaryFolder folder;
  const std::string list = tags_csv(load_survey("surveys/corridor/survey.yaml").value());
  const ProgramOutput made = draft(folder.path(), list, "--order own --ignore 003L,003r");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(survey.tags.size() == 14);
  CHECK(find_tag(survey, "003L") == nullptr);
  CHECK(find_tag(survey, "003R") == nullptr);
}

TEST_CASE("names that a survey cannot have are refused, and a rig that is there is no obstacle") {
  const TemporaryFolder folder;
  for (const char* name : {"nan", "inf", "Null", "True", "~", "_x", "(a)", "$x", "12", "a#b"}) {
    CAPTURE(std::string(name));
    const fs::path path = folder.path() / name;
    CHECK(run_tagsmith("new " + quoted(path)).exit_code == 2);
    CHECK_FALSE(fs::exists(path));
  }
  fs::create_directories(folder.path() / "out");
  write_text(folder.path() / "out" / "rig.yaml", "rig: mine\n");
  CHECK(draft(folder.path(), surveyed_drift(0).text("PENZD"), "--order PENZD").exit_code == 0);
  CHECK(draft(folder.path(), surveyed_drift(0).text("PENZD"), "--order PENZD").exit_code == 2);
}

TEST_CASE("a field that is no number is told with a remedy for its line") {
  const TemporaryFolder folder;
  const std::string header = "does the first line name the columns? then --header";
  const std::string names = draft(folder.path(), "P,x,y,z,D\n1,0,0,0,WL\n", "--order PENZD").err;
  CHECK_MESSAGE(
      names.find("x is `x`, expected a number [bad-number]\n      " + header) != std::string::npos,
      names);
  const std::string later = draft(folder.path(), "1,0,0,0,WL\n2,x,0,0,WL\n", "--order PENZD").err;
  CHECK(later.find(":2:2: error: x is `x`, expected a number [bad-number]") != std::string::npos);
  CHECK(later.find(header) == std::string::npos);
}

TEST_CASE("a drive that begins with an arc keeps its chainages") {
  const TemporaryFolder folder;
  const fs::path survey = folder.path() / "arc.yaml";
  write_text(survey, R"(survey: arc
tunnel:
  width: 3.0
  height: 2.8
  centerline:
    start: [0.0, 0.0, 0.0]
    heading: 20
    elements:
      - { arc: 40.0, turn: right, angle: 40 }
tags: { template: tag-400x300, height: 1.2, spacing: 1.1, first: 5.0, pairs: 12 }
code: { check_digit: gs1, resolution: 0.01, digits: [4, 4, 3], origin: [-10, -10, -1] }
)");
  const fs::path csv = folder.path() / "arc.csv";
  REQUIRE(run_tagsmith("export " + quoted(survey) + " -o " + quoted(csv)).exit_code == 0);
  const ProgramOutput made = draft(folder.path(), read_file(csv).value(), "--order own");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Survey before = load_survey(survey).value();
  const Survey after = load_survey(folder.path() / "out" / "survey.yaml").value();
  REQUIRE(after.tags.size() == before.tags.size());
  for (std::size_t i = 0; i < after.tags.size(); ++i) {
    CHECK(std::abs(after.tags[i].chainage - before.tags[i].chainage) < 1e-4);
  }
  // Nobody said how well the plates are surveyed, and computed places do not tell it.
  CHECK(read_file(folder.path() / "out" / "survey.yaml").value().find("sigma") ==
        std::string::npos);
}

TEST_CASE(
    "lists of export that were put together, each with its names of columns, are read as one") {
  const TemporaryFolder folder;
  const fs::path csv = folder.path() / "curved.csv";
  REQUIRE(run_tagsmith("export surveys/curved/survey.yaml -o " + quoted(csv)).exit_code == 0);
  const std::string text = read_file(csv).value();
  const std::string names = text.substr(0, text.find('\n') + 1);
  const std::size_t middle = text.find('\n', text.size() / 2) + 1;
  const auto drafted = [&](const std::string& list, const char* name) {
    fs::create_directory(folder.path() / name);
    const ProgramOutput made = draft(folder.path() / name, list, "--order own");
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    return read_file(folder.path() / name / "out" / "survey.yaml").value();
  };
  CHECK(drafted(text.substr(0, middle) + names + text.substr(middle), "two") ==
        drafted(text, "one"));
}

TEST_CASE("points along the tangent of an arc make a straight element, as they were fitted") {
  // A quarter circle of 30 m, and one point of each wall 20 m further straight on.
  std::string csv;
  const auto add = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& right) {
    for (const auto& [aside, code] : {std::pair(-2.0, "WL"), {2.0, "WR"}, {0.0, "CL"}}) {
      const Eigen::Vector2d at = p + aside * right;
      csv += fmt::format("p,{:.4f},{:.4f},100,{}\n", at.x(), at.y(), code);
    }
  };
  for (int deg = 0; deg <= 90; deg += 3) {
    const Eigen::Vector2d outward(std::cos(radians(deg)), std::sin(radians(deg)));
    add(Eigen::Vector2d(470, 1020) + 30 * outward, outward);
  }
  add({450, 1050}, {0, 1});
  const TemporaryFolder folder;
  const ProgramOutput made =
      draft(folder.path(), csv, "--order PENZD --tunnel-height 3 --height 1.2 --spacing 2");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Centerline line =
      load_survey(folder.path() / "out" / "survey.yaml").value().tunnel.centerline;
  CHECK(std::abs(line.locate({450, 1050}).offset) < 0.03);
  const double end = line.length();
  CHECK((line.at(end).position.head<2>() - Eigen::Vector2d(450 - 0.4, 1050)).norm() < 0.1);
}

TEST_CASE("options for what a list lacks are refused where it has it, and a width is kept") {
  const TemporaryFolder folder;
  const std::string csv = surveyed_drift(0.002).text("PENZD");
  const ProgramOutput floor = draft(folder.path(), csv, "--order PENZD --mount-height 1.5");
  CHECK(floor.exit_code == 2);
  CHECK(floor.err.find("--mount-height") != std::string::npos);
  const ProgramOutput roof = draft(folder.path(), csv, "--order PENZD --tunnel-height 4");
  CHECK(roof.exit_code == 2);
  CHECK(roof.err.find("--tunnel-height") != std::string::npos);
  std::string line;
  for (int deg = 0; deg <= 90; deg += 15) {
    line += fmt::format("p,{:.4f},{:.4f},100,CL\n", 20 * std::cos(radians(deg)),
                        20 * std::sin(radians(deg)));
  }
  const ProgramOutput made =
      draft(folder.path(), line,
            "--order PENZD --width 4 --tunnel-height 3 --height 1.2 --spacing 2 --tolerance 200");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(width_at(survey.tunnel, 0) == Approx(4));
}

TEST_CASE("JSON says survey, code, tunnel and each tag, the field layout its poses") {
  const Survey survey = load_survey("surveys/curved/survey.yaml").value();
  const auto json = parsed_json(tags_json(survey));
  CHECK(json["survey"] == "curved");
  CHECK(json["tags"].size() == 12);
  CHECK(json["tags"][0]["digits"] == "001001920601");
  CHECK(json["tags"][0]["facing_deg"].get<double>() == Approx(90));
  CHECK(json["tunnel"]["centerline"]["elements"][1]["arc"] == 8);

  const auto layout = parsed_json(field_layout_json(survey));
  for (const auto& tag : layout["tags"]) {
    const PlacedTag& placed = survey.tags[tag["ID"].get<std::size_t>()];
    const auto& turn = tag["pose"]["rotation"]["quaternion"];
    const Eigen::Quaterniond q(turn["W"].get<double>(), turn["X"].get<double>(),
                               turn["Y"].get<double>(), turn["Z"].get<double>());
    const Eigen::Vector3d out = q * Eigen::Vector3d::UnitX();
    CHECK((out + placed.world_from_plate.rotation.col(2)).norm() < 1e-9);
    CHECK((q * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm() < 1e-9);
    const auto& at = tag["pose"]["translation"];
    CHECK(at["z"].get<double>() == Approx(0.6 - 0.325 / 2));
    const Eigen::Vector2d middle(at["x"].get<double>(), at["y"].get<double>());
    const double offset = survey.tunnel.centerline.locate(middle).offset;
    CHECK(std::abs(offset) == Approx(1.9));
  }
}

TEST_CASE("a DXF has metres, layers, and positions to the micrometre in a national grid") {
  const TemporaryFolder folder;
  write_text(folder.path() / "graded.yaml", kGradedSurvey);
  const Survey survey = load_survey(folder.path() / "graded.yaml").value();
  const std::string dxf = render_dxf(survey);
  CHECK(dxf.find("$INSUNITS\n 70\n6\n") != std::string::npos);
  const Eigen::Vector3d& p = survey.tags[0].p_in_grid;
  CHECK(dxf.find(fmt::format(" 10\n{:.6f}\n 20\n{:.6f}\n 30\n{:.6f}\n", p.x(), p.y(), p.z())) !=
        std::string::npos);
  // Pairs of group code and value; every handle once; every layer that is used is declared.
  const std::vector<std::string> lines = split(dxf, '\n');
  std::map<std::string, int> handles;
  std::map<std::string, int> declared;
  std::string type;
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
    const auto code = parse_integer(trim(lines[i]));
    REQUIRE_MESSAGE(code, "line " << i + 1);
    const std::string& value = lines[i + 1];
    if (*code == 0) type = value;
    if (*code == 5 && type != "SECTION") ++handles[value];
    if (*code == 2 && type == "LAYER") ++declared[value];
    if (*code == 8) CHECK_MESSAGE(declared[value] == 1, value);
  }
  for (const auto& [handle, count] : handles) CHECK_MESSAGE(count == 1, handle);
  CHECK(lines[lines.size() - 2] == "EOF");
}

TEST_CASE("a DXF has each plate and frame as one closed polyline of four corners") {
  const Survey survey = load_survey("surveys/drift/survey.yaml").value();
  const std::string dxf = render_dxf(survey);
  const auto count = [&](const std::string& text) {
    std::size_t found = 0;
    for (auto at = dxf.find(text); at != std::string::npos; at = dxf.find(text, at + 1)) ++found;
    return found;
  };
  for (const std::string layer : {"PLATES", "FRAMES"}) {
    CAPTURE(layer);
    const std::string closed = layer +
                               "\n100\nAcDb3dPolyline\n 66\n1\n 10\n0.000000\n 20\n0.000000\n" +
                               " 30\n0.000000\n 70\n9\n";
    CHECK(count(closed) == survey.tags.size());
    CHECK(count(layer + "\n100\nAcDbVertex\n100\nAcDb3dPolylineVertex\n") ==
          4 * survey.tags.size());
  }
  CHECK(count("POLYLINE\n  5\n") == count("SEQEND\n  5\n"));
}

TEST_CASE("a DXF has the drill holes as points on the plate") {
  Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  survey.tag_template.holes = {{.right = 0.19, .up = 0.14, .diameter = 0.006}};
  const std::string dxf = render_dxf(survey);
  const TagTemplate& plate = survey.tag_template;
  const Eigen::Vector3d in_plate(plate.frame_inner_length / 2 + 0.19,
                                 plate.frame_inner_height / 2 - 0.14, 0);
  const Eigen::Vector3d at =
      grid_from_world(survey.grid, survey.tags[0].world_from_plate * in_plate);
  const std::string point =
      fmt::format("HOLES\n100\nAcDbPoint\n 10\n{:.6f}\n 20\n{:.6f}\n 30\n{:.6f}\n", at.x() + 0.0,
                  at.y() + 0.0, at.z() + 0.0);
  CHECK_MESSAGE(dxf.find(point) != std::string::npos, point);
}

TEST_CASE("export chooses by the name, prints to -, and refuses other names") {
  const TemporaryFolder folder;
  const std::string survey = "surveys/corridor/survey.yaml";
  CHECK(run_tagsmith("export " + survey + " -o -").out.starts_with("tag,side,digits,x,y,z,"));
  CHECK(run_tagsmith("export " + survey + " -o - --format wpilib").out.find("\"quaternion\"") !=
        std::string::npos);
  const ProgramOutput refused =
      run_tagsmith("export " + survey + " -o " + quoted(folder.path() / "tags.xls"));
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find(".wpilib.json or .dxf, or --format") != std::string::npos);
  CHECK(run_tagsmith("export absent.yaml -o -").exit_code == 2);
}
