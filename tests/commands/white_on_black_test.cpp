// SPDX-License-Identifier: Apache-2.0
// Plates that are white on black, from the template to the position.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using nlohmann::json;
using tagsmith::detail::read_file;
using tagsmith::detail::write_file;
using tagsmith::detail::test::json_lines;
using tagsmith::detail::test::parsed_json;
using tagsmith::detail::test::ProgramOutput;
using tagsmith::detail::test::run_tagsmith;
using tagsmith::detail::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

// The corridor with plates white on black, or as shipped, and simulated photos of two places.
struct Corridor {
  TemporaryFolder folder;
  std::string survey;
  std::string photos;

  explicit Corridor(bool white_on_black) {
    const auto in = [&](const char* name) { return (folder.path() / name).string(); };
    survey = in("survey.yaml");
    photos = in("photos");
    REQUIRE(write_file(survey, *read_file("surveys/corridor/survey.yaml")).has_value());
    REQUIRE(
        write_file(in("tag-400x300.yaml"), *read_file("templates/tag-400x300.yaml") +
                                               (white_on_black ? "\nwhite_on_black: true\n" : ""))
            .has_value());
    REQUIRE(
        write_file(in("places.csv"),
                   "id,left,right,truth_x,truth_y,truth_z\n1,,,0.95,0.2,0.24\n2,,,0.9,1.4,0.24\n")
            .has_value());
    REQUIRE(run_tagsmith("simulate " + survey + " --rig surveys/corridor/rig.yaml --run " +
                         in("places.csv") + " -o " + photos)
                .exit_code == 0);
  }
};

// Of the corners that are read, against the truth of the simulation, pixels.
double root_mean_square(const Corridor& corridor) {
  const json truth = parsed_json(*read_file(corridor.photos + "/truth.json"));
  double sum = 0;
  int count = 0;
  for (const json& image : truth.at("images")) {
    const std::string file = corridor.photos + "/" + image.at("file").get<std::string>();
    const json read =
        json_lines(run_tagsmith("read --json --survey " + corridor.survey + " " + file).out).at(0);
    for (const json& tag : read.at("tags")) {
      for (const json& plate : image.at("plates")) {
        if (plate.at("code") != tag.at("digits")) continue;
        for (std::size_t i = 0; i < 4; ++i) {
          const json& corner = plate.at("corners_px").at(std::string(1, "PFRQ"[i]));
          for (std::size_t axis = 0; axis < 2; ++axis, ++count) {
            const double off =
                tag.at("corners")[i][axis].get<double>() - corner[axis].get<double>();
            sum += off * off;
          }
        }
      }
    }
  }
  REQUIRE(count >= 32);
  return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE("plates white on black are located as exactly as others") {
  const Corridor white(true);
  const Corridor black(false);
  CHECK(root_mean_square(white) < 1.5 * root_mean_square(black) + 0.005);
  const std::string run = " --rig surveys/corridor/rig.yaml --run " + white.photos + "/run.csv";
  const ProgramOutput located = run_tagsmith("localize --json " + white.survey + run);
  CHECK(located.exit_code == 0);
  for (const json& fix : json_lines(located.out)) {
    if (fix.contains("id")) CHECK(fix.at("error_plane").get<double>() < 0.002);
  }
  CHECK(run_tagsmith("verify " + white.survey + " " + white.photos + "/*.png").exit_code == 0);
  CHECK(run_tagsmith("print " + white.survey + " --proof --format pdf,svg,png --tags 000L -o " +
                     (white.folder.path() / "print").string())
            .exit_code == 0);

  // Read by the wrong survey, they are told for what they are; without one, only when asked.
  const std::string photo = white.photos + "/1_left.png";
  const json line =
      json_lines(run_tagsmith("verify --json surveys/corridor/survey.yaml " + photo).out).at(0);
  CHECK(line.at("rules") == json::array({"inverted"}));
  CHECK(line.at("findings")[0].get<std::string>().ends_with("expected black on white"));
  CHECK(run_tagsmith("read " + photo).exit_code == 1);
  CHECK(run_tagsmith("read --white-on-black " + photo).exit_code == 0);
  const json other =
      json_lines(
          run_tagsmith("verify --json " + white.survey + " " + black.photos + "/1_left.png").out)
          .at(0);
  CHECK(other.at("rules") == json::array({"inverted"}));
  CHECK(other.at("findings")[0].get<std::string>().ends_with("expected white on black"));

  const ProgramOutput both = run_tagsmith("read --survey surveys/curved/survey.yaml --survey " +
                                          white.survey + " " + photo);
  CHECK(both.exit_code == 2);
  CHECK(both.err.find("[mixed-colours]") != std::string::npos);
}

TEST_CASE("plates white on black are printed so, and their pages read and grade as such") {
  const Corridor white(true);
  for (const char* format : {"pdf", "svg"}) {
    CAPTURE(format);
    const std::string pages = (white.folder.path() / format).string();
    const ProgramOutput printed = run_tagsmith("print " + white.survey + " --tags 000L --format " +
                                               std::string(format) + " --proof -o " + pages);
    CHECK_MESSAGE(printed.exit_code == 0, printed.err);
    const ProgramOutput verified = run_tagsmith("verify --json " + white.survey + " " + pages);
    CHECK(verified.exit_code == 0);
    const json tag = json_lines(verified.out).at(0).at("tags").at(0);
    CHECK(tag.at("status") == "ok");
    CHECK(tag.at("grade") == 4.0);
  }
}
