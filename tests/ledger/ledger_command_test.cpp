// SPDX-License-Identifier: Apache-2.0
// `verify --ledger` and `report --ledger` as they are used, with the shipped photos.
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tests/ledger/ledger_file.hpp"
#include "tests/support/exif_jpeg.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

namespace tagsmith::detail::test {
namespace {

using Json = nlohmann::json;

const std::string kSurvey = "surveys/corridor/survey.yaml ";
const std::string kPhotos = "surveys/corridor/photos";
const std::string kRig = " --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";

// Copies of the left photos of five places, taken on this day.
void copy_photos(const fs::path& folder, const std::string& day) {
  for (int i = 1; i <= 5; ++i) {
    const std::string name = fmt::format("corridor_{:02}_left.jpg", i);
    const std::string photo = read_file(fs::path(kPhotos) / name).value();
    REQUIRE(write_file(folder / (day.substr(8) + name),
                       with_moment(photo, fmt::format("{}:{}:{} 10:00:00", day.substr(0, 4),
                                                      day.substr(5, 2), day.substr(8)))));
  }
}

Json report(const std::string& ledger, int exit_code = 0) {
  const ProgramOutput output = run_tagsmith("report " + kSurvey + " --json --ledger " + ledger);
  CHECK(output.exit_code == exit_code);
  return Json::parse(output.out).at("ledger");
}

}  // namespace

TEST_CASE("photos of several days, verified again and again, are in the ledger once") {
  const TemporaryFolder folder;
  const std::string ledger = (folder.path() / "mine.db").string();
  const std::string page = (folder.path() / "page.html").string();
  for (const char* day : {"2026-03-01", "2026-03-08", "2026-03-15"}) {
    copy_photos(folder.path() / "photos", day);
    const ProgramOutput output = run_tagsmith(
        "verify " + kSurvey + (folder.path() / "photos").string() + " --ledger " + ledger);
    CHECK(output.exit_code == 0);
  }
  const Json said = report(ledger);
  CHECK(said["photos"] == 15);
  CHECK(said["undated"] == 0);
  CHECK(said["newest"] == "2026-03-15");
  CHECK(said["plates"].size() == 16);
  CHECK(said["unseen"].size() >= 8);
  const auto words = run_tagsmith("report " + kSurvey + "--ledger " + ledger + " --html " + page);
  CHECK(words.exit_code == 0);
  CHECK(words.out.find("in no photo with a date: ") != std::string::npos);
  CHECK(read_file(page).value().find("2026-03-15") != std::string::npos);
}

TEST_CASE("a report of another survey's ledger, or of lines that are not there, is an error") {
  const TemporaryFolder folder;
  const fs::path ledger = folder.path() / "mine.db", none = folder.path() / "none.db";
  run_tagsmith("verify " + kSurvey + kPhotos + "/corridor_01_left.jpg --ledger " + ledger.string());
  const ProgramOutput other =
      run_tagsmith("report surveys/curved/survey.yaml --ledger " + ledger.string());
  CHECK(other.exit_code == 2);
  CHECK(other.err.find("has no photos of the survey curved, but of corridor") != std::string::npos);
  const ProgramOutput absent = run_tagsmith(
      "report " + kSurvey + (folder.path() / "no.jsonl").string() + " --ledger " + none.string());
  CHECK(absent.exit_code == 2);
  CHECK_FALSE(fs::exists(none));
  // What nobody may write can be read.
  fs::permissions(ledger, fs::perms::owner_read);
  CHECK(report(ledger.string())["photos"] == 1);
  CHECK(
      run_tagsmith("report " + kSurvey + "--tolerance 20 --ledger " + ledger.string()).exit_code ==
      2);
}

TEST_CASE("lines give the ledger what the verification gave it") {
  const TemporaryFolder folder;
  const fs::path direct = folder.path() / "direct.db", later = folder.path() / "later.db";
  const std::string lines = (folder.path() / "lines.jsonl").string();
  const ProgramOutput verified =
      run_tagsmith("verify --json " + kSurvey + kPhotos + kRig + " --ledger " + direct.string());
  CHECK(verified.err.find("20 of these say no date") != std::string::npos);
  REQUIRE(write_file(lines, verified.out));
  const std::string reports = "report " + kSurvey + lines + " --ledger " + later.string();
  CHECK(run_tagsmith(reports).exit_code == 0);
  CHECK((rows_of(direct) == rows_of(later)));
  CHECK(run_tagsmith(reports).exit_code == 0);
  CHECK((rows_of(direct) == rows_of(later)));
  CHECK(
      query(direct, "SELECT count(*) FROM plate WHERE hanging = 'fits' AND right_mm IS NOT NULL") ==
      "20\n");
  const Json said = report(later.string());
  CHECK(said["photos"] == 20);
  CHECK(said["undated"] == 20);
}

TEST_CASE("verify that is killed at any moment and repeated gives the ledger of one run") {
  const TemporaryFolder folder;
  const auto verify = [&](const std::string& name) {
    return "verify " + kSurvey + kPhotos + " --jobs 1 --ledger " + (folder.path() / name).string();
  };
  REQUIRE(run_tagsmith(verify("alone.db")).exit_code == 0);
  for (const char* seconds : {"0.03", "0.06", "0.1", "0.15"}) {
    const std::string name = std::string(seconds) + ".db";
    run_shell("timeout --foreground -s KILL " + std::string(seconds) + " \"$TAGSMITH_PROGRAM\" " +
              verify(name));
    CHECK(run_tagsmith(verify(name)).exit_code == 0);
    CHECK((rows_of(folder.path() / name) == rows_of(folder.path() / "alone.db")));
  }
}

TEST_CASE("the time of a run dates photos that say none") {
  const TemporaryFolder folder;
  const fs::path ledger = folder.path() / "a.db";
  const std::string photo = fs::absolute(kPhotos + "/corridor_01_left.jpg").string();
  const std::string run = (folder.path() / "run.csv").string();
  for (const auto& [time, taken] :
       {std::pair{"12.5", "\n"}, std::pair{"1774965909", "2026-03-31T14:05:09Z\n"},
        std::pair{"12.5", "2026-03-31T14:05:09Z\n"}}) {
    REQUIRE(write_file(run, "id,left,time\n1," + photo + "," + time + "\n"));
    run_tagsmith("verify " + kSurvey + " --rig surveys/corridor/rig.yaml --run " + run +
                 " --ledger " + ledger.string());
    CHECK(query(ledger, "SELECT taken FROM photo") == taken);
  }
}

TEST_CASE("what a ledger was made to say is shown and does nothing") {
  const TemporaryFolder folder;
  const std::string ledger = (folder.path() / "mine.db").string();
  const fs::path page = folder.path() / "page.html";
  copy_photos(folder.path() / "photos", "2026-03-01");
  run_tagsmith("verify " + kSurvey + (folder.path() / "photos").string() + " --ledger " + ledger);
  query(
      ledger,
      "UPDATE plate SET status = 'misplaced', rule = 'moved', message = '<script>' || char(27, 10) "
      "WHERE tag = '000L'; UPDATE plate SET grade = 9e999, modulation = -9e999, module_px = 9e999 "
      "WHERE tag = '001L'; UPDATE photo SET taken = '9999-12-31' WHERE id = "
      "(SELECT max(photo) FROM plate WHERE photo NOT IN "
      "(SELECT photo FROM plate WHERE tag = '000L')); "
      "CREATE TRIGGER evil AFTER INSERT ON photo BEGIN DELETE FROM plate; END");
  const ProgramOutput output =
      run_tagsmith("report " + kSurvey + "--ledger " + ledger + " --html " + page.string());
  CHECK(output.exit_code == 1);
  CHECK(output.out.find('\x1b') == std::string::npos);
  CHECK(read_file(page).value().find("<script>") == std::string::npos);
  const Json said = report(ledger, 1);
  CHECK(said["rehang"] == Json{"000L"});
  CHECK(said["future"] == 1);
  CHECK(said["newest"] == "2026-03-01");
  const std::string plates = query(ledger, "SELECT count(*) FROM plate");
  copy_photos(folder.path() / "more", "2026-03-08");
  run_tagsmith("verify " + kSurvey + (folder.path() / "more").string() + " --ledger " + ledger);
  CHECK(query(ledger, "SELECT count(*) > " + plates + " FROM plate") == "1\n");
}

TEST_CASE("what is no ledger, or reports nothing, is refused") {
  const TemporaryFolder folder;
  const fs::path text = folder.path() / "notes.txt";
  REQUIRE(write_file(text, "my notes\n"));
  for (const std::string& arguments :
       {"verify " + kSurvey + kPhotos + " --ledger " + text.string(),
        "report " + kSurvey + "--ledger " + text.string(),
        "report " + kSurvey + "--ledger " + (folder.path() / "absent.db").string(),
        "report " + kSurvey + text.string() + " --ledger " + text.string(), "report " + kSurvey}) {
    CAPTURE(arguments);
    const ProgramOutput output = run_tagsmith(arguments);
    CHECK(output.exit_code == 2);
    CHECK(output.out == "");
    CHECK_FALSE(output.err.empty());
  }
  CHECK(read_file(text).value() == "my notes\n");
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
}

}  // namespace tagsmith::detail::test
