// SPDX-License-Identifier: Apache-2.0
// Photos that were not taken together, or by another camera than stated, give no position.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/localize/altered_pictures.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/repeated_pictures.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/localize/site.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::error_of;
using tagsmith::detail::test::observation_at;
using tagsmith::detail::test::pose_at;
using tagsmith::detail::test::Site;
using tagsmith::detail::test::site_named;

namespace {

std::vector<SeenTag> tags_of(const Observation& observation, const std::string& camera) {
  std::vector<SeenTag> tags;
  std::ranges::copy_if(observation.tags, std::back_inserter(tags),
                       [&](const SeenTag& seen) { return seen.camera == camera; });
  return tags;
}

// The left camera's tags from one place and the right one's from another.
Observation mixed(const Site& site, double left, double right) {
  Observation observation;
  for (const auto& [camera, chainage] : {std::pair("left", left), std::pair("right", right)}) {
    const Observation there = observation_at(site, pose_at(site, chainage, 0.1));
    for (SeenTag& seen : tags_of(there, camera)) observation.tags.push_back(std::move(seen));
  }
  return observation;
}

bool shows_both(const Observation& observation) {
  return !tags_of(observation, "left").empty() && !tags_of(observation, "right").empty();
}

GrayImage picture_of(std::uint8_t seed) {
  GrayImage image{8, 6, std::vector<std::uint8_t>(48, 100)};
  image.samples[17] = seed;
  return image;
}

}  // namespace

TEST_CASE("photos of two places give no position, however many tags one of them shows") {
  int pairs = 0, with_several = 0;
  for (const std::string name : {"corridor", "curved"}) {
    CAPTURE(name);
    const Site site = site_named(name);
    for (double left = 0; left < 6; left += 0.7) {
      for (double right = 0; right < 6; right += 0.5) {
        if (std::abs(left - right) < 0.3) continue;
        const Observation observation = mixed(site, left, right);
        if (!shows_both(observation)) continue;
        CAPTURE(left);
        CAPTURE(right);
        CHECK_FALSE(localize_jointly(observation, {site.survey}, site.rig).position_in_grid);
        ++pairs;
        with_several += observation.tags.size() > 2 ? 1 : 0;
      }
    }
  }
  CHECK(pairs > 60);
  CHECK(with_several >= 20);
}

TEST_CASE("two photos that agree outvote a third one") {
  Site site = site_named("corridor");
  site.rig.cameras.push_back(*find_camera(site.rig, "left"));
  site.rig.cameras.back().name = "second";
  site.rig.cameras.back().side = Side::left;
  int located = 0;
  for (double chainage = 0; chainage < 5; chainage += 0.5) {
    Observation observation = mixed(site, chainage, chainage + 1.3);
    const std::vector<SeenTag> left = tags_of(observation, "left");
    // Plates have their votes too.
    if (left.size() <= tags_of(observation, "right").size()) continue;
    for (SeenTag seen : left) {
      seen.camera = "second";
      observation.tags.push_back(std::move(seen));
    }
    const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
    CHECK(error_of(fix, site, pose_at(site, chainage, 0.1)) < 1e-3);
    ++located;
  }
  CHECK(located > 0);
}

TEST_CASE("pictures that an earlier measurement had are left out while the vehicle drives") {
  RigCamera left, right;
  left.name = "left";
  right.name = "right";
  const GrayImage first = picture_of(1), second = picture_of(2), third = picture_of(3);
  PictureMemory memory;
  Observation one, two, three, timeless;
  one.time = 1;
  two.time = 2;
  three.time = 3;
  const std::vector<CameraImage> at_first{{&left, first.view(), "a"}, {&right, second.view(), "b"}};
  CHECK(memory.new_ones(at_first, one).size() == 2);
  CHECK(memory.new_ones(at_first, one).size() == 2);  // the same measurement once more
  CHECK(one.faults.empty());
  CHECK(memory.new_ones(at_first, timeless).size() == 2);
  const std::vector<CameraImage> later{{&left, first.view(), "c"}, {&right, third.view(), "d"}};
  const auto kept = memory.new_ones(later, two);
  REQUIRE(kept.size() == 1);
  CHECK(kept.front().name == "d");
  REQUIRE(two.faults.size() == 1);
  CHECK(two.faults.front().starts_with("c: not used"));
  // A picture of the other camera.
  CHECK(memory.new_ones(std::vector<CameraImage>{{&right, first.view(), "e"}}, three).empty());
}

TEST_CASE("a camera that hangs is not believed again while others deliver thousands of pictures") {
  RigCamera left, right;
  const GrayImage stuck = picture_of(1);
  PictureMemory memory;
  GrayImage live = picture_of(2);
  std::size_t left_out = 0;
  for (int row = 0; row < 10'000; ++row) {
    live.samples[0] = static_cast<std::uint8_t>(row % 256);
    live.samples[1] = static_cast<std::uint8_t>(row / 256);
    Observation observation;
    observation.time = row;
    left_out += 2 - memory
                        .new_ones(std::vector<CameraImage>{{&left, stuck.view(), "stuck"},
                                                           {&right, live.view(), "live"}},
                                  observation)
                        .size();
  }
  CHECK(left_out == 9'999);
}

TEST_CASE("fingerprints tell pictures apart by a single grey level, and by their size") {
  CHECK(fingerprint(picture_of(1).view()) == fingerprint(picture_of(1).view()));
  CHECK(fingerprint(picture_of(1).view()) != fingerprint(picture_of(2).view()));
  GrayImage turned = picture_of(100);
  std::swap(turned.width, turned.height);
  CHECK(fingerprint(turned.view()) != fingerprint(picture_of(100).view()));
}

TEST_CASE("of rows of several times that share a picture none is located by it") {
  const Site site = site_named("corridor");
  std::vector<Observation> rows;
  for (const double chainage : {2.0, 3.0, 4.0}) {
    rows.push_back(observation_at(site, pose_at(site, chainage, 0.1)));
    rows.back().id = std::to_string(rows.size());
    rows.back().time = static_cast<double>(rows.size());
    rows.back().pictures = {{"left", rows.size()}, {"right", 10 + rows.size()}};
  }
  rows[2].pictures["left"] = rows[0].pictures["left"];
  leave_out_repeated(rows);
  CHECK(tags_of(rows[0], "left").empty());
  CHECK(tags_of(rows[2], "left").empty());
  CHECK_FALSE(tags_of(rows[0], "right").empty());
  CHECK_FALSE(tags_of(rows[1], "left").empty());
  REQUIRE(rows[2].faults.size() == 1);
  CHECK(rows[2].faults.front() ==
        "the picture of camera left is not used: camera left has the same one in row 1");
  std::vector<Observation> of_one_time(2, rows[1]);
  leave_out_repeated(of_one_time);
  CHECK_FALSE(tags_of(of_one_time[1], "left").empty());
  CHECK(notes_on_repeated(of_one_time)[1].starts_with("camera left has the same picture as row 2"));
  CHECK(notes_on_repeated({rows[1]})[0].empty());
}

TEST_CASE("exchanged photos of two cameras are told, and locate nothing") {
  const Site site = site_named("corridor");
  std::vector<Observation> right, wrong;
  for (double chainage = 1; chainage < 5; chainage += 0.5) {
    const Observation row = observation_at(site, pose_at(site, chainage, 0.1));
    right.push_back(row);
    wrong.push_back(row);
    for (SeenTag& seen : wrong.back().tags) {
      seen.camera = seen.camera == "left" ? "right" : "left";
    }
  }
  CHECK(leave_out_altered(right, {site.survey}, site.rig).empty());
  CHECK_FALSE(right.front().tags.empty());
  CHECK(leave_out_altered(wrong, {site.survey}, site.rig).find("left and right are exchanged") !=
        std::string::npos);
  for (const Observation& row : wrong) {
    const Fix fix = localize_jointly(row, {site.survey}, site.rig);
    CHECK_FALSE(fix.position_in_grid);
    CHECK(fix.reason.find("exchanged") != std::string::npos);
  }
}

TEST_CASE("mirrored and turned photos are told by what was done to them, and locate nothing") {
  const Site site = site_named("corridor");
  const Camera& camera = site.rig.cameras.front().camera;
  // What a reader says of the corners of a picture whose columns or rows are reversed.
  const auto reversed = [&](FrameCorners corners, bool across, bool down) {
    for (PixelPoint& corner : corners) {
      if (across) corner.x = camera.width - 1 - corner.x;
      if (down) corner.y = camera.height - 1 - corner.y;
    }
    if (across != down) std::ranges::reverse(corners);
    return corners;
  };
  struct Case {
    bool across, down;
    std::set<std::string> cameras;
    std::string words;
  };
  const std::vector<Case> cases{
      {true, true, {"left", "right"}, "all photos are turned by 180 degrees"},
      {true, false, {"left", "right"}, "all photos are mirrored left to right"},
      {true, false, {"right"}, "the photos of camera right are mirrored left to right"},
      {false, true, {"left"}, "the photos of camera left are mirrored top to bottom"},
      {true, true, {"left"}, "the photos of camera left are turned by 180 degrees"}};
  for (const Case& made : cases) {
    CAPTURE(made.words);
    std::vector<Observation> rows;
    for (double chainage = 1; chainage < 5; chainage += 0.5) {
      rows.push_back(observation_at(site, pose_at(site, chainage, 0.1)));
      for (SeenTag& seen : rows.back().tags) {
        if (!made.cameras.contains(seen.camera)) continue;
        seen.seen_corners->corners = reversed(seen.seen_corners->corners, made.across, made.down);
      }
    }
    const std::string told = leave_out_altered(rows, {site.survey}, site.rig);
    CHECK_MESSAGE(told.starts_with(made.words), made.words, ": ", told);
    for (const Observation& row : rows) {
      for (const std::string& altered : made.cameras) CHECK(tags_of(row, altered).empty());
    }
  }
}

TEST_CASE("a camera that stands elsewhere than the rig says gives no position in a single row") {
  Site site = site_named("corridor");
  for (RigCamera& camera : site.rig.cameras) {
    camera.calibration_sigma = {0.005, radians(0.5), 0.002, 2};
  }
  for (PlacedTag& tag : site.survey.tags) tag.sigma = 0.003;
  site.survey.angle_sigma = radians(0.3);
  const Site stated = site;
  int located = 0;
  int told = 0;
  for (const double forward : {0.0, 0.04}) {
    site.rig.cameras[0].vehicle_from_camera.translation.x() += forward;
    for (const double chainage : {2.0, 2.5}) {
      const Fix fix = localize_jointly(observation_at(site, pose_at(site, chainage, 0.1)),
                                       {stated.survey}, stated.rig);
      if (fix.position_in_grid) {
        CHECK(forward == 0);
        ++located;
      } else {
        const bool names = fix.reason.find(" of camera ") != std::string::npos;
        CHECK_MESSAGE(names, fix.reason);
        told += names ? 1 : 0;
      }
    }
  }
  CHECK(located == 2);
  CHECK(told == 2);
}

TEST_CASE("a camera that looks elsewhere is not taken for another one") {
  Site site = site_named("corridor");
  std::vector<Observation> rows;
  for (double chainage = 1; chainage < 5; chainage += 0.5) {
    rows.push_back(observation_at(site, pose_at(site, chainage, 0.1)));
  }
  site.rig.cameras[0].vehicle_from_camera.rotation =
      Eigen::AngleAxisd(radians(8), Eigen::Vector3d::UnitZ()) *
      site.rig.cameras[0].vehicle_from_camera.rotation;
  CHECK(leave_out_altered(rows, {site.survey}, site.rig).empty());
  CHECK_FALSE(rows.front().tags.empty());
}
