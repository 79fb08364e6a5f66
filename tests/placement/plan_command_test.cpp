// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

const std::string kCorridor = "plan surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml";

}  // namespace

TEST_CASE("plan answers what people ask, and says by its exit code whether there are gaps") {
  const ProgramOutput covered = run_tagsmith(kCorridor + " --to 5");
  CHECK(covered.exit_code == 0);
  for (const char* question : {"gaps", "position, plane", "position, height", "\nheading  ",
                               "worst stretch", "a tag is first read", "one tag lost",
                               "fastest speed", "exposure needed", "the paper's method"}) {
    CHECK_MESSAGE(covered.out.find(question) != std::string::npos, question);
  }
  CHECK(run_tagsmith(kCorridor).exit_code == 1);  // no tags beyond 6 m
}

TEST_CASE("plan names the tags that are never read, five of many") {
  const std::string some = run_tagsmith(kCorridor + " --to 5").out;
  CHECK(some.find("never read from the center line: 2 (000L 000R)\n") != std::string::npos);
  const std::string many = run_tagsmith(kCorridor + " --from 7 --to 9").out;
  CHECK(many.find("never read from the center line: 16 (000L 000R 001L 001R 002L ...)\n") !=
        std::string::npos);
}

TEST_CASE(
    "where nothing is ever read, no speed is called possible and gaps are no longer than the "
    "plan") {
  const ProgramOutput dark = run_tagsmith(kCorridor + " --from 7 --to 9 --step 0.5");
  CHECK(dark.exit_code == 1);
  CHECK(dark.out.find("no limit") == std::string::npos);
  CHECK(dark.out.find("1, 2.00 m in all; the longest 7.00 to 9.00 m") != std::string::npos);
}

TEST_CASE("--optimise says of each freedom that it was given how far it went, of others nothing") {
  const std::string plan = kCorridor + " --to 2 --optimise --vary ";
  const std::string height = run_tagsmith(plan + "height").out;
  CHECK(height.find("tried       spacing from 0.05 to 20 m") != std::string::npos);
  CHECK(height.find("height of P in steps of 0.2 m") != std::string::npos);
  CHECK(height.find("half a pitch apart") == std::string::npos);
  CHECK(height.find("every template") == std::string::npos);
  const std::string stagger = run_tagsmith(plan + "stagger").out;
  CHECK(stagger.find("half a pitch apart") != std::string::npos);
  CHECK(stagger.find("height of P in steps") == std::string::npos);
}

TEST_CASE("more jobs than the machine has cores change nothing and are not worth a word") {
  const std::string plan = kCorridor + " --to 1 --json";
  const ProgramOutput many = run_tagsmith(plan + " --jobs 1000");
  CHECK(many.err == "");
  CHECK(many.out == run_tagsmith(plan).out);
}

TEST_CASE("plan tells chainages where no drive is") {
  const std::string drive = kCorridor + " --step 0.5 --offsets 1 --headings 1";
  const std::string words = "the drive goes from chainage 0 to 10 m";
  CHECK(run_tagsmith(drive + " --to 10").err.find(words) == std::string::npos);
  CHECK(run_tagsmith(drive + " --to 12").err.find(words + ", the plan from 0 to 12 m") !=
        std::string::npos);
  CHECK(run_tagsmith(drive + " --from -1 --to 5").err.find(words) != std::string::npos);
}

TEST_CASE("plan assumes no speed where one is stated") {
  const TemporaryFolder folder;
  std::string rig = *read_file("surveys/corridor/rig.yaml");
  const std::size_t at = rig.find("alpha: 35,");
  REQUIRE(at != std::string::npos);
  rig.insert(at, "readout: 0.02, ");
  const std::filesystem::path path = folder.path() / "rig.yaml";
  REQUIRE(write_file(path, rig));
  const std::string drive = "plan surveys/corridor/survey.yaml --rig " + path.string() +
                            " --to 1 --step 0.5 --offsets 1 --headings 1 --json";
  const ProgramOutput usual = run_tagsmith(drive);
  CHECK(usual.err.find("2 m/s assumed") != std::string::npos);
  CHECK(usual.out.find("2 m/s assumed") != std::string::npos);
  const ProgramOutput stated = run_tagsmith(drive + " --speed 0");
  CHECK((stated.err + stated.out).find("m/s assumed") == std::string::npos);
}

TEST_CASE(
    "plan allows for how far the vehicle drives between the photos of cameras that run freely") {
  const TemporaryFolder folder;
  const auto along = [&](const std::string& key) {
    std::string rig = *read_file("surveys/corridor/rig.yaml");
    for (std::size_t at = 0; (at = rig.find("alpha: 35,", at)) != std::string::npos; at += 40) {
      rig.insert(at, key);
    }
    const std::filesystem::path path = folder.path() / "rig.yaml";
    REQUIRE(write_file(path, rig));
    const ProgramOutput output =
        run_tagsmith("plan surveys/corridor/survey.yaml --rig " + path.string() +
                     " --from 2 --to 2.2 --offsets 1 --headings 1 --speed 2 --json");
    return parsed_json(output.out)["accuracy"]["plane"]["median"].get<double>();
  };
  // Two cameras, 40 mm each.
  CHECK(along("delay: 0.02, ") == doctest::Approx(0.04 / std::sqrt(2)).epsilon(0.1));
  CHECK(along("delay: 0, ") < 0.003);
}

TEST_CASE("plan --json is one object with the documented fields") {
  const ProgramOutput output = run_tagsmith(kCorridor + " --to 5 --speed 1 --json");
  const auto json = parsed_json(output.out);
  for (const char* field : {"survey",
                            "rig",
                            "from",
                            "to",
                            "step",
                            "poses_per_step",
                            "envelope",
                            "speed",
                            "assumed",
                            "coverage",
                            "covered_share",
                            "both_walls_share",
                            "gaps",
                            "longest_gap",
                            "accuracy",
                            "paper",
                            "first_reading",
                            "one_tag_lost",
                            "travel_during_exposure",
                            "fastest_speed",
                            "longest_exposure",
                            "tags",
                            "profile"}) {
    CHECK_MESSAGE(json.contains(field), field);
  }
  CHECK(json["profile"]["chainage"].size() == 101);
  CHECK(json["tags"].size() == 16);
  for (const auto& tag : json["tags"]) {
    if (!tag["read"].get<bool>()) continue;
    const auto& first = tag["first_read"];
    const auto& last = tag["last_read"];
    CHECK(first["distance"].get<double>() ==
          doctest::Approx(tag["first_distance"].get<double>()).epsilon(1e-5));
    CHECK(first["module_px"].get<double>() > 0.5);
    CHECK(last["incidence_deg"].get<double>() >= 0);
    CHECK(last["incidence_deg"].get<double>() < 90);
    // A module of 3 mm from so far, by a lens of 1600 pixels, foreshortened.
    const double foreshortened = std::cos(first["incidence_deg"].get<double>() * 0.017453292519943);
    const double facing = first["module_px"].get<double>() * first["distance"].get<double>();
    CHECK(facing == doctest::Approx(1600 * 0.343 / 113 * foreshortened).epsilon(0.35));
  }
  CHECK(json["covered_share"] == 1.0);
}

TEST_CASE("plan says once what survey and rig leave unsaid, and promises less for it") {
  const TemporaryFolder folder;
  const auto without = [&](const char* name, const std::string& key) {
    std::string text = contents(std::string("surveys/corridor/") + name);
    for (std::size_t at = 0; (at = text.find(key)) != std::string::npos;) {
      text.erase(at, key.size());
    }
    std::ofstream(folder.path() / name) << text;
    return (folder.path() / name).string();
  };
  const std::string files = "plan " + without("survey.yaml", "  sigma: 0.002") + " --rig " +
                            without("rig.yaml", ", blur_px: 0.7, sigma: 0 ") +
                            " --from 2 --to 2.2 --json";
  const ProgramOutput output = run_tagsmith(files);
  const auto json = parsed_json(output.out);
  const std::string survey = "survey corridor states no sigma: 3 mm assumed";
  const std::string rig =
      "rig crawler does not state the whole sigma of camera left, right: edge 0.1 pixels, position "
      "5 mm, angle "
      "0.5 "
      "degrees, focal 2 %, center 12.8 pixels, distortion 2 % at the image's corners (by data "
      "sheet) "
      "assumed";
  const std::string shutter =
      "rig crawler states no readout and no delay of camera left, right: global shutters, "
      "triggered "
      "together, assumed";
  const std::string blur = "rig crawler states no blur_px of camera left, right: 1 pixel assumed";
  CHECK(json["assumed"] == nlohmann::json::array({survey, rig, shutter, blur}));
  CHECK(output.err == "tagsmith plan: " + survey + "\ntagsmith plan: " + rig +
                          "\ntagsmith plan: " + shutter + "\ntagsmith plan: " + blur + "\n");
  CHECK(json["accuracy"]["plane"]["median"] > 0.003);
  const ProgramOutput stated = run_tagsmith(kCorridor + " --from 2 --to 2.2 --json");
  CHECK(stated.err.empty());
  CHECK(parsed_json(stated.out)["assumed"].empty());
  CHECK(parsed_json(stated.out)["accuracy"]["plane"]["median"] < 0.0021);
}

TEST_CASE("plan -o writes drawings and a page that needs no network") {
  const TemporaryFolder folder;
  const ProgramOutput output = run_tagsmith(kCorridor + " --to 5 -o " + folder.path().string());
  CHECK(output.exit_code == 0);
  CHECK(contents(folder.path() / "plan.pdf").starts_with("%PDF"));
  CHECK(contents(folder.path() / "plan.svg").find("</svg>") != std::string::npos);
  const std::string page = contents(folder.path() / "plan.html");
  CHECK(page.find("</html>") != std::string::npos);
  CHECK(page.find("src=") == std::string::npos);
  CHECK(page.find("href=") == std::string::npos);
  CHECK(parsed_json(contents(folder.path() / "plan.json")).contains("profile"));
}

TEST_CASE("the plan's drawing fits the paper that is asked for") {
  const std::pair<const char*, const char*> papers[] = {
      {"a4", "width=\"297mm\""}, {"a3", "width=\"420mm\""}, {"letter", "width=\"279.4mm\""}};
  for (const auto& [paper, width] : papers) {
    CAPTURE(paper);
    const TemporaryFolder folder;
    const std::string target = folder.path().string();
    CHECK(run_tagsmith(kCorridor + " --to 5 --paper " + paper + " -o " + target).exit_code == 0);
    CHECK(contents(folder.path() / "plan.svg").find(width) != std::string::npos);
  }
}

TEST_CASE("a long drive's drawing is cut for its paper, so that its tags can be read") {
  const TemporaryFolder folder;
  const std::string survey = (folder.path() / "long.yaml").string();
  std::ofstream(survey) << R"(survey: long
tunnel:
  width: 4
  height: 3
  centerline: { start: [10, 10, 0], heading: 0, elements: [ { line: 300 } ] }
tags: { template: tag-800x430, height: 1.2, spacing: 3, first: 1, pairs: 70 }
code: { check_digit: gs1, resolution: 0.1, digits: [4, 4, 3], origin: [0, 0, 0] }
)";
  run_tagsmith("plan " + survey + " --rig surveys/drift/rig.yaml --step 5 --paper letter -o " +
               folder.path().string());
  CHECK(contents(folder.path() / "plan-1.svg").find("1 : 500</title>") != std::string::npos);
}

TEST_CASE("the drawing's curves are steps, broken at gaps") {
  const TemporaryFolder folder;
  run_tagsmith("plan surveys/drift/survey.yaml --rig surveys/drift/rig.yaml --to 12 -o " +
               folder.path().string());
  const std::string svg = contents(folder.path() / "plan.svg");
  const std::size_t begin = svg.find("<g id=\"sigma\"");
  REQUIRE(begin != std::string::npos);
  const std::string curves = svg.substr(begin, svg.find("</g>", begin) - begin);
  int paths = 0;
  for (std::size_t at = curves.find(" d=\"M"); at != std::string::npos;
       at = curves.find(" d=\"M", at + 1)) {
    std::istringstream points(curves.substr(at + 5, curves.find('"', at + 5) - at - 5));
    double last_x = 0;
    double last_y = 0;
    for (int i = 0; !points.eof(); ++i) {
      char letter = 0;
      double x = 0;
      double y = 0;
      REQUIRE((points >> letter >> x >> y));
      if (i > 0) CHECK((x == last_x || y == last_y));
      last_x = x;
      last_y = y;
    }
    ++paths;
  }
  CHECK(paths > 3);  // more pieces than curves
}

TEST_CASE("--optimise writes a valid survey that needs no more tags, comments and all") {
  const TemporaryFolder folder;
  const ProgramOutput output = run_tagsmith(
      kCorridor + " --to 5 --optimise --tags-lost 1 --json -o " + folder.path().string());
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  const auto json = parsed_json(output.out);
  const int tags = json["optimisation"]["chosen"]["tags"].get<int>();
  CHECK(tags <= 16);
  const Result<Survey> written = load_survey(folder.path() / "survey.yaml");
  REQUIRE(written.has_value());
  CHECK(written->tags.size() == static_cast<std::size_t>(tags));
  CHECK(contents(folder.path() / "survey.yaml").find("# clear gap between") != std::string::npos);
}

TEST_CASE("a folder of --optimise can be planned as it is: all files that survey and rig name") {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const fs::path mine = folder.path() / "mine";
  fs::create_directories(mine / "lens");
  fs::create_directories(mine / "plates");
  const fs::path shipped = "surveys/corridor";
  const auto put = [](const fs::path& file, std::string text, const std::string& old,
                      const std::string& instead) {
    text.replace(text.find(old), old.size(), instead);
    std::ofstream(file) << text;
  };
  put(mine / "survey.yaml", contents(shipped / "survey.yaml"), "template: tag-400x300",
      "template: plates/own.yaml");
  put(mine / "plates/own.yaml", contents("templates/tag-400x300.yaml"), "label: {",
      "logo: { file: logo.svg, size_mm: [20, 8] }\nlabel: {");
  std::ofstream(mine / "plates/logo.svg")
      << R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 4"><path d="M0 0h10v4z"/></svg>)";
  fs::copy_file(shipped / "calibration-left.yaml", mine / "lens/left.yaml");
  fs::copy_file(shipped / "calibration-right.yaml", mine / "right.yaml");
  std::string rig = contents(shipped / "rig-calibrated.yaml");
  rig.replace(rig.find("calibration-right.yaml"), 22, "right.yaml");
  put(mine / "rig.yaml", rig, "calibration-left.yaml", "lens/left.yaml");
  const std::string to = " --to 5 --plane-sigma 50 ";
  const std::string out = (folder.path() / "out").string();
  const ProgramOutput better =
      run_tagsmith("plan " + (mine / "survey.yaml").string() + " --rig " +
                   (mine / "rig.yaml").string() + to + "--optimise --vary height -o " + out);
  REQUIRE_MESSAGE(better.exit_code < 2, better.err);
  fs::rename(mine, folder.path() / "elsewhere");
  const ProgramOutput again =
      run_tagsmith("plan " + out + "/survey.yaml --rig " + out + "/rig.yaml --to 5");
  CHECK_MESSAGE(again.exit_code < 2, again.err);
  CHECK(run_tagsmith("validate " + out + "/survey.yaml --rig " + out + "/rig.yaml")
            .err.find("0 warnings") != std::string::npos);
}

TEST_CASE("plan refuses what it cannot use, and writes nothing") {
  const TemporaryFolder folder;
  const std::string target = (folder.path() / "out").string();
  CHECK(run_tagsmith("plan missing.yaml --rig surveys/corridor/rig.yaml").exit_code == 2);
  CHECK(run_tagsmith(kCorridor + " --from 3 --to 2 -o " + target).exit_code == 2);
  for (const char* wrong :
       {" --step 0", " --step nan", " --speed nan", " --corner-sigma nan", " --from nan",
        " --to inf", " --from 50 --to 60", " --from -9 --to -1", " --offsets 4", " --headings 0",
        " --plane-sigma 5", " --optimise --plane-sigma nan", " --optimise --tags-lost 2"}) {
    CHECK_MESSAGE(run_tagsmith(kCorridor + wrong).exit_code == 2, wrong);
  }
  CHECK(run_tagsmith(kCorridor + " --optimise --plane-sigma 0.001 --to 5 -o " + target).exit_code ==
        2);
  CHECK_FALSE(std::filesystem::exists(target));
}

TEST_CASE("plan overwrites neither the survey nor the rig that it reads, be it by a second sheet") {
  const TemporaryFolder folder;
  const std::string long_drive = (folder.path() / "long.yaml").string();
  std::ofstream(long_drive) << R"(survey: long
tunnel:
  width: 4.0
  height: 3.0
  centerline: { start: [10.0, 0.0, 0.0], heading: 0, elements: [ { line: 400.0 } ] }
tags: { template: tag-400x300, height: 1.4, first: 2.0, spacing: 7.6, pairs: 49 }
code: { check_digit: gs1, resolution: 0.01, digits: [4, 5, 2], origin: [0, 0, 1] }
)";
  const std::string rig = "surveys/corridor/rig.yaml";
  struct Case {
    const char* output;
    bool is_rig;  // else the survey stands there
  };
  for (const Case& one :
       {Case{"plan.svg", true}, {"plan.svg", false}, {"plan-2.svg", true}, {"plan-2.svg", false}}) {
    CAPTURE(one.output);
    CAPTURE(one.is_rig);
    const std::filesystem::path there = folder.path() / one.output;
    const std::string text = contents(one.is_rig ? rig : long_drive);
    std::ofstream(there) << text;
    const ProgramOutput output = run_tagsmith("plan " + (one.is_rig ? long_drive : there.string()) +
                                              " --rig " + (one.is_rig ? there.string() : rig) +
                                              " --paper a4 -o " + folder.path().string());
    CHECK(output.exit_code == 2);
    CHECK(output.err.find("would replace") != std::string::npos);
    CHECK(contents(there) == text);
    std::filesystem::remove(there);
  }
}
