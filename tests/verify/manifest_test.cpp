// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/manifest.hpp"

#include <doctest/doctest.h>

#include "decoder/verify/evidence.hpp"
#include "decoder/verify/findings.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/support/program.hpp"
#include "tests/verify/survey_of_four.hpp"

namespace tagsmith::detail {
namespace {

using test::reading_of;
using test::survey_of_four;

const char* const kManifest = R"({"survey": "little", "tags": [
  {"tag": "000L", "digits": "019000000404", "files": ["000L.pdf", "000L.svg"]},
  {"tag": "000R", "digits": "000000340401", "files": ["000R.pdf"]},
  {"tag": "001L", "digits": "019000810403", "files": ["001L.pdf"]},
  {"tag": "009L", "digits": "019009000403", "files": ["009L.pdf"]}]})";

PrintManifest manifest_of(const char* text) {
  const test::TemporaryFolder folder;
  REQUIRE(write_file(folder.path() / "manifest.json", text).has_value());
  const auto manifest = find_manifest(folder.path() / "000L.pdf");
  REQUIRE(manifest.has_value());
  REQUIRE(manifest->has_value());
  return **manifest;
}

// A file that holds a tag with these digits, as verify judges it.
VerifiedFile verified(const char* name, const char* digits) {
  const Survey survey = survey_of_four();
  const PrintManifest manifest = manifest_of(kManifest);
  const std::vector<ManifestTag> expected = tags_of_file(manifest, name);
  PictureEvidence evidence{survey, {}};
  evidence.expected = expected;
  see_tags([&](auto&, auto&) { return ReadResult{{reading_of(digits)}, {}}; }, evidence);
  find_faults(evidence);
  VerifiedFile file{name};
  for (const TagEvidence& seen : evidence.tags) file.tags.push_back(seen.tag);
  find_missing(expected, file);
  find_stale(manifest, survey, file);
  return file;
}

}  // namespace

TEST_CASE("a manifest is read") {
  const PrintManifest manifest = manifest_of(kManifest);
  CHECK(manifest.survey == "little");
  REQUIRE(manifest.tags.size() == 4);
  CHECK(manifest.tags[0].name == "000L");
  CHECK(to_string(manifest.tags[0].digits) == "019000000404");
  CHECK(manifest.tags[0].files == std::vector<std::string>{"000L.pdf", "000L.svg"});
}

TEST_CASE("a page's window and the steps to the next pages are read in metres") {
  const std::string manifest = R"({"survey": "little", "tags": [], "page_mm": [210, 297],
    "tiles": {"columns": 3, "rows": 2, "window_mm": [10, 12, 180, 260], "step_mm": [170, 250]}})";
  const std::optional<TilePlan> plan = manifest_of(manifest.c_str()).tiles;
  REQUIRE(plan);
  CHECK(plan->columns == 3);
  CHECK(plan->rows == 2);
  CHECK(plan->page_width == doctest::Approx(0.210));
  CHECK(plan->page_height == doctest::Approx(0.297));
  CHECK(plan->window.x == doctest::Approx(0.010));
  CHECK(plan->window.y == doctest::Approx(0.012));
  CHECK(plan->window.width == doctest::Approx(0.180));
  CHECK(plan->window.height == doctest::Approx(0.260));
  CHECK(plan->step_right == doctest::Approx(0.170));
  CHECK(plan->step_down == doctest::Approx(0.250));
}

TEST_CASE("no manifest, and one that is something else, are no manifest") {
  const test::TemporaryFolder folder;
  CHECK(!find_manifest(folder.path() / "a.pdf")->has_value());
  REQUIRE(write_file(folder.path() / "manifest.json", R"({"short_name": "web app"})").has_value());
  CHECK(!find_manifest(folder.path() / "a.pdf")->has_value());
}

TEST_CASE("the setting-out list is stale when one of its tags is") {
  PrintManifest manifest = manifest_of(kManifest);
  manifest.documents = {"setting-out.pdf"};
  VerifiedFile list{"setting-out.pdf"};
  find_stale(manifest, survey_of_four(), list);
  CHECK(list.stale);
  CHECK(list.findings ==
        std::vector<std::string>{
            "stale: it lists 001L 009L as before the survey was changed: print it again"});
  manifest.tags.resize(2);
  VerifiedFile fresh{"setting-out.pdf"};
  find_stale(manifest, survey_of_four(), fresh);
  CHECK(!fresh.stale);
}

TEST_CASE("a folder's manifest is parsed once, and one of many folders again when it is due") {
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& name, const char* text) {
    REQUIRE(write_file(folder.path() / name / "manifest.json", text).has_value());
  };
  write("a", kManifest);
  ManifestCache cache;
  const auto first = cache.find(folder.path() / "a" / "000L.pdf");
  REQUIRE(first.has_value());
  REQUIRE(*first != nullptr);
  write("a", "broken");
  CHECK(cache.find(folder.path() / "a" / "000R.pdf").value() == *first);
  for (int i = 0; i < 8; ++i) {
    CHECK(*cache.find(folder.path() / std::to_string(i) / "a.pdf") == nullptr);
  }
  CHECK(!cache.find(folder.path() / "a" / "000R.pdf").has_value());
}

TEST_CASE("a broken manifest is an error") {
  for (const char* text :
       {"", "{", R"({"survey": 1, "tags": []})", R"({"survey": "a", "tags": {}})",
        R"({"survey": "a", "tags": [1]})", R"({"survey": "a", "tags": [{"tag": "000L"}]})",
        R"({"survey": "a", "tags": [{"tag": "000L", "digits": "12", "files": []}]})",
        R"({"survey": "a", "tags": [{"tag": "0", "digits": "019000000404", "files": [3]}]})"}) {
    CAPTURE(text);
    const test::TemporaryFolder folder;
    REQUIRE(write_file(folder.path() / "manifest.json", text).has_value());
    const auto manifest = find_manifest(folder.path() / "a.pdf");
    REQUIRE(!manifest.has_value());
    CHECK(manifest.error().message.find("manifest.json: ") != std::string::npos);
  }
}

TEST_CASE("a print file holds what the manifest says") {
  const VerifiedFile report = verified("000L.pdf", "019000000404");
  CHECK(report.tags[0].finding.status == TagStatus::ok);
  CHECK(report.findings.empty());
}

TEST_CASE("a file that the manifest does not name is left alone") {
  const VerifiedFile report = verified("copy.pdf", "019000000404");
  CHECK(report.tags[0].finding.status == TagStatus::ok);
  CHECK(report.findings.empty());
}

TEST_CASE("another tag of the survey in a print file is misprinted") {
  const VerifiedFile report = verified("000R.pdf", "019000000404");
  CHECK(report.tags[0].finding.status == TagStatus::misprinted);
  CHECK(report.tags[0].finding.message ==
        "000L 019000000404 stands in this file, expected 000R (manifest.json)");
  CHECK(report.findings ==
        std::vector<std::string>{
            "000R 000000340401 was not read, but manifest.json says it is here"});
}

TEST_CASE("a print from an older survey is found") {
  const VerifiedFile moved = verified("001L.pdf", "019000810403");
  CHECK(moved.findings == std::vector<std::string>{
                              "stale: 001L was printed as 019000810403, but survey little now says "
                              "019000800402: print it again"});
  CHECK(moved.tags[0].finding.rule == "stale");
  CHECK(moved.tags[0].finding.message ==
        "001L 019000810403 is what was printed, but no longer in the survey");
  const VerifiedFile removed = verified("009L.pdf", "019009000403");
  CHECK(removed.findings ==
        std::vector<std::string>{
            "stale: 009L was printed, but survey little has no such tag: remove the file"});
}

}  // namespace tagsmith::detail
