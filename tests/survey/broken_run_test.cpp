// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/run.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

Rig trial_rig() {
  Rig rig;
  rig.name = "trial";
  rig.cameras.resize(2);
  rig.cameras[0].name = "left";
  rig.cameras[1].name = "right";
  rig.ranges.push_back({"d", Side::left, 0.25, 5, 0.01});
  return rig;
}

Result<Run> read_text_as_run(const std::string& text) {
  const TemporaryFolder folder;
  return load_run(write_text(folder.path() / "run.csv", text), trial_rig());
}

const char* kRightRun =
    "id,time,left,right,d,truth_x,truth_y,truth_z,truth_heading\n"
    "1,0.5,a.jpg,b.jpg,0.9,1,2,3,90\n"
    "2,,,b.jpg,,,,,\n";

}  // namespace

TEST_CASE("a run's columns become measurements") {
  const TemporaryFolder folder;
  const auto run = load_run(write_text(folder.path() / "run.csv", kRightRun), trial_rig());
  REQUIRE_MESSAGE(run.has_value(), run.error().message);
  REQUIRE(run->measurements.size() == 2);
  const Measurement& first = run->measurements[0];
  CHECK(first.id == "1");
  CHECK(first.line == 2);
  CHECK(first.time == 0.5);
  CHECK(first.cameras.at("left").image == folder.path() / "a.jpg");
  CHECK(first.ranges.at("d") == 0.9);
  CHECK(*first.truth_in_grid == Eigen::Vector3d(1, 2, 3));
  CHECK(*first.truth_heading == doctest::Approx(radians(90)));
  const Measurement& second = run->measurements[1];
  CHECK(second.cameras.size() == 1);
  CHECK(second.ranges.empty());
  CHECK_FALSE(second.truth_in_grid.has_value());
}

TEST_CASE("spreadsheets' habits are read: BOM, CRLF, quotes, empty lines, blanks") {
  const auto run = read_text_as_run(
      "\xEF\xBB\xBF\"id\",left,d\r\n"
      "\r\n"
      "1, \"a,\"\"b\"\".jpg\" , 0.9\r\n"
      "   \r\n"
      "2,c d.jpg,\"1.5\"");
  REQUIRE_MESSAGE(run.has_value(), run.error().message);
  REQUIRE(run->measurements.size() == 2);
  CHECK(run->measurements[0].cameras.at("left").image.filename() == "a,\"b\".jpg");
  CHECK(run->measurements[0].line == 3);
  CHECK(run->measurements[1].ranges.at("d") == 1.5);
}

TEST_CASE("distances already measured stand beside their tags") {
  const auto run = read_text_as_run("id,left_tag,left_distance,d\n1,000L,1.04,0.9\n2,,,0.9\n");
  REQUIRE_MESSAGE(run.has_value(), run.error().message);
  CHECK(run->measurements[0].cameras.at("left").tag == "000L");
  CHECK(run->measurements[0].cameras.at("left").distance == 1.04);
  CHECK(run->measurements[1].cameras.empty());
}

TEST_CASE("every way to break a run is reported with its place") {
  struct Case {
    std::string name;
    const char* text;
    const char* expected;
  };
  const Case cases[] = {
      {"empty", "", "run.csv:1: error: the file is empty"},
      {"no rows", "id,left\n", "no rows after the column names"},
      {"no id", "left,d\na,1\n", "run.csv:1: error: the column `id` is missing"},
      {"no camera", "id,d\n1,1\n", "no column of a camera"},
      {"unknown column", "id,left,dd\n1,a,1\n", "run.csv:1:3: error: unknown column `dd`"},
      {"did you mean", "id,lefft\n1,a\n", "did you mean `left`?"},
      {"column twice", "id,left,left\n1,a,b\n", "run.csv:1:3: error: the column `left` a second"},
      {"semicolons", "id;left;d\n1;a;1\n", "separate the columns by commas"},
      {"tabs", "id\tleft\td\n1\ta\t1\n", "separate the columns by commas"},
      {"carriage returns alone", "id,left\r1,a\r", "end lines with LF or CR LF"},
      {"tag alone", "id,left_tag\n1,000L\n", "the column `left_distance` is missing"},
      {"half a truth", "id,left,truth_x\n1,a,1\n", "the column `truth_y` is missing"},
      {"too few fields", "id,left,d\n1,a\n", "run.csv:2: error: 2 fields, expected 3"},
      {"decimal comma", "id,left,d\n1,a,0,9\n", "a decimal comma splits a field"},
      {"quoted decimal comma", "id,left,d\n1,a,\"0,9\"\n", "the decimal sign is a point"},
      {"word", "id,left,d\n1,a,near\n", "run.csv:2:3: error: d is `near`, expected a finite"},
      {"infinity", "id,left,d\n1,a,inf\n", "d is `inf`, expected a finite number"},
      {"negative range", "id,left,d\n1,a,-0.5\n", "d is -0.5, expected 0 to 10000"},
      {"huge range", "id,left,d\n1,a,1e300\n", "d is 1e300, expected 0 to 10000"},
      {"distance of nothing", "id,left_tag,left_distance\n1,000L,0\n", "expected 0.001 to 10000"},
      {"tag without distance", "id,left_tag,left_distance\n1,000L,\n",
       "a tag without its distance"},
      {"distance without tag", "id,left_tag,left_distance\n1,,1\n", "a distance without its tag"},
      {"truth in part", "id,left,truth_x,truth_y,truth_z\n1,a,1,,3\n", "expected all or none"},
      {"no id in a row", "id,left\n,a\n", "run.csv:2:1: error: the id is empty"},
      {"photo twice", "id,left,right\n1,a,a\n", "run.csv:2:3: error: the photo of right is that"},
      {"id twice", "id,left\n1,a\n1,b\n", "run.csv:3: error: the id `1` a second time"},
      {"open quote", "id,left\n1,\"a\n", "run.csv:2: error: a quote that is not closed"},
      {"quote inside", "id,left\n1,a\"b\n", "run.csv:2: error: a quote that is not closed"},
      {"text behind a quote", "id,left\n1,\"a\"b\n", "run.csv:2: error: a quote"},
  };
  for (const Case& broken : cases) {
    CAPTURE(broken.name);
    const auto run = read_text_as_run(broken.text);
    REQUIRE_FALSE(run.has_value());
    CHECK_MESSAGE(run.error().message.find(broken.expected) != std::string::npos,
                  run.error().message);
  }
}

TEST_CASE("rows that cannot be used are not called absent rows") {
  for (const char* text : {"id,left,d\n1,a\n", "id\tleft\n1\ta\n"}) {
    const auto run = read_text_as_run(text);
    REQUIRE_FALSE(run.has_value());
    const std::string& message = run.error().message;
    CHECK_MESSAGE(message.find("no rows") == std::string::npos, message);
    CHECK_MESSAGE(message.find("is empty") == std::string::npos, message);
  }
}

TEST_CASE("all faults of a run are reported together") {
  const auto run = read_text_as_run("id,left,d\n1,a,x\n1,b,-1\n3,c\n");
  REQUIRE_FALSE(run.has_value());
  for (const char* place : {"run.csv:2:3:", "run.csv:3:", "run.csv:3:3:", "run.csv:4:"}) {
    CHECK_MESSAGE(run.error().message.find(place) != std::string::npos, run.error().message);
  }
}
