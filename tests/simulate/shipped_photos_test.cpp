// SPDX-License-Identifier: Apache-2.0
// The pictures simulated at the shipped runs' places against the shipped photos' truth, which an
// independent ray tracer wrote.
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Shipped {
  Survey survey;
  Rig rig;
  Run run;
  Json truth;
};

Shipped shipped(const std::string& name) {
  const fs::path folder = fs::path("surveys") / name;
  auto survey = load_survey(folder / "survey.yaml");
  REQUIRE(survey);
  auto rig = load_rig(folder / "rig.yaml");
  REQUIRE(rig);
  auto run = load_run(folder / "run.csv", *rig);
  REQUIRE(run);
  const auto truth = read_file(folder / "photos" / "truth.json");
  REQUIRE(truth);
  return {*survey, *rig, *run, Json::parse(*truth)};
}

using Plates = std::map<std::string, PlateTruth>;  // by code

Plates by_code(const Survey& survey, const std::vector<std::size_t>& tags,
               const std::vector<PlateTruth>& truths) {
  Plates plates;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    plates.emplace(to_string(survey.tags[tags[i]].digits), truths[i]);
  }
  return plates;
}

Pose vehicle_at(const Shipped& set, const Json& image) {
  const std::string id = std::to_string(image["point"].get<int>());
  for (const Measurement& row : set.run.measurements) {
    if (row.id == id) return vehicle_in_tunnel(set.survey, *row.truth_in_grid, row.truth_heading);
  }
  FAIL("the run has no row " << id);
  return {};
}

double corner_error(const Json& expected, const PlateTruth& plate) {
  double largest = 0;
  const std::string names = "PFRQ";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json& corner = expected["corners_px"][std::string(1, names[i])];
    REQUIRE(plate.corners[i]);
    const Eigen::Vector2d place(corner[0].get<double>(), corner[1].get<double>());
    largest = std::max(largest, (*plate.corners[i] - place).norm());
  }
  return largest;
}

void check_geometry(const Json& expected, const PlateTruth& plate) {
  CHECK(corner_error(expected, plate) < 0.05);
  CHECK(plate.module_px == doctest::Approx(expected["px_per_module"].get<double>()).epsilon(0.001));
  CHECK(std::abs(degrees(plate.incidence) - expected["incidence_deg"].get<double>()) < 0.01);
}

// Without the walls, which take the time: every photo.
void check_corners(const std::string& name, std::size_t photos) {
  const Shipped set = shipped(name);
  CHECK(set.truth["images"].size() == photos);
  for (const Json& image : set.truth["images"]) {
    CAPTURE(image["file"].get<std::string>());
    const RigCamera& camera = *find_camera(set.rig, image["side"].get<std::string>());
    const Pose world_from_camera = vehicle_at(set, image) * camera.vehicle_from_camera;
    const TagsInSight sight = tags_in_sight(set.survey, camera.camera, world_from_camera);
    const Plates plates =
        by_code(set.survey, sight.tags, plate_truths(camera.camera, sight.plates));
    CHECK(!image["plates"].empty());
    for (const Json& expected : image["plates"]) {
      const auto plate = plates.find(expected["code"].get<std::string>());
      REQUIRE(plate != plates.end());
      check_geometry(expected, plate->second);
    }
  }
}

// With the walls: exactly the photo's plates are seen, as much of each.
void check_sight(const std::string& name, const std::vector<std::size_t>& photos) {
  const Shipped set = shipped(name);
  for (const std::size_t photo : photos) {
    const Json& image = set.truth["images"][photo];
    CAPTURE(image["file"].get<std::string>());
    const RigCamera& camera = *find_camera(set.rig, image["side"].get<std::string>());
    const SurveyView seen =
        render_survey_view(set.survey, camera, vehicle_at(set, image), ViewOptions{}, 1);
    const Plates plates = by_code(set.survey, seen.tags, seen.view.plates);
    CHECK(plates.size() == image["plates"].size());
    for (const Json& expected : image["plates"]) {
      const auto plate = plates.find(expected["code"].get<std::string>());
      REQUIRE(plate != plates.end());
      check_geometry(expected, plate->second);
      CHECK(std::abs(plate->second.visible_fraction - expected["fraction_visible"].get<double>()) <
            0.02);
    }
  }
}

TEST_CASE("The plates' corners lie where the photos have them") {
  check_corners("corridor", 20);
  check_corners("curved", 12);
}

TEST_CASE("Between the walls the plates of the photos are seen and no others") {
  check_sight("corridor", {0, 5});
  check_sight("curved", {4, 7, 9});
}

}  // namespace
}  // namespace tagsmith::detail
