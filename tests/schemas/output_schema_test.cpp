// SPDX-License-Identifier: Apache-2.0
// What the commands print and write for programs obeys docs/schemas/output, which allows no field
// that it does not describe.
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tests/schemas/schema_judge.hpp"
#include "tests/support/exif_jpeg.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using Json = nlohmann::json;

namespace {

const std::string kSurvey = "surveys/corridor/survey.yaml";
const std::string kRig = " --rig surveys/corridor/rig.yaml";
const std::string kRun = " --run surveys/corridor/run.csv";

// Every line of the text is an object that the schema accepts, and it is no longer with another
// key.
void check_lines(const std::string& name, const std::string& text) {
  SchemaJudge judge(schema_json("output/" + name));
  int count = 0;
  for (const std::string& line : split(text, '\n')) {
    if (line.empty()) continue;
    Json document = Json::parse(line);
    CHECK_MESSAGE(judge.accepts(document), name << ": " << line << "\n"
                                                << judge.objections(document));
    document["colour"] = 1;
    CHECK_FALSE(judge.accepts(document));
    ++count;
  }
  CHECK_MESSAGE(count > 0, name);
}

void check_file(const std::string& name, const fs::path& file) {
  check_lines(name, Json::parse(read_file(file).value()).dump());
}

// A copy of the corridor's survey with one text in place of another.
std::string changed_survey(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = read_file(kSurvey).value();
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(), to);
  REQUIRE(write_file(file, text));
  return file.string();
}

}  // namespace

TEST_CASE("every key of the outputs is described") {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator("docs/schemas/output")) {
    const std::string name = entry.path().stem().stem().string();
    names.insert(name);
    for (const std::string& key : undescribed_keys(schema_json("output/" + name))) {
      FAIL_CHECK(name << ": " << key);
    }
  }
  CHECK(names.size() == 17);
}

TEST_CASE("read, verify and report print what their schemas say") {
  const TemporaryFolder folder;
  const std::string lines = (folder.path() / "verify.jsonl").string();
  const std::string crops = " --crops " + (folder.path() / "crops").string();
  check_lines("read", run_tagsmith("read --json surveys/corridor/photos").out);
  const std::string with_parts =
      run_tagsmith("read --json --survey " + kSurvey + " surveys/corridor/photos").out;
  CHECK(with_parts.find("\"digits_in_sight\":\"019003------\"") != std::string::npos);
  check_lines("read", with_parts);
  check_lines("read", run_tagsmith("read --json --reader paper surveys/corridor/photos").out);
  const std::string print = (folder.path() / "print").string();
  check_lines(
      "print",
      run_tagsmith("print " + kSurvey + " --json --proof --tags 000L,001R -o " + print).out);
  check_lines("board", run_tagsmith("board --json -o " + print + "-board.pdf").out);
  check_file("manifest", folder.path() / "print" / "manifest.json");
  const std::string verified =
      run_tagsmith("verify --json " + kSurvey + " surveys/corridor/photos " + print + kRig + kRun)
          .out;
  check_lines("verify", verified);
  REQUIRE(write_file(lines, verified));
  check_lines("report", run_tagsmith("report --json " + kSurvey + " " + lines).out);
  check_lines("report", run_tagsmith("report --json " + kSurvey + " " + lines + kRig + kRun).out);
  // Photos and prints of another tunnel: findings of most kinds.
  check_lines("verify", run_tagsmith("verify --json surveys/curved/survey.yaml "
                                     "surveys/corridor/photos " +
                                     print + crops)
                            .out);
}

TEST_CASE("report prints of a ledger what its schema says") {
  const TemporaryFolder folder;
  const std::string ledger = " --ledger " + (folder.path() / "mine.db").string();
  const std::string report = "report --json " + kSurvey + ledger;
  run_tagsmith("verify " + kSurvey + kRig + kRun + ledger);
  check_lines("ledger", run_tagsmith(report).out);
  // A trend, by a photo that is near enough to be graded.
  const std::string photo = read_file("surveys/corridor/photos/corridor_03_right.jpg").value();
  for (const char* day : {"01", "02", "03"}) {
    const std::string moment = "2026:03:" + std::string(day) + " 10:00:00";
    REQUIRE(write_file(folder.path() / "photos" / (std::string(day) + "_right.jpg"),
                       with_moment(photo, moment)));
  }
  const std::string photos = (folder.path() / "photos").string();
  const std::string lines = run_tagsmith("verify --json " + kSurvey + " " + photos + ledger).out;
  CHECK(run_tagsmith(report).out.find("not_before") != std::string::npos);
  check_lines("ledger", run_tagsmith(report).out);
  // The same plate, said to hang elsewhere on the last day.
  std::string moved = lines;
  const std::size_t at = moved.rfind("\"status\":\"ok\",\"digits\"");
  REQUIRE(at != std::string::npos);
  moved.replace(at, 13, "\"rule\":\"moved\",\"message\":\"raise it\",\"status\":\"misplaced\"");
  REQUIRE(write_file(folder.path() / "lines.jsonl", moved));
  const std::string again =
      run_tagsmith(report + " " + (folder.path() / "lines.jsonl").string()).out;
  CHECK(again.find("\"rehang\":[\"") != std::string::npos);
  check_lines("ledger", again);
}

TEST_CASE("localize, calibrate and simulate print what their schemas say") {
  const TemporaryFolder folder;
  const std::string localize = "localize --json " + kSurvey + kRig + kRun;
  check_lines("localize", run_tagsmith(localize + " --method both --explain").out);
  check_lines("localize", run_tagsmith("localize --json surveys/curved/survey.yaml --rig "
                                       "surveys/curved/rig.yaml --run surveys/curved/run.csv")
                              .out);
  check_lines("localize", run_shell("echo '{}' | \"$TAGSMITH_PROGRAM\" localize --json --follow " +
                                    kSurvey + kRig)
                              .out);
  // What it prints of boards is judged where the photos of boards are.
  check_lines("calibrate", run_tagsmith("calibrate --json --survey " + kSurvey + kRig + kRun).out);
  const std::string run = (folder.path() / "run.csv").string();
  REQUIRE(write_file(run, "id,left,right,d,truth_x,truth_y,truth_z\n1,,,0.9,1,0,0.24\n"));
  const std::string output = (folder.path() / "simulated").string();
  check_lines(
      "simulate",
      run_tagsmith("simulate --json " + kSurvey + kRig + " --run " + run + " -o " + output).out);
  check_file("truth", folder.path() / "simulated" / "truth.json");
}

TEST_CASE("plan, export, new, diff and validate print what their schemas say") {
  const TemporaryFolder folder;
  const std::string plan = "plan --json --to 3 " + kSurvey + kRig;
  check_lines("plan", run_tagsmith(plan).out);
  check_lines("plan", run_tagsmith(plan + " --optimise --plane-sigma 5").out);
  for (const char* survey : {"corridor", "curved", "drift"}) {
    const fs::path file = folder.path() / (std::string(survey) + ".json");
    run_tagsmith("export surveys/" + std::string(survey) + "/survey.yaml -o " + file.string());
    check_file("export", file);
  }
  const std::string points = (folder.path() / "points.csv").string();
  run_tagsmith("export " + kSurvey + " -o " + points);
  check_lines("new", run_tagsmith("new " + (folder.path() / "draft").string() + " --from " +
                                  points + " --order own --json")
                         .out);
  const std::string moved =
      changed_survey(folder.path() / "moved.yaml", "height: 0.4", "height: 0.5");
  check_lines("diff", run_tagsmith("diff --json " + kSurvey + " " + moved).out);
  const std::string broken = changed_survey(folder.path() / "broken.yaml", "spacing:", "spacign:");
  check_lines("validate", run_tagsmith("validate --json " + broken).out);
  check_lines("validate", run_tagsmith("validate --json --fix " + broken).out);
}
