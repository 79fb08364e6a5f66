// SPDX-License-Identifier: Apache-2.0
// `tagsmith adjust` as its users run it, on the shipped corridor.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/schemas/schema_judge.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"
#include "tests/support/tilted_corridor.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using nlohmann::json;

namespace {

const std::string kRig = " --rig surveys/corridor/rig.yaml";
const std::string kRun = " --run surveys/corridor/run.csv";

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

// A copy of the corridor's survey in which 002L is said to hang 30 mm too high. The pictures tie
// 001L, 001R, 002L and 002R together.
struct MovedCorridor {
  TemporaryFolder folder;
  std::string survey = (folder.path() / "survey.yaml").string();
  std::string output = (folder.path() / "as-built.yaml").string();

  MovedCorridor() {
    REQUIRE(write_file(
        survey, contents("surveys/corridor/survey.yaml") +
                    "placed:\n"
                    "  # by the total station\n"
                    "  - { tag: 001L, side: left, p: [1.9, 0.8, 0.4], control: true }  # prism 1\n"
                    "  - { tag: 001R, side: right, p: [0, 1.143, 0.4], control: true }\n"
                    "  - { tag: 002R, side: right, p: [0, 1.943, 0.4], control: true }\n"
                    "  - { tag: 002L, side: left, p: [1.9, 1.6, 0.43], digits: \"01900160040\" }"
                    "  # by tape\n"));
  }

  ProgramOutput run(const std::string& arguments) const {
    return run_tagsmith("adjust " + survey + kRig + " " + arguments);
  }
};

json line_of(const std::string& text, const std::string& tag) {
  for (const json& line : json_lines(text)) {
    if (line.value("tag", "") == tag) return line;
  }
  FAIL("no line of " << tag);
  return {};
}

// The places across the sheet of a path's points, millimetres.
std::vector<double> numbers_across(const std::string& path) {
  static const std::regex kPoint("[ML](-?[0-9.]+) -?[0-9.]+");
  std::vector<double> numbers;
  for (std::sregex_iterator at(path.begin(), path.end(), kPoint), end; at != end; ++at) {
    numbers.push_back(std::stod((*at)[1]));
  }
  return numbers;
}

// The paths of a layer of a drawing.
std::vector<std::string> paths_of(const std::string& svg, const std::string& layer) {
  const std::size_t begin = svg.find("id=\"" + layer + "\"");
  REQUIRE(begin != std::string::npos);
  const std::string group = svg.substr(begin, svg.find("</g>", begin) - begin);
  static const std::regex kPath(" d=\"([^\"]*)\"");
  std::vector<std::string> paths;
  for (std::sregex_iterator at(group.begin(), group.end(), kPath), end; at != end; ++at) {
    paths.push_back((*at)[1]);
  }
  return paths;
}

}  // namespace

TEST_CASE("a run puts a tag in its place, in a survey that keeps its comments") {
  const MovedCorridor corridor;
  const ProgramOutput output =
      corridor.run(kRun + " --json --date 2026-03-31 -o " + corridor.output);
  CHECK_MESSAGE(output.exit_code == 1, output.err);  // other tags are in no chain
  const json moved = line_of(output.out, "002L");
  CHECK(moved["status"] == "adjusted");
  CHECK(std::abs(moved["p"][2].get<double>() - 0.4) < 3 * moved["sigma"][2].get<double>());
  CHECK(moved["sigma"][2].get<double>() < 0.01);
  CHECK(line_of(output.out, "001L")["status"] == "control");
  CHECK(line_of(output.out, "000L")["reason"] == "no chain of photos ties it to a control tag");

  const std::string written = contents(corridor.output);
  CHECK(has(written, "  # by the total station\n"));
  CHECK(has(written, "p: [1.9, 0.8, 0.4], control: true }  # prism 1\n"));
  CHECK(has(written, "digits: \"01900160040\", sigma: 0.00"));
  CHECK(has(written, "date: 2026-03-31"));
  CHECK(has(written, "}  # by tape\n"));
  CHECK(run_tagsmith("validate " + corridor.output).exit_code == 0);
  const auto survey = load_survey(corridor.output);
  REQUIRE(survey);
  const PlacedTag& tag = *find_tag(*survey, std::string_view("002L"));
  CHECK(std::abs(tag.p_in_grid.z() - 0.4) < 3 * tag.sigma + 0.001);
}

TEST_CASE("a tag that the survey knows better than the photos tell is named") {
  const MovedCorridor corridor;
  const std::string errors = corridor.run(kRun + " --control 001L,001R").err;
  CHECK_MESSAGE(has(errors, "less well than the survey does: 002R: with `control: true`"), errors);
}

TEST_CASE("the changes alone make the survey that is written, and a drawing shows them") {
  const MovedCorridor corridor;
  const std::string diff = corridor.output + ".diff", drawing = corridor.output + ".svg";
  const std::string as_surveyed = contents(corridor.survey);
  corridor.run(kRun + " --json --date 2026-03-31 -o " + corridor.output + " --diff " + diff +
               " --drawing " + drawing);
  REQUIRE_MESSAGE(has_program("patch"), "patch is missing: install patch");
  CHECK(run_shell("patch -s " + corridor.survey + " " + diff).exit_code == 0);
  CHECK(contents(corridor.survey) == contents(corridor.output));
  CHECK(contents(corridor.survey) != as_surveyed);
  const std::string svg = contents(drawing);
  CHECK(has(svg, "id=\"moved\""));
  CHECK((has(svg, ">-30.") || has(svg, ">-29.")));  // 002L, millimetres below its surveyed place
}

TEST_CASE("a drawing says by how much its ellipses are magnified against the plan") {
  const MovedCorridor corridor;
  const std::string drawing = corridor.output + ".svg";
  const ProgramOutput output =
      corridor.run(kRun + " --json -o " + corridor.output + " --drawing " + drawing);
  const std::string svg = contents(drawing);
  std::smatch told;
  REQUIRE(std::regex_search(svg, told, std::regex("magnified ([0-9.]+) times")));
  // 001L and 002L were surveyed 0.8 m apart along the drive; an arrow is a line and its head.
  const std::vector<std::string> arrows = paths_of(svg, "moved");
  REQUIRE(arrows.size() > 4);
  const double per_metre =
      (numbers_across(arrows[4]).front() - numbers_across(arrows[0]).front()) / 0.8;
  REQUIRE(per_metre > 0);
  const std::vector<double> ellipse = numbers_across(paths_of(svg, "ellipses").front());
  const auto [least, most] = std::ranges::minmax(ellipse);
  const double sigma = line_of(output.out, "001L")["sigma"][1].get<double>();
  // Of two dimensions 95 % lie within 2.448 standard deviations.
  const double magnified = (most - least) / (2 * 2.448 * sigma * per_metre);
  CHECK(magnified == doctest::Approx(std::stod(told[1])).epsilon(0.02));
}

TEST_CASE("lines of verify take the place of the photos") {
  const MovedCorridor corridor;
  const ProgramOutput by_photos = corridor.run(kRun + " --json");
  const ProgramOutput verified = run_tagsmith("verify --json " + corridor.survey + kRig + kRun);
  const fs::path lines = corridor.folder.path() / "lines.jsonl";
  REQUIRE(write_file(lines, verified.out));
  const ProgramOutput by_lines = corridor.run(kRun + " --json " + lines.string());
  CHECK(by_lines.exit_code == 1);
  const json a = line_of(by_photos.out, "002L");
  const json b = line_of(by_lines.out, "002L");
  CHECK(a["p"][2].get<double>() == doctest::Approx(b["p"][2].get<double>()).epsilon(1e-4));
  // In words.
  const ProgramOutput words = corridor.run(kRun + " " + lines.string());
  CHECK(has(words.out, "1 tags adjusted to 3 control tags"));
  CHECK(has(words.out, "000L undetermined: no chain of photos ties it to a control tag"));
}

TEST_CASE("--control names other control tags, and a contradicted one stops the writing") {
  const MovedCorridor corridor;
  const ProgramOutput all = corridor.run(
      kRun + " --control 000L,001L,002L,003L,005L,006L,004L,001R,002R -o " + corridor.output);
  CHECK(all.exit_code == 1);
  CHECK(has(all.out, "contradicted: is a control tag, but hangs "));
  CHECK_MESSAGE(has(all.err, "was not written"), all.err);
  CHECK_FALSE(fs::exists(corridor.output));
  const ProgramOutput determined =
      corridor.run(kRun + " --control 000L,001L,001R,002R,003L,005L,006L -o " + corridor.output);
  CHECK_MESSAGE(determined.exit_code == 0, determined.out);
  CHECK(run_tagsmith("validate " + corridor.output).exit_code == 0);
}

TEST_CASE("wrong use is refused with its remedy") {
  const MovedCorridor corridor;
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    CAPTURE(arguments);
    const ProgramOutput output = run_tagsmith("adjust " + arguments + " -o " + corridor.output);
    CHECK(output.exit_code == 2);
    CHECK_MESSAGE(has(output.err, words), output.err);
    CHECK_FALSE(fs::exists(corridor.output));
  };
  const std::string shipped = "surveys/corridor/survey.yaml" + kRig;
  refused(shipped + kRun, "has no control tag: write `control: true`");
  refused(shipped + kRun + " --control 099L", "--control 099L: ");
  refused(shipped + kRun + " --control 004L", "no control tag was seen together");
  refused(shipped + " --control 001L", "FILE is required");
  refused(shipped + kRun + " --control 001L --date 31.3.2026", "--date");
  refused(shipped + kRun + " --control 099L --date 2998-01-31", "2998-01-31 lies in the future");
  refused("surveys/corridor/survey.yaml --control 001L" + kRun, "--rig");
  const fs::path lines = corridor.folder.path() / "lines.jsonl";
  REQUIRE(write_file(lines, run_tagsmith("verify --json " + corridor.survey + kRig + kRun).out));
  refused(shipped + kRun + " --control 001L " + lines.string(),
          "verified against another state of the survey");
  const fs::path other = corridor.folder.path() / "other.jsonl";
  REQUIRE(write_file(other, "{}\n"));
  refused(shipped + kRun + " --control 001L " + other.string(), "has no line of `verify --json`");
}

TEST_CASE("a line that was cut short is a finding though every tag has its place") {
  const TemporaryFolder folder;
  const std::string survey = "surveys/corridor/survey.yaml";
  const std::string lines = (folder.path() / "run.jsonl").string();
  const ProgramOutput verified = run_tagsmith("verify --json " + survey + kRig + kRun);
  const std::string adjust = "adjust " + survey + kRig + kRun +
                             " --control 000L,000R,001L,001R,002L,002R,003L,003R,005L,005R,006L,"
                             "006R,007L,007R " +
                             lines;
  REQUIRE(write_file(lines, verified.out));
  CHECK(run_tagsmith(adjust).exit_code == 0);
  REQUIRE(write_file(lines, verified.out + "{\"file\":"));
  CHECK(run_tagsmith(adjust).exit_code == 1);
}

TEST_CASE("adjust prints what its schema says") {
  const MovedCorridor corridor;
  SchemaJudge judge(schema_json("output/adjust"));
  for (const char* control : {"001L", "001L,001R,002L,002R"}) {
    const ProgramOutput output = corridor.run(kRun + " --json --control " + control);
    for (json line : json_lines(output.out)) {
      CHECK_MESSAGE(judge.accepts(line), line.dump() << "\n" << judge.objections(line));
      line["colour"] = 1;
      CHECK_FALSE(judge.accepts(line));
    }
  }
}

TEST_CASE("a wrong rig adjusts nothing, and is told") {
  const TemporaryFolder folder;
  std::string rig = contents("surveys/corridor/rig.yaml");
  const std::string right = "alpha: 35, side: left";
  rig.replace(rig.find(right), right.size(), "alpha: 40, side: left");
  const std::string file = (folder.path() / "rig.yaml").string();
  REQUIRE(write_file(file, rig).has_value());
  const std::string written = (folder.path() / "as-built.yaml").string();
  const ProgramOutput output = run_tagsmith(
      "adjust surveys/corridor/survey.yaml --rig '" + file +
      "' --run surveys/corridor/run.csv --control 000L,000R,007L,007R -o '" + written + "'");
  CHECK(output.exit_code == 1);
  CHECK(output.out.empty());
  CHECK(output.err.find("the rig is in doubt, and nothing was adjusted: ") != std::string::npos);
  CHECK(std::regex_search(output.err, std::regex("left: alpha 3(4\\.99|5\\.0)")));
  CHECK(!std::filesystem::exists(written));
}

TEST_CASE("plates that all lean otherwise than surveyed adjust nothing, and are told") {
  const TemporaryFolder folder;
  const std::string survey = (folder.path() / "survey.yaml").string();
  REQUIRE(write_file(survey, tilted_corridor(-1.5)));
  const ProgramOutput output =
      run_tagsmith("adjust '" + survey +
                   "' --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv "
                   "--control 000L,000R,007L,007R");
  CHECK(output.exit_code == 1);
  CHECK(output.out.empty());
  CHECK(output.err.find("the plates are in doubt, and nothing was adjusted: plates of "
                        "both walls that lean forward by 1.5") != std::string::npos);
}
