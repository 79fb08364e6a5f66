// SPDX-License-Identifier: Apache-2.0
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/ledger/plate_history.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tests/ledger/ledger_file.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail {
namespace {

const Day kLast = parse_day("2026-03-31").value();

// A photo of the left wall on the nth day of March, of all plates but some.
VerifiedFile photo_of_wall(const Survey& survey, int day, const std::vector<std::string>& without) {
  VerifiedFile file = test::numbered_photo(day);
  file.taken = fmt::format("2026-03-{:02}T08:00:00", day);
  file.tags.clear();
  for (const PlacedTag& tag : survey.tags) {
    if (tag.side != Side::left || std::ranges::count(without, tag.name) > 0) continue;
    VerifiedTag& seen = file.tags.emplace_back();
    seen.tag = tag.name;
    seen.digits = tag.digits;
    seen.module_px = 3;
  }
  return file;
}

// As measured at 6 pixels a module.
void grade(GradeParameter parameter, double value, VerifiedTag& tag) {
  tag.module_px = 6;
  tag.grade = SymbolGrade{3, parameter, false};
  tag.grade->means[static_cast<std::size_t>(parameter)] = {3, value};
}

std::vector<std::string> gone_after(int last_day, int day, const std::vector<std::string>& gone) {
  return day > last_day ? gone : std::vector<std::string>{};
}

// The corridor with this many plates on its left wall and none on the right one.
Survey long_wall(std::size_t plates) {
  Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const PlacedTag first = survey.tags.front();
  survey.tags.assign(plates, first);
  for (std::size_t i = 0; i < plates; ++i) {
    survey.tags[i].name = fmt::format("{:03}L", i);
    survey.tags[i].digits = parse_digits(fmt::format("0190{:08}", i)).value();
    survey.tags[i].chainage += static_cast<double>(i);
  }
  return survey;
}

// How far to the right the days of each plate are drawn on a page.
std::vector<std::vector<double>> places_of_days(const std::string& page) {
  const std::regex line("class=\"line\" d=\"([^\"]*)\""), point("[ML]([-a-z0-9.]+) [-0-9.]+");
  std::vector<std::vector<double>> plates;
  for (std::sregex_iterator at(page.begin(), page.end(), line), end; at != end; ++at) {
    const std::string points = (*at)[1];
    std::vector<double>& places = plates.emplace_back();
    for (std::sregex_iterator day(points.begin(), points.end(), point); day != end; ++day) {
      places.push_back(std::stod((*day)[1]));
    }
  }
  return plates;
}

}  // namespace

TEST_CASE("a plate that is no longer seen while its neighbours are is to be looked for") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  std::vector<VerifiedFile> photos;
  for (int day = 1; day <= 5; ++day) {
    photos.push_back(photo_of_wall(survey, day, gone_after(3, day, {"003L"})));
    if (day == 4) {
      REQUIRE(ledger.enter(survey.name, photos));
      // One day may be somebody who stood before it.
      CHECK(plates_to(PlateAction::look, survey, make_ledger_report(survey, ledger, kLast).value())
                .empty());
    }
  }
  REQUIRE(ledger.enter(survey.name, photos));
  const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
  CHECK(plates_to(PlateAction::look, survey, report) == std::vector<std::string>{"003L"});
  CHECK(report.plates.front().tag == "003L");
  CHECK(report.plates.size() == survey.tags.size());
  CHECK(plates_to(PlateAction::unseen, survey, report).size() == 8);  // the right wall
  CHECK(report.photos.photos == 5);
}

TEST_CASE("plates beside each other that vanish together are to be looked for") {
  for (const std::size_t gone : {2U, 10U, 11U}) {
    CAPTURE(gone);
    const Survey survey = long_wall(gone + 2);
    std::vector<std::string> stretch;
    for (std::size_t i = 1; i <= gone; ++i) stretch.push_back(survey.tags[i].name);
    const test::TemporaryFolder folder;
    Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
    for (int day = 1; day <= 5; ++day) {
      const VerifiedFile photo = photo_of_wall(survey, day, gone_after(2, day, stretch));
      REQUIRE(ledger.enter(survey.name, std::array{photo}));
    }
    const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
    // Of more in a row there may be no photos on these days.
    if (gone > 10) stretch.clear();
    CHECK(plates_to(PlateAction::look, survey, report) == stretch);
    if (!stretch.empty()) {
      CHECK(report.plates.front().reason ==
            "not seen since 2026-03-02; plates on both sides were, on 3 days");
    }
  }
}

TEST_CASE("when most plates lose quality at once the camera is blamed, not when few do") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  for (const GradeParameter fails : {GradeParameter::modulation, GradeParameter::decodability}) {
    for (const std::size_t falling : {3U, 4U, 5U, 8U}) {
      CAPTURE(falling);
      const test::TemporaryFolder folder;
      Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
      for (int day = 1; day <= 4; ++day) {
        VerifiedFile photo = photo_of_wall(survey, day, {});
        for (std::size_t i = 0; i < photo.tags.size(); ++i) {
          grade(fails, i < falling ? 0.8 - 0.06 * day : 0.8, photo.tags[i]);
        }
        REQUIRE(ledger.enter(survey.name, std::array{photo}));
      }
      const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
      CHECK(report.trends == 8);
      CHECK(report.falling == falling);
      CHECK(report.losing_light == (fails == GradeParameter::modulation ? falling : 0));
      CHECK(report.blames_camera() == (falling > 4));
      CHECK(plates_to(PlateAction::plan, survey, report).size() == falling);
      const PlateState& first = report.plates.front();
      CHECK((first.cure == PlateAction::look) == report.blames_camera());
    }
  }
}

TEST_CASE("of plates that fail with most others only those that stand out are printed anew") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  for (int day = 1; day <= 4; ++day) {
    VerifiedFile photo = photo_of_wall(survey, day, {});
    for (VerifiedTag& tag : photo.tags) {
      const double worn = tag.tag == "002L" ? 0.13 : 0;
      grade(GradeParameter::decodability, 0.6 - 0.1 * day - worn, tag);
    }
    REQUIRE(ledger.enter(survey.name, std::array{photo}));
  }
  const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
  CHECK(report.blames_camera());
  CHECK(plates_to(PlateAction::reprint, survey, report) == std::vector<std::string>{"002L"});
  CHECK(plates_to(PlateAction::look, survey, report).size() == 7);
}

TEST_CASE("the page draws the days as far apart as they are") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  const std::string database = (folder.path() / "a.db").string();
  const std::string page = (folder.path() / "page.html").string();
  {
    Ledger ledger = Ledger::open_to_write(database).value();
    for (const int day : {1, 6, 21}) {
      VerifiedFile photo = photo_of_wall(survey, day, {});
      for (VerifiedTag& tag : photo.tags) {
        tag.module_px = 6;
        tag.grade = SymbolGrade{3, GradeParameter::modulation, false};
      }
      REQUIRE(ledger.enter(survey.name, std::array{photo}));
    }
  }
  const std::string command =
      "report surveys/corridor/survey.yaml --ledger " + database + " --html " + page;
  CHECK(test::run_tagsmith(command).exit_code == 0);
  const auto plates = places_of_days(test::contents(page));
  REQUIRE(plates.size() == 8);
  // From the left margin of 4 in a picture 132 wide to the right one; a quarter of the time is 31.
  for (const std::vector<double>& places : plates) {
    CHECK(places == std::vector<double>{4, 35, 128});
  }
}

TEST_CASE("the page says how many photos have no date, if any") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  const std::string database = (folder.path() / "a.db").string();
  const std::string page = (folder.path() / "page.html").string();
  const std::regex undated("class=\"known\">([0-9]+) of them without");
  for (const int count : {0, 2}) {
    CAPTURE(count);
    {
      Ledger ledger = Ledger::open_to_write(database).value();
      REQUIRE(ledger.enter(survey.name, std::array{photo_of_wall(survey, 1, {})}));
      for (int i = 0; i < count; ++i) {
        VerifiedFile photo = photo_of_wall(survey, 2 + i, {});
        photo.taken.clear();
        REQUIRE(ledger.enter(survey.name, std::array{photo}));
      }
    }
    test::run_tagsmith("report surveys/corridor/survey.yaml --ledger " + database + " --html " +
                       page);
    const std::string shown = test::contents(page);
    std::smatch told;
    REQUIRE(std::regex_search(shown, told, undated) == (count > 0));
    if (count > 0) CHECK(std::stoi(told[1]) == count);
  }
}

TEST_CASE("photos of a camera whose clock is ahead do not say what day it is") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  for (const int day : {1, 6, 31}) {
    REQUIRE(ledger.enter(survey.name, std::array{photo_of_wall(survey, day, {})}));
  }
  const auto report_until = [&](const char* last) {
    return make_ledger_report(survey, ledger, parse_day(last).value()).value();
  };
  const LedgerReport report = report_until("2026-03-30");
  CHECK(report.oldest == parse_day("2026-03-01"));
  CHECK(report.newest == parse_day("2026-03-06"));
  CHECK(report.photos.future == 1);
  CHECK(report.photos.undated == 0);
  CHECK(report_until("2026-03-31").newest == parse_day("2026-03-31"));
  CHECK(report_until("2026-03-31").photos.future == 0);
  CHECK_FALSE(report_until("2026-02-28").newest);
}

TEST_CASE("nothing is missing where the drive had ended") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  for (int day = 1; day <= 5; ++day) {
    VerifiedFile photo = photo_of_wall(survey, day, {"000L"});
    photo.tags.resize(4);
    REQUIRE(ledger.enter(survey.name, std::array{photo}));
  }
  const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
  CHECK(plates_to(PlateAction::look, survey, report).empty());
  CHECK(plates_to(PlateAction::unseen, survey, report).size() == 12);
}

TEST_CASE("a plate that few photos read counts as unread where the plates beside it were read") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  for (int photo = 0; photo < 8; ++photo) {
    VerifiedFile file = photo_of_wall(survey, photo / 4 + 1, {});
    file.sha256 = fmt::format("{:064x}", photo);
    // The last plate in view is unread as often: it may be far away.
    for (const std::size_t i : {2U, 7U}) {
      if (photo % 4 == 0) continue;
      file.tags[i].finding = {TagStatus::unreadable, "undecodable", "worn"};
      file.tags[i].digits.reset();
    }
    REQUIRE(ledger.enter(survey.name, std::array{file}));
  }
  const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
  CHECK(plates_to(PlateAction::look, survey, report) == std::vector<std::string>{"002L"});
  CHECK(report.plates.front().reason.starts_with("unread in 6 of 8 photos since 2026-03-01"));
}

TEST_CASE("plates with the digits that a tag had before it was moved are others") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  VerifiedFile photo = photo_of_wall(survey, 1, {"003L"});
  photo.tags[0].digits = parse_digits("019000800402");
  REQUIRE(ledger.enter(survey.name, std::array{photo}));
  const auto unseen =
      plates_to(PlateAction::unseen, survey, make_ledger_report(survey, ledger, kLast).value());
  CHECK(unseen.size() == 10);
  CHECK(unseen.front() == photo.tags[0].tag);
}

TEST_CASE("two surveys of one name are told by photos that alternate") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  const auto mixed_after = [&](int day, const std::string& revision) {
    VerifiedFile photo = photo_of_wall(survey, day, {});
    photo.revision = revision;
    REQUIRE(ledger.enter(survey.name, std::array{photo}));
    return make_ledger_report(survey, ledger, kLast).value().photos.mixed_revisions;
  };
  CHECK(mixed_after(1, "another") == 0);
  CHECK(mixed_after(2, survey_revision(survey)) == 0);  // the survey was edited
  CHECK(mixed_after(3, "another") == 1);
}

TEST_CASE("a plate is known by its digits, whatever the survey called it") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  VerifiedFile photo = photo_of_wall(survey, 1, {"003L"});
  photo.revision = "another";
  VerifiedTag& seen = photo.tags[0];
  seen.finding.status = TagStatus::misprinted;
  seen.finding.rule = "bent";
  seen.finding.message = "is bent";
  seen.digits = find_tag(survey, std::string_view("002L"))->digits;
  REQUIRE(ledger.enter(survey.name, std::array{photo}));
  const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
  CHECK(plates_to(PlateAction::reprint, survey, report) == std::vector<std::string>{"002L"});
}

TEST_CASE("a plate that was not read keeps its fault when the survey is edited") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  VerifiedFile photo = photo_of_wall(survey, 2, {"003L"});
  photo.revision = "another";
  photo.tags.resize(1);
  VerifiedTag& covered = photo.tags[0];
  covered.finding.status = TagStatus::unreadable;
  covered.finding.rule = "covered";
  covered.digits.reset();
  REQUIRE(ledger.enter(survey.name, std::array{photo}));
  const auto to_clean = [&] {
    return plates_to(PlateAction::clean, survey, make_ledger_report(survey, ledger, kLast).value());
  };
  CHECK(to_clean() == std::vector<std::string>{covered.tag});

  // Another photo shows that in the other state this name was that of 007L.
  VerifiedFile other = photo_of_wall(survey, 1, {"003L"});
  other.revision = "another";
  other.tags[0].digits = find_tag(survey, std::string_view("007L"))->digits;
  REQUIRE(ledger.enter(survey.name, std::array{other}));
  CHECK(to_clean() == std::vector<std::string>{"007L"});
}

TEST_CASE("a plate that was never read is no other plate that has its name now") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const test::TemporaryFolder folder;
  Ledger ledger = Ledger::open_to_write(folder.path() / "a.db").value();
  VerifiedFile photo = photo_of_wall(survey, 1, {"003L"});
  photo.revision = "another";
  photo.tags.resize(2);
  photo.tags[0].finding.status = TagStatus::unreadable;
  photo.tags[0].finding.rule = "covered";
  photo.tags[0].digits.reset();
  photo.tags[1].digits = find_tag(survey, std::string_view("004L"))->digits;  // names have moved
  REQUIRE(ledger.enter(survey.name, std::array{photo}));
  const LedgerReport report = make_ledger_report(survey, ledger, kLast).value();
  CHECK(plates_to(PlateAction::clean, survey, report).empty());
  CHECK(report.nameless == 1);
}

}  // namespace tagsmith::detail
