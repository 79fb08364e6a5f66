// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/set_aside.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/plates/live_drive.hpp"
#include "tests/calibrate/seen_drive.hpp"

namespace tagsmith::detail {
namespace {

// The corridor, whose cameras see more than a pair here.
test::Site wide_site() {
  test::Site site = test::site_named("corridor");
  for (RigCamera& camera : site.rig.cameras) camera.camera.fx = camera.camera.fy = 800;
  return site;
}

// What each measurement shows of the plates where they hang, as tags of the survey.
std::vector<Observation> drive_past_hung(const test::Site& surveyed, const test::Site& hung) {
  test::Draws draws(11);
  const auto vehicles = test::drive_past(hung, 24, draws);
  std::vector<Observation> rows = test::seen_from(hung, vehicles, draws);
  for (Observation& row : rows) {
    for (SeenTag& seen : row.tags) seen.tag = *find_tag(surveyed.survey, seen.tag.name);
  }
  return rows;
}

struct Lived {
  std::vector<std::string> aside;  // the notes of each tag that was set aside
  std::vector<Fix> fixes;
  std::size_t last_aside = 0;  // the fix with the last of these notes
};

// Measurement by measurement.
Lived live(const std::vector<Observation>& rows, const test::Site& site) {
  LiveDrive drive({site.survey}, site.rig);
  Lived lived;
  for (const Observation& row : rows) {
    const auto localize = [&](const std::vector<Survey>& surveys, const auto&, Observation& seen) {
      seen = row;
      std::erase_if(seen.tags, [&](const SeenTag& tag) {
        return find_tag(surveys.front(), std::string_view(tag.tag.name)) == nullptr;
      });
      return localize_jointly(seen, surveys, site.rig);
    };
    lived.fixes.push_back(drive.next(localize, std::nullopt));
    for (const std::string& note : drive.set_aside_notes()) {
      lived.aside.push_back(note);
      lived.last_aside = lived.fixes.size() - 1;
    }
  }
  return lived;
}

TEST_CASE("a drive sets a plate aside once it is certain of it, and by it no position is wrong") {
  const test::Site site = wide_site();
  test::Site hung = site;
  PlacedTag& moved = hung.survey.tags[hung.survey.tags.size() / 2];
  moved.world_from_plate.translation.y() += 0.15;
  const Lived lived = live(drive_past_hung(site, hung), site);
  REQUIRE(lived.aside.size() == 1);
  CHECK(lived.aside[0].starts_with("set aside from here on: " + moved.name + " hangs "));
  // From the measurement that tells of it on, this one included, nothing is dropped any more.
  for (std::size_t i = lived.last_aside; i < lived.fixes.size(); ++i) {
    CAPTURE(i);
    CHECK(lived.fixes[i].dropped.empty());
    CHECK(std::ranges::find(lived.fixes[i].tags, moved.name) == lived.fixes[i].tags.end());
  }
}

TEST_CASE("a plate that only tags of another survey contradict is set aside, too") {
  const test::Site site = wide_site();
  test::Site hung = site;
  PlacedTag& moved = hung.survey.tags[hung.survey.tags.size() / 2];
  moved.world_from_plate.translation.y() += 0.15;
  std::vector<Survey> surveys{site.survey, site.survey};
  surveys[0].name = "near";
  surveys[1].name = "far";
  const auto is_moved = [&](const PlacedTag& tag) { return tag.name == moved.name; };
  std::erase_if(surveys[0].tags, is_moved);
  std::erase_if(surveys[1].tags, [&](const PlacedTag& tag) { return !is_moved(tag); });
  for (const bool hangs_right : {false, true}) {
    std::vector<Observation> rows = drive_past_hung(site, hangs_right ? site : hung);
    for (Observation& row : rows) {
      for (SeenTag& seen : row.tags) seen.survey = is_moved(seen.tag) ? 1 : 0;
    }
    const RunCheck check = set_aside_misplaced(rows, surveys, site.rig);
    CHECK(check.aside.size() == (hangs_right ? 0 : 1));
    for (const SetAside& aside : check.aside) {
      CHECK(aside.survey == 1);
      CHECK(aside.tag == moved.name);
      CHECK(aside.rule == "moved");
      CHECK_FALSE(aside.rows.empty());
    }
    for (const Observation& row : rows) {
      for (const SeenTag& seen : row.tags) CHECK((hangs_right || !is_moved(seen.tag)));
    }
  }
}

TEST_CASE("a drive whose plates hang anywhere but as surveyed contradicts its survey") {
  const test::Site site = wide_site();
  test::Site hung = site;
  test::Draws draws(3);
  for (PlacedTag& tag : hung.survey.tags) tag.world_from_plate.translation += draws.normals(0.05);
  std::vector<Observation> rows = drive_past_hung(site, hung);
  const RunCheck check = set_aside_misplaced(rows, {site.survey}, site.rig);
  CHECK_FALSE(check.suspicion);
  CHECK(check.contradicted.find("survey corridor") != std::string::npos);
  CHECK(doubt_in_words(check, site.rig) == check.contradicted);
  rows = drive_past_hung(site, site);
  CHECK(set_aside_misplaced(rows, {site.survey}, site.rig).contradicted.empty());
}

TEST_CASE("a drive past plates that hang as surveyed sets none aside") {
  const test::Site site = wide_site();
  const Lived lived = live(drive_past_hung(site, site), site);
  CHECK(lived.aside.empty());
  CHECK(std::ranges::all_of(lived.fixes, [](const Fix& fix) { return !!fix.position_in_grid; }));
}

// The corridor by its left camera alone, whose focal length is stated to half a per mille.
test::Site one_eyed_site() {
  test::Site site = test::site_named("corridor");
  site.rig.cameras.resize(1);
  site.rig.cameras[0].calibration_sigma = {0.003, radians(0.1), 5e-4, 0.3, 0.02};
  return site;
}

test::Site with_focal_length(test::Site site, double factor) {
  site.rig.cameras[0].camera.fx *= factor;
  site.rig.cameras[0].camera.fy *= factor;
  return site;
}

std::ptrdiff_t count_doubted(const Lived& lived) {
  return std::ranges::count_if(lived.fixes, [](const Fix& fix) { return !fix.doubt.empty(); });
}

TEST_CASE("a wrong focal length is named early where no measurement contradicts itself") {
  const test::Site site = one_eyed_site();
  for (const double factor : {0.99, 1.0, 1.01}) {
    CAPTURE(factor);
    const test::Site stated = with_focal_length(site, factor);
    std::vector<Observation> rows = drive_past_hung(site, site);
    std::erase_if(rows, [&](Observation row) {
      const Fix fix = localize_jointly(row, {stated.survey}, stated.rig);
      return !fix.position_in_grid || !fix.dropped.empty();
    });
    REQUIRE(rows.size() > 15);
    const Lived lived = live(rows, stated);
    if (factor == 1) {
      CHECK(count_doubted(lived) == 0);
      continue;
    }
    for (std::size_t i = 5; i < lived.fixes.size(); ++i) {
      CAPTURE(i);
      CHECK(lived.fixes[i].doubt.find("left: a focal length of 16") != std::string::npos);
      CHECK(lived.fixes[i].confirmations == 0);
    }
  }
}

TEST_CASE("pictures of a vehicle that stands still are no evidence against its rig") {
  const test::Site site = one_eyed_site();
  const std::vector<Observation> rows = drive_past_hung(site, site);
  const auto two = std::ranges::find_if(rows, [](const auto& row) { return row.tags.size() > 1; });
  REQUIRE(two != rows.end());
  const std::vector<Observation> still(40, *two);
  CHECK(count_doubted(live(still, with_focal_length(site, 1.006))) == 0);
}

TEST_CASE("two plates alone in sight that hang alike locate nothing once other rows tell of them") {
  // Both of a pair 12 cm on, as from a wrong mark: by themselves they confirm each other.
  const test::Site site = wide_site();
  test::Site hung = site;
  const std::size_t middle = hung.survey.tags.size() / 2 / 2 * 2;
  for (const std::size_t i : {middle, middle + 1}) {
    hung.survey.tags[i].world_from_plate.translation.y() += 0.12;
  }
  std::vector<Observation> rows = drive_past_hung(site, hung);
  Observation alone = rows[rows.size() / 2];
  std::erase_if(alone.tags, [&](const SeenTag& seen) {
    return seen.tag.name != site.survey.tags[middle].name &&
           seen.tag.name != site.survey.tags[middle + 1].name;
  });
  REQUIRE(alone.tags.size() == 2);
  CHECK(localize_jointly(alone, {site.survey}, site.rig).position_in_grid);
  rows.push_back(alone);
  const Lived lived = live(rows, site);
  CHECK(lived.aside.size() == 2);
  CHECK_FALSE(lived.fixes.back().position_in_grid);
}

}  // namespace
}  // namespace tagsmith::detail
