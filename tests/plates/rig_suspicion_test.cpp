// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/rig_suspicion.hpp"

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/plates/plate_trials.hpp"
#include "tests/calibrate/seen_drive.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;
using tagsmith::detail::test::Draws;
using tagsmith::detail::test::drive_past;
using tagsmith::detail::test::exact_corridor;
using tagsmith::detail::test::mount;
using tagsmith::detail::test::seen_from;
using tagsmith::detail::test::Site;

namespace {

// What the true rig sees on its way.
struct Seen {
  Site site;
  std::vector<Observation> rows;
};

Seen corridor_seen(std::uint64_t seed) {
  Draws draws(seed);
  Seen seen{exact_corridor(), {}};
  seen.rows = seen_from(seen.site, drive_past(seen.site, 12, draws), draws);
  return seen;
}

const RigSuspect* suspect_named(const RigSuspicion& suspicion, std::string_view camera) {
  for (const RigSuspect& suspect : suspicion.suspects) {
    if (suspect.camera == camera) return &suspect;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("a wrong alpha is told with the right one") {
  for (const double alpha : {40.0, 36.0, 20.0}) {
    CAPTURE(alpha);
    const Seen seen = corridor_seen(3);
    Rig wrong = seen.site.rig;
    mount(wrong, 0, 90 - alpha, 0, 0, Vector3d::Zero());
    const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
    REQUIRE(suspicion);
    const RigSuspect* left = suspect_named(*suspicion, "left");
    REQUIRE(left != nullptr);
    CHECK(left->parameter == RigParameter::yaw);
    CHECK(std::abs(left->expected - radians(55)) < radians(0.1));
    CHECK(left->sigma < radians(0.1));
    CHECK(left->rows_explained == suspicion->rows);
    CHECK(describe(*suspicion, wrong).find("left: alpha 3") != std::string::npos);
  }
}

TEST_CASE("where one of two cameras is turned, both explain it and both are named") {
  const Seen seen = corridor_seen(5);
  Rig wrong = seen.site.rig;
  mount(wrong, 0, 50, 0, 0, Vector3d::Zero());
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
  REQUIRE(suspicion);
  CHECK(suspect_named(*suspicion, "left") != nullptr);
  CHECK(suspect_named(*suspicion, "right") != nullptr);
}

TEST_CASE("a wrong focal length is told with the right one") {
  const Seen seen = corridor_seen(7);
  Rig wrong = seen.site.rig;
  wrong.cameras[1].camera.fx *= 5.5 / 6;
  wrong.cameras[1].camera.fy *= 5.5 / 6;
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
  REQUIRE(suspicion);
  REQUIRE(suspicion->suspects.size() == 1);
  CHECK(suspicion->suspects[0].camera == "right");
  CHECK(suspicion->suspects[0].parameter == RigParameter::focal);
  CHECK(std::abs(suspicion->suspects[0].expected - 6 / 5.5) < 0.002);
}

TEST_CASE("focal lengths that are all wrong are told by their factor") {
  for (const double factor : {0.97, 1.03, 1.2}) {
    CAPTURE(factor);
    const Seen seen = corridor_seen(8);
    Rig wrong = seen.site.rig;
    for (RigCamera& camera : wrong.cameras) {
      camera.camera.fx /= factor;
      camera.camera.fy /= factor;
    }
    const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
    REQUIRE(suspicion);
    const RigSuspect* all = suspect_named(*suspicion, "");
    REQUIRE(all != nullptr);
    CHECK(all->parameter == RigParameter::focal);
    CHECK(std::abs(all->expected - factor) < 0.002);
    CHECK(all->sigma < 0.002);
    CHECK(describe(*suspicion, wrong).starts_with("focal lengths of all cameras"));
  }
}

TEST_CASE("lenses that bend straight lines are told with the coefficient") {
  for (const double k1 : {-0.3, -0.1, -0.03, 0.1}) {
    CAPTURE(k1);
    Seen seen{exact_corridor(), {}};
    for (RigCamera& camera : seen.site.rig.cameras) camera.camera.distortion[0] = k1;
    Draws draws(29);
    seen.rows = seen_from(seen.site, drive_past(seen.site, 12, draws), draws);
    const Rig straight = exact_corridor().rig;
    const auto suspicion = suspect_rig(seen.rows, seen.site.survey, straight);
    REQUIRE(suspicion);
    const RigSuspect* all = suspect_named(*suspicion, "");
    REQUIRE(all != nullptr);
    CHECK(all->parameter == RigParameter::distortion);
    CHECK(all->stated == 0);
    CHECK(std::abs(all->expected - k1) < 4 * all->sigma + 0.002);
    CHECK(all->sigma < 0.01);
    CHECK(describe(*suspicion, straight).starts_with("the lenses of all cameras: "));
  }
  Seen seen{exact_corridor(), {}};
  seen.site.rig.cameras[0].camera.distortion[0] = -0.1;
  Draws draws(31);
  seen.rows = seen_from(seen.site, drive_past(seen.site, 12, draws), draws);
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, exact_corridor().rig);
  REQUIRE(suspicion);
  const RigSuspect* left = suspect_named(*suspicion, seen.site.rig.cameras[0].name);
  REQUIRE(left != nullptr);
  CHECK(left->parameter == RigParameter::distortion);
}

TEST_CASE("plates of another size than their template are told by their factor") {
  for (const double factor : {2.0 / 3, 0.96, 1.01, 1.25, 1.5}) {
    CAPTURE(factor);
    Seen seen = corridor_seen(8);
    seen.site.survey.tag_template.frame_inner_length /= factor;
    seen.site.survey.tag_template.frame_inner_height /= factor;
    const auto suspicion = suspect_rig(seen.rows, seen.site.survey, seen.site.rig);
    REQUIRE(suspicion);
    const RigSuspect* plates = suspect_named(*suspicion, "");
    REQUIRE(plates != nullptr);
    CHECK(plates->parameter == RigParameter::plate_size);
    CHECK(std::abs(plates->expected - factor) < 4 * plates->sigma);
    CHECK(plates->sigma < 0.001);
    CHECK(describe(*suspicion, seen.site.rig).starts_with("plates "));
  }
}

TEST_CASE("plates that are all turned alike are told with the angle") {
  struct Turned {
    RigParameter parameter;
    double degrees;
    const char* words;
  };
  const Turned turns[] = {
      {RigParameter::plate_slope, 2, "plates of both walls that rise along the drive by 2.0"},
      {RigParameter::plate_slope, -1, "plates of both walls that fall along the drive by 1.0"},
      {RigParameter::plate_tilt, -2, "plates of both walls that lean back by 2.0"},
      {RigParameter::left_plate_tilt, -4, "plates of the left wall that lean back by 4.0"},
      {RigParameter::right_plate_tilt, 1, "plates of the right wall that lean forward by 1.0"}};
  for (const Turned& turned : turns) {
    CAPTURE(std::string(turned.words));
    Seen seen{exact_corridor(), {}};
    const Survey stated = seen.site.survey;
    seen.site.survey = with_turned_plates(stated, turned.parameter, radians(turned.degrees));
    Draws draws(21);
    seen.rows = seen_from(seen.site, drive_past(seen.site, 12, draws), draws);
    CHECK_FALSE(suspect_rig(seen.rows, seen.site.survey, seen.site.rig));
    for (Observation& row : seen.rows) {
      for (SeenTag& tag : row.tags) tag.tag = *find_tag(stated, tag.tag.name);
    }
    const auto suspicion = suspect_rig(seen.rows, stated, seen.site.rig);
    REQUIRE(suspicion);
    REQUIRE(suspicion->suspects.size() == 1);
    const RigSuspect& plates = suspicion->suspects[0];
    CHECK(is_of_attitudes(plates));
    CHECK(plates.parameter == turned.parameter);
    CHECK(std::abs(plates.expected - radians(turned.degrees)) < 4 * plates.sigma);
    CHECK(plates.sigma < radians(0.2));
    CHECK(doubt_in_words(*suspicion, seen.site.rig).starts_with("the plates are in doubt: "));
    CHECK(describe(*suspicion, seen.site.rig).starts_with(turned.words));
  }
}

TEST_CASE("plates that were surveyed at another point than P are told with the point") {
  const Survey hung = exact_corridor().survey;
  for (const MeasuredPoint& point : points_besides_p(hung.tag_template)) {
    CAPTURE(std::string(point.name));
    if (point.right == 0) continue;  // straight below P: only the vehicle's height shows it
    Seen seen{exact_corridor(), {}};
    Draws draws(23);
    seen.rows = seen_from(seen.site, drive_past(seen.site, 6, draws), draws);
    Survey listed = hung;
    for (PlacedTag& tag : listed.tags) {
      Pose& pose = tag.world_from_plate;
      pose.translation += pose.rotation.leftCols<2>() * Eigen::Vector2d(point.right, point.down);
      tag.p_in_grid = grid_from_world(listed.grid, pose.translation);
    }
    for (Observation& row : seen.rows) {
      for (SeenTag& tag : row.tags) tag.tag = *find_tag(listed, tag.tag.name);
    }
    const auto suspicion = suspect_rig(seen.rows, listed, seen.site.rig);
    REQUIRE(suspicion);
    const RigSuspect& plates = suspicion->suspects[0];
    CHECK(plates.parameter == RigParameter::plate_point);
    CHECK(std::string(plates.point.option) == point.option);
    CHECK(plates.expected == doctest::Approx(std::hypot(point.right, point.down)));
    const Survey likely = with_plates_of(plates, listed);
    for (std::size_t i = 0; i < hung.tags.size(); ++i) {
      CHECK((likely.tags[i].p_in_grid - hung.tags[i].p_in_grid).norm() < 1e-9);
    }
  }
}

TEST_CASE("plates lean as the survey's tilt says, and rise with the drive") {
  const Survey stated = exact_corridor().survey;
  const Survey tilted = with_turned_plates(stated, RigParameter::plate_tilt, 0.1);
  const Survey rising = with_turned_plates(stated, RigParameter::plate_slope, 0.1);
  const Vector3d ahead(0, 1, 0);  // the corridor's drive
  for (std::size_t i = 0; i < stated.tags.size(); ++i) {
    CAPTURE(stated.tags[i].name);
    // A plate that leans forward looks down.
    const Vector3d out = -tilted.tags[i].world_from_plate.rotation.col(2);
    CHECK(out.z() == doctest::Approx(-std::sin(0.1)));
    const Vector3d along = rising.tags[i].world_from_plate.rotation.col(0);
    CHECK(along.z() / along.dot(ahead) == doctest::Approx(std::tan(0.1)));
  }
}

TEST_CASE("a camera that hangs askew about its axis is told") {
  const Seen seen = corridor_seen(9);
  Rig wrong = seen.site.rig;
  mount(wrong, 0, 55, 0, 6, Vector3d::Zero());
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
  REQUIRE(suspicion);
  const RigSuspect* left = suspect_named(*suspicion, "left");
  REQUIRE(left != nullptr);
  CHECK(left->parameter == RigParameter::roll);
  CHECK(std::abs(left->expected) < radians(0.1));
}

TEST_CASE("a camera that stands elsewhere than the rig says is told with the way there") {
  const Seen seen = corridor_seen(9);
  Rig wrong = seen.site.rig;
  const Vector3d off(0.01, 0.02, 0.05);
  wrong.cameras[0].vehicle_from_camera.translation -= off;
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
  REQUIRE(suspicion);
  const RigSuspect* left = suspect_named(*suspicion, "left");
  REQUIRE(left != nullptr);
  CHECK(left->parameter == RigParameter::position);
  CHECK((left->shift - off).norm() < 0.005);
  CHECK(left->expected == doctest::Approx(left->shift.norm()));
  CHECK(left->sigma < 0.005);
}

TEST_CASE("a camera that is turned about a slanted axis is told with its angles") {
  const Seen seen = corridor_seen(10);
  Rig wrong = seen.site.rig;
  mount(wrong, 1, -54, 0.8, -0.7, Vector3d::Zero());
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
  REQUIRE(suspicion);
  const RigSuspect* right = suspect_named(*suspicion, "right");
  REQUIRE(right != nullptr);
  CHECK(right->parameter == RigParameter::turn);
  CHECK(std::abs(degrees(right->expected) - 1.3) < 0.3);
  CHECK(std::abs(degrees(right->mounting.yaw) + 55) < 0.1);
  CHECK(std::abs(degrees(right->mounting.pitch)) < 0.3);
  CHECK(std::abs(degrees(right->mounting.roll)) < 0.3);
  CHECK(right->sigma < radians(0.1));
  CHECK(right->rows_explained == suspicion->rows);
  CHECK(describe(*suspicion, wrong).find("right: a turn by 1.") != std::string::npos);
}

TEST_CASE("nothing is suspected of a right rig, nor for a plate that hangs wrong") {
  for (std::uint64_t seed = 11; seed < 16; ++seed) {
    Seen seen = corridor_seen(seed);
    CHECK_FALSE(suspect_rig(seen.rows, seen.site.survey, seen.site.rig));
    seen.site.survey.tags[5].world_from_plate.translation += Vector3d(0, 0.1, 0.02);
    for (Observation& row : seen.rows) {
      for (SeenTag& tag : row.tags) tag.tag = *find_tag(seen.site.survey, tag.tag.name);
    }
    CHECK_FALSE(suspect_rig(seen.rows, seen.site.survey, seen.site.rig));
  }
}

TEST_CASE("nothing is suspected within what the rig states of its own accuracy") {
  Seen seen = corridor_seen(17);
  Rig rough = seen.site.rig;
  for (RigCamera& camera : rough.cameras) camera.calibration_sigma.angle = radians(2);
  mount(rough, 0, 53, 0, 0, Vector3d::Zero());
  CHECK_FALSE(suspect_rig(seen.rows, seen.site.survey, rough));
}

TEST_CASE("a vehicle that stands still shows the same errors again, which accuse no rig") {
  const Seen seen = corridor_seen(18);
  Rig stated = seen.site.rig;
  mount(stated, 0, 45, 0, 0, Vector3d::Zero());
  CHECK(suspect_rig(seen.rows, seen.site.survey, stated));
  for (const Observation& row : seen.rows) {
    const std::vector<Observation> still(40, row);
    CHECK_FALSE(suspect_rig(still, seen.site.survey, stated));
  }
}

TEST_CASE("with one camera alone the template may be wrong instead of the focal length") {
  Seen seen = corridor_seen(19);
  Rig wrong = seen.site.rig;
  wrong.cameras.pop_back();
  for (Observation& row : seen.rows) {
    std::erase_if(row.tags, [](const SeenTag& tag) { return tag.camera != "left"; });
  }
  wrong.cameras[0].camera.fx *= 0.95;
  wrong.cameras[0].camera.fy *= 0.95;
  const auto suspicion = suspect_rig(seen.rows, seen.site.survey, wrong);
  REQUIRE(suspicion);
  CHECK(suspicion->by_one_camera);
  CHECK(std::abs(suspicion->suspects[0].expected - 1 / 0.95) < 0.005);
  CHECK(describe(*suspicion, wrong).find("proportions") != std::string::npos);
}
