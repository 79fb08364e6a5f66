// SPDX-License-Identifier: Apache-2.0
// The files under surveys/ and templates/: all load without a finding, and the plates hang where
// the renderer that made the photos put them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/board_file.hpp"
#include "tagsmith/survey/read_printer.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
namespace fs = std::filesystem;

namespace {

std::vector<fs::path> files_named(const fs::path& folder, const std::string& name) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename() == name) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

nlohmann::json read_json(const fs::path& path) { return test::parsed_json(test::contents(path)); }

Eigen::Vector3d vector_of(const nlohmann::json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

// The plate's inner frame corner in the grid: P, F, R (lower right) or Q.
Eigen::Vector3d corner_in_grid(const Survey& survey, const PlacedTag& tag, char corner) {
  const double x = corner == 'F' || corner == 'R' ? survey.tag_template.frame_inner_length : 0.0;
  const double y = corner == 'R' || corner == 'Q' ? survey.tag_template.frame_inner_height : 0.0;
  return grid_from_world(survey.grid, tag.world_from_plate * Eigen::Vector3d(x, y, 0));
}

void check_against_truth(const fs::path& folder, std::size_t tag_count) {
  const auto survey = load_survey(folder / "survey.yaml");
  REQUIRE_MESSAGE(survey.has_value(), survey.error().message);
  CHECK(survey->tags.size() == tag_count);
  const nlohmann::json truth = read_json(folder / "photos/truth.json");
  std::size_t compared = 0;
  for (const auto& image : truth["images"]) {
    for (const auto& plate : image["plates"]) {
      const std::string code = plate["code"];
      CAPTURE(code);
      const PlacedTag* tag = find_tag(*survey, parse_digits(code).value());
      REQUIRE(tag != nullptr);
      ++compared;
      for (const char corner : {'P', 'F', 'R', 'Q'}) {
        CAPTURE(corner);
        const Eigen::Vector3d expected = vector_of(plate["corners_world"][std::string(1, corner)]);
        CHECK((corner_in_grid(*survey, *tag, corner) - expected).norm() < 1e-4);
      }
    }
  }
  CHECK(compared >= tag_count);
}

}  // namespace

TEST_CASE("every shipped survey loads without a finding") {
  const std::vector<fs::path> files = files_named("surveys", "survey.yaml");
  CHECK(files.size() >= 3);
  for (const fs::path& file : files) {
    const auto reading = read_survey(file);
    REQUIRE(reading.has_value());
    CHECK_MESSAGE(reading->diagnostics.empty(), to_string(reading->diagnostics));
    CHECK(reading->value.has_value());
  }
}

TEST_CASE("every shipped template loads without a finding under its own name") {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("templates")) {
    const auto reading = read_template(entry.path());
    REQUIRE(reading.has_value());
    CHECK_MESSAGE(reading->diagnostics.empty(), to_string(reading->diagnostics));
    REQUIRE(reading->value.has_value());
    CHECK(reading->value->name == entry.path().stem().string());
    ++count;
  }
  CHECK(count >= 2);
}

TEST_CASE("every shipped rig loads without a finding, and every run with its rig") {
  const std::vector<fs::path> rigs = files_named("surveys", "rig.yaml");
  CHECK(rigs.size() >= 3);
  int runs = 0;
  for (const fs::path& file : rigs) {
    const auto rig = read_rig(file);
    REQUIRE(rig.has_value());
    CHECK_MESSAGE(rig->diagnostics.empty(), to_string(rig->diagnostics));
    REQUIRE(rig->value.has_value());
    for (const auto& entry : fs::directory_iterator(file.parent_path())) {
      if (entry.path().extension() != ".csv") continue;
      const auto run = load_run(entry.path(), *rig->value);
      REQUIRE_MESSAGE(run.has_value(), run.error().message);
      for (const Measurement& measurement : run->measurements) {
        CHECK(measurement.cameras.size() == 2);
        CHECK(measurement.truth_in_grid.has_value());
        for (const auto& [name, camera] : measurement.cameras) {
          const bool there = camera.distance.has_value() || fs::exists(camera.image);
          CHECK_MESSAGE(there, camera.image.string());
        }
      }
      ++runs;
    }
  }
  CHECK(runs >= 4);
}

TEST_CASE("the examples in docs/formats.md load without a finding") {
  std::ifstream stream("docs/formats.md");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::vector<std::string> examples;
  const std::string fence = "```yaml\n";
  for (std::size_t at = text.find(fence); at != std::string::npos; at = text.find(fence, at)) {
    at += fence.size();
    examples.push_back(text.substr(at, text.find("```", at) - at));
  }
  REQUIRE(examples.size() == 5);
  const test::TemporaryFolder folder;
  const auto survey = read_survey(test::write_text(folder.path() / "s.yaml", examples[0]));
  const auto tag = read_template(test::write_text(folder.path() / "t.yaml", examples[1]));
  const auto board = read_board(test::write_text(folder.path() / "b.yaml", examples[2]));
  const auto rig = read_rig(test::write_text(folder.path() / "r.yaml", examples[4]));
  const auto printer =
      read_printer_profile(test::write_text(folder.path() / "p.yaml", examples[3]));
  CHECK_MESSAGE(survey.value().diagnostics.empty(), to_string(survey->diagnostics));
  CHECK_MESSAGE(tag.value().diagnostics.empty(), to_string(tag->diagnostics));
  CHECK_MESSAGE(board.value().diagnostics.empty(), to_string(board->diagnostics));
  CHECK_MESSAGE(rig.value().diagnostics.empty(), to_string(rig->diagnostics));
  REQUIRE_MESSAGE(printer, printer.error().message);
  CHECK(printer->scale.right == 1.00308);
  CHECK(printer->growth_down == doctest::Approx(0.123e-3));
}

TEST_CASE("the corridor's plates hang where its photos show them") {
  check_against_truth("surveys/corridor", 16);
}

TEST_CASE("the curved tunnel's plates hang where its photos show them") {
  check_against_truth("surveys/curved", 12);
}

TEST_CASE("cameras of the shipped rigs see as the photos' cameras do") {
  for (const std::string name : {"corridor", "curved"}) {
    CAPTURE(name);
    const auto survey = load_survey("surveys/" + name + "/survey.yaml");
    const auto rig = load_rig("surveys/" + name + "/rig.yaml");
    REQUIRE(survey.has_value());
    REQUIRE(rig.has_value());
    const nlohmann::json truth = read_json("surveys/" + name + "/photos/truth.json");
    for (const auto& image : truth["images"]) {
      const Eigen::Vector3d position = vector_of(image["vehicle"]["O_world"]);
      const Eigen::Vector3d along =
          world_from_grid(survey->grid, vector_of(image["vehicle"]["heading_world"]));
      const Pose world_from_body = world_from_vehicle(world_from_grid(survey->grid, position),
                                                      std::atan2(along.x(), along.y()));
      const RigCamera* camera = find_camera(*rig, image["side"].get<std::string>());
      REQUIRE(camera != nullptr);
      const Pose camera_from_world = inverse(world_from_body * camera->vehicle_from_camera);
      for (const auto& plate : image["plates"]) {
        for (const char* corner : {"P", "F", "R", "Q"}) {
          const Eigen::Vector3d point =
              world_from_grid(survey->grid, vector_of(plate["corners_world"][corner]));
          const auto pixel = project(camera->camera, camera_from_world * point);
          if (!pixel) continue;
          const auto& expected = plate["corners_px"][corner];
          CAPTURE(image["file"].get<std::string>());
          CHECK(pixel->x() == doctest::Approx(expected[0].get<double>()).epsilon(1e-5));
          CHECK(pixel->y() == doctest::Approx(expected[1].get<double>()).epsilon(1e-5));
        }
      }
    }
  }
}

TEST_CASE("table 4's survey has the paper's coded positions and angle") {
  const auto survey = load_survey("surveys/corridor-table4/survey.yaml");
  REQUIRE(survey.has_value());
  REQUIRE(survey->series.has_value());
  CHECK(degrees(survey->series->pair_angle.value()) == doctest::Approx(10.2));
  CHECK(survey->tags.size() == 16);
  for (const PlacedTag& tag : survey->tags) {
    const double y = 0.8 * tag.pair + (tag.side == Side::right ? 0.4 : 0.0);
    const Eigen::Vector3d expected(tag.side == Side::left ? 1.9 : 0.0, y, 0.4);
    CHECK((tag.p_in_grid - expected).norm() < 1e-12);
    CHECK((tag.coded_in_grid - expected).norm() < 1e-12);
    CHECK(tag.surveyed);
  }
}
