// SPDX-License-Identifier: Apache-2.0
// Positions with tags of which the picture's border leaves a part.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/localize/site.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::error_of;
using tagsmith::detail::test::observation_at;
using tagsmith::detail::test::pose_at;
using tagsmith::detail::test::Site;
using tagsmith::detail::test::site_named;

namespace {

// What is seen in the corridor with its last tag taken for a part.
struct Seen {
  Site site = site_named("corridor");
  VehiclePose truth = pose_at(site, 2.0, 0);
  Observation whole = observation_at(site, truth);
  Observation with_part{};

  Seen() {
    REQUIRE(whole.tags.size() >= 2);
    whole.tags = {whole.tags.front(), whole.tags.back()};
    REQUIRE(whole.tags.front().tag.name != whole.tags.back().tag.name);
    with_part = whole;
    const SeenTag& last = with_part.tags.back();
    with_part.parts.push_back({last.camera, {{0, tag(last.tag.name)}}, *last.seen_corners, 0.5});
    with_part.tags.pop_back();
  }

  const PlacedTag* tag(const std::string& name) const { return find_tag(site.survey, name); }

  // Another tag than those seen.
  const PlacedTag* other() const {
    return &*std::ranges::find_if(site.survey.tags, [&](const PlacedTag& placed) {
      return std::ranges::none_of(
          whole.tags, [&](const SeenTag& seen) { return seen.tag.name == placed.name; });
    });
  }
};

}  // namespace

TEST_CASE("a whole tag and a part of another confirm each other") {
  const Seen seen;
  const Fix fix = localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig);
  CHECK(error_of(fix, seen.site, seen.truth) < 1e-4);
  CHECK(fix.confirmations == 1);
  CHECK(fix.tags.size() == 2);
  const std::string note = "only a part of " + seen.whole.tags.back().tag.name;
  CHECK(std::ranges::any_of(fix.notes,
                            [&](const std::string& text) { return text.starts_with(note); }));
}

TEST_CASE("a part of one tag alone gives no position") {
  Seen seen;
  seen.with_part.tags.clear();
  const Fix fix = localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig);
  CHECK_FALSE(fix.position_in_grid);
  CHECK(fix.reason.find("only a part of") != std::string::npos);
  // Nor do the parts that two cameras see of it.
  seen.with_part.parts.push_back(seen.with_part.parts.front());
  CHECK_FALSE(localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig).position_in_grid);
}

TEST_CASE("parts of two tags without a whole one give no position") {
  Seen seen;
  const SeenTag& whole = seen.with_part.tags.front();
  seen.with_part.parts.push_back(
      {whole.camera, {{0, seen.tag(whole.tag.name)}}, *whole.seen_corners, 0.5});
  seen.with_part.tags.clear();
  const Fix fix = localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig);
  CHECK_FALSE(fix.position_in_grid);
  CHECK(fix.tags.size() == 2);
}

TEST_CASE("where a part may be several tags, the one is taken that agrees with the others") {
  Seen seen;
  std::vector<SurveyedTag>& candidates = seen.with_part.parts.front().candidates;
  candidates.insert(candidates.begin(), {0, seen.other()});
  const Fix fix = localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig);
  CHECK(error_of(fix, seen.site, seen.truth) < 1e-4);
  CHECK(fix.tags.size() == 2);
  // Nothing tells which it is where nothing else is seen.
  seen.with_part.tags.clear();
  CHECK_FALSE(localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig).position_in_grid);
}

TEST_CASE("a part that agrees with nothing is left out where it may be several tags") {
  Seen seen;
  const PlacedTag* other = seen.other();
  seen.with_part.parts.front().candidates = {{0, other}, {0, other + 1}};
  const Fix fix = localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig);
  CHECK(error_of(fix, seen.site, seen.truth) < 1e-4);
  CHECK(fix.tags.size() == 1);
}

TEST_CASE("a part that contradicts the only whole tag withholds the position") {
  Seen seen;
  seen.with_part.parts.front().candidates = {{0, seen.other()}};
  CHECK_FALSE(localize_jointly(seen.with_part, {seen.site.survey}, seen.site.rig).position_in_grid);
}

TEST_CASE("a part that shows all bars is its tag, another is a part") {
  const Seen seen;
  const PlacedTag& tag = *seen.tag(seen.whole.tags.back().tag.name);
  ReadResult result;
  PartReading& part = result.parts.emplace_back();
  part.candidates = {{tag.digits}};
  part.in_sight.fill(true);
  part.shows_all_bars = true;
  const auto observed = [&] {
    Observation observation;
    add_result(observation, result, "photo", seen.site.rig.cameras.front(), {seen.site.survey}, {});
    return observation;
  };
  const Observation all = observed();
  REQUIRE(all.tags.size() == 1);
  CHECK(all.tags.front().tag.name == tag.name);
  CHECK_FALSE(all.tags.front().is_part);
  CHECK(all.parts.empty());
  part.shows_all_bars = false;
  CHECK(observed().tags.empty());
  CHECK(observed().parts.size() == 1);
}

TEST_CASE("photos that cut all their tags below locate the vehicle to a millimetre") {
  Site site = site_named("corridor");
  Observation row;
  row.ranges = {{"d", 0.906}};
  for (RigCamera& camera : site.rig.cameras) {
    const std::string name = "surveys/corridor/photos/corridor_01_" + camera.name + ".jpg";
    const auto photo = load_gray_image(name);
    REQUIRE(photo);
    GrayView upper = photo->view();
    upper.height = camera.camera.height = 440;
    observe_image(row, camera, upper, name, {site.survey}, {read_tags});
  }
  CHECK(row.tags.size() == 2);
  const Fix fix = localize_jointly(row, {site.survey}, site.rig);
  REQUIRE(fix.position_in_grid);
  CHECK((*fix.position_in_grid - Eigen::Vector3d(1, -0.5, 0.24)).norm() < 1e-3);
}
