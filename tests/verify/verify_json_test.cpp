// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_json.hpp"

#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/json.hpp"

namespace tagsmith::detail {
namespace {

using nlohmann::json;

// A photo with all that a line may say: a tag in order, and one that hangs elsewhere.
VerifiedFile photo() {
  VerifiedFile file{"a.jpg"};
  file.sha256 = "abc";
  file.revision = "def";
  file.width = 1280;
  file.height = 960;
  file.orientation = 6;
  file.lens = PhotoLens{"Maker Phone 7", 5.43, 26};
  file.taken = "2026-03-31T14:05:09+02:00";
  file.up = UpSource::camera;
  file.notes = {"damaged"};
  file.picture.file = "a-whole.png";
  file.stale = true;
  file.add_finding("changed-file", "it was changed");
  VerifiedTag& good = file.tags.emplace_back();
  good.tag = "000L";
  good.digits = parse_digits("019000000404");
  good.corners = {{{1, 2}, {3.5, 2}, {3.5, 4.25}, {1, 4.25}}};
  good.module_px = 2.5;
  good.confidence = 0.999999;
  good.corner_covariance.setIdentity();
  good.grade = SymbolGrade{3.4, GradeParameter::defects, true};
  good.grade->means[5] = {3.25, 0.125};
  good.hung = HungTag{"000L", HangVerdict::fits, 2, {{0.001, 0, 0}, {0.002, 0, 0}}, {}, {}, "", ""};
  VerifiedTag& moved = file.tags.emplace_back();
  moved.finding = {TagStatus::misplaced, "moved", "raise it"};
  moved.tag = "001L";
  moved.digits = parse_digits("019000800402");
  moved.grade_reason = "too far";
  moved.picture.file = "a-1.png";
  moved.hung = HungTag{"001L", HangVerdict::off, 1, {}, {}, {"000L"}, "", ""};
  moved.hung->placed = "{ tag: 001L, side: left }";
  VerifiedTag& unknown = file.tags.emplace_back();
  unknown.finding = {TagStatus::unknown, "not-in-survey", "strange"};
  unknown.digits = parse_digits("123456789012");
  unknown.in_place_of = "001R";
  return file;
}

}  // namespace

TEST_CASE("lines of verify") {
  VerifiedFile file{"a.pdf"};
  file.pages = 2;
  VerifiedTag& good = file.tags.emplace_back();
  good.tag = "000L";
  good.digits = parse_digits("019000000404");
  good.confidence = 1;
  good.page = 1;
  VerifiedTag& bad = file.tags.emplace_back();
  bad.finding = {TagStatus::unreadable, "too-small", "too small"};
  bad.page = 2;
  const json line = test::parsed_json(to_json_line(file));
  CHECK(line["file"] == "a.pdf");
  CHECK(line["pages"] == 2);
  CHECK(line["findings"] == json{"page 2: unreadable: too small"});
  CHECK(line["rules"] == json{"too-small"});
  CHECK(line["tags"][0]["tag"] == "000L");
  CHECK(line["tags"][0]["status"] == "ok");
  CHECK(line["tags"][0]["digits"] == "019000000404");
  CHECK(line["tags"][0]["corners"].size() == 4);
  CHECK(line["tags"][0]["page"] == 1);
  CHECK(line["tags"][1]["tag"].is_null());
  CHECK(line["tags"][1]["digits"].is_null());
  CHECK(line["tags"][1]["status"] == "unreadable");
  CHECK(line["tags"][1]["message"] == "too small");
}

TEST_CASE("a line that is read back says the same again") {
  const std::string line = to_json_line(photo());
  const auto read = verified_file_from(line);
  REQUIRE(read);
  CHECK(read->findings == std::vector<std::string>{"it was changed"});
  CHECK(read->rules == std::set<std::string>{"changed-file"});
  CHECK(to_json_line(*read) == line);
}

TEST_CASE("what is no line of verify is none") {
  json line = test::parsed_json(to_json_line(photo()));
  for (const char* key : {"file", "tags"}) {
    json other = line;
    other.erase(key);
    CHECK(!verified_file_from(other.dump()));
    other[key] = 3;
    CHECK(!verified_file_from(other.dump()));
  }
  for (const char* text : {"", "{", "3", "[]", "null"}) CHECK(!verified_file_from(text));
  for (const double width : {1e73, 0.5}) {  // no number of pixels
    json other = line;
    other["width"] = width;
    CHECK(!verified_file_from(other.dump()));
  }
  line["tags"][0]["corners"][0][0] = 1e300;
  CHECK(!verified_file_from(line.dump()));
}

}  // namespace tagsmith::detail
