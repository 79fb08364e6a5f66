// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/hung_tags.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <regex>
#include <set>
#include <string>

#include <Eigen/Geometry>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "decoder/verify/hanging.hpp"
#include "decoder/verify/hanging_check.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tests/support/wide_corridor.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

// Seen from three places, exactly.
struct Corridor : test::WideCorridor {
  std::string small;  // tag whose frame is printed at 97 %, about its middle
  // Metres that the vehicle drives at each place while the rows of the pictures are read.
  std::map<double, double> driven;
  std::map<double, double> late;  // and until the last camera's picture is taken

  Pose& at(std::string_view name) { return hung[index(name)]; }

  std::vector<SightedTag> seen() const {
    std::vector<SightedTag> sighted;
    for (const double y : {-0.5, 0.3, 1.1}) {
      VehiclePose vehicle;
      vehicle.position = world_from_grid(survey.grid, {0.95, y, 0.24});
      vehicle.heading = world_heading_from_grid(survey.grid, 0);
      for (std::size_t i = 0; i < survey.tags.size(); ++i) {
        for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
          SightedPlate plate = sighted_plate(survey.tags[i], survey);
          plate.world_from_plate = hung[i];
          if (survey.tags[i].name == small) shrink(plate);
          const auto rows = sighting_rows(rig, calibration_layout(rig), {}, vehicle_frame(vehicle),
                                          plate, camera);
          if (!rows || !in_view(*rows)) continue;
          const Eigen::VectorXd moved =
              (driven.contains(y) ? driven.at(y) : 0) * rows->by_calibration.col(kMotion) +
              (late.contains(y) && camera + 1 == rig.cameras.size() ? late.at(y) : 0) *
                  rows->by_calibration.col(kDelay);
          SightedTag tag{std::to_string(y), camera, survey.tags[i].name, {}};
          for (std::size_t c = 0; c < 4; ++c) {
            const auto row = static_cast<Eigen::Index>(2 * c);
            tag.seen.corners[c] = {rows->predicted[row] + moved[row],
                                   rows->predicted[row + 1] + moved[row + 1]};
          }
          tag.seen.covariance = 0.01 * CornerCovariance::Identity();
          sighted.push_back(tag);
        }
      }
    }
    return sighted;
  }

  static void shrink(SightedPlate& plate) {
    const Vector3d corner(0.015 * plate.length, 0.015 * plate.height, 0);
    plate.world_from_plate.translation += plate.world_from_plate.rotation * corner;
    plate.length *= 0.97;
    plate.height *= 0.97;
  }

  static bool in_view(const SightingRows& rows) {
    const double size = (rows.predicted.head<2>() - rows.predicted.segment<2>(4)).norm();
    return size > 60 && rows.predicted.minCoeff() > 0 && rows.predicted.maxCoeff() < 1280;
  }

  HungTag judged(std::string_view name) const {
    const HungTags result = check_hung_tags(survey, rig, seen());
    const auto tag = std::ranges::find(result.tags, name, &HungTag::tag);
    REQUIRE(tag != result.tags.end());
    for (const HungTag& other : result.tags) {
      if (other.tag != name && other.rule != "swapped") CHECK(other.rule == "");
    }
    return *tag;
  }
};

Eigen::Matrix3d turned(double angle, const Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// A photo with one tag in order.
VerifiedFile photo_of(const std::string& tag, const Survey& survey) {
  VerifiedFile photo{"a.jpg"};
  photo.revision = survey_revision(survey);
  photo.width = 1280;
  photo.height = 960;
  photo.tags.resize(1);
  photo.tags[0].tag = tag;
  return photo;
}

void check_all_fit(const Corridor& corridor) {
  const HungTags result = check_hung_tags(corridor.survey, corridor.rig, corridor.seen());
  REQUIRE(result.tags.size() > 3);
  for (const HungTag& tag : result.tags) {
    CAPTURE(tag.tag);
    CHECK(tag.rule == "");
    CHECK(tag.verdict == HangVerdict::fits);
  }
}

}  // namespace

TEST_CASE("rolling shutters of a drive whose speed varies accuse no plate") {
  Corridor corridor;
  corridor.driven = {{-0.5, 0}, {0.3, 0.04}, {1.1, 0.015}};
  for (RigCamera& camera : corridor.rig.cameras) camera.readout = 0.02;
  corridor.rig.envelope = VehicleEnvelope{0.1, radians(2), 2};
  set_motion_sigmas(corridor.rig);
  check_all_fit(corridor);
}

TEST_CASE("cameras that run freely in a drive accuse no plate") {
  Corridor corridor;
  corridor.late = {{-0.5, 0.02}, {0.3, -0.03}, {1.1, 0.04}};
  CHECK(std::ranges::any_of(check_hung_tags(corridor.survey, corridor.rig, corridor.seen()).tags,
                            [](const HungTag& tag) { return tag.verdict != HangVerdict::fits; }));
  for (RigCamera& camera : corridor.rig.cameras) camera.delay = 0.02;
  corridor.rig.envelope = VehicleEnvelope{0.1, radians(2), 2};
  set_motion_sigmas(corridor.rig);
  check_all_fit(corridor);
}

TEST_CASE("a twisted plate is named, and the others are judged without it") {
  const Corridor corridor;
  std::vector<SightedTag> sighted = corridor.seen();
  for (SightedTag& tag : sighted) {
    if (tag.tag != "002R") continue;
    for (const std::size_t corner : {0U, 2U}) tag.seen.corners[corner].y -= 3;
    for (const std::size_t corner : {1U, 3U}) tag.seen.corners[corner].y += 3;
  }
  const HungTags result = check_hung_tags(corridor.survey, corridor.rig, sighted);
  CHECK_FALSE(result.nothing_fits);
  for (const HungTag& tag : result.tags) {
    CAPTURE(tag.tag);
    CHECK(tag.rule == (tag.tag == "002R" ? "not-flat" : ""));
    CHECK(tag.verdict == (tag.tag == "002R" ? HangVerdict::doubtful : HangVerdict::fits));
  }
}

TEST_CASE(
    "a frame of another size that hangs elsewhere takes two mistakes: named, and not certain") {
  // One that hangs elsewhere is certain. A block of plates that hang further along looks like both.
  for (const bool is_small : {false, true}) {
    CAPTURE(is_small);
    Corridor corridor;
    if (is_small) corridor.small = "002R";
    Pose& pose = corridor.at("002R");
    pose.translation += pose.rotation * Vector3d(0.06, 0.04, 0.02);
    const HungTag tag = corridor.judged("002R");
    CHECK(tag.rule == "moved");
    CHECK(tag.verdict == (is_small ? HangVerdict::doubtful : HangVerdict::off));
  }
}

TEST_CASE("neighbours that no photo ties are told: what lies beyond may hang elsewhere together") {
  Corridor corridor;
  const std::vector<SightedTag> all = corridor.seen();
  CHECK(check_hung_tags(corridor.survey, corridor.rig, all).untied.empty());
  // Of the first place only what hangs before 1 m, of the others what hangs beyond.
  std::vector<SightedTag> parted;
  double last_before = 0, first_beyond = 1e9;
  for (const SightedTag& tag : all) {
    const double at = find_tag(corridor.survey, std::string_view(tag.tag))->chainage;
    const bool is_first = tag.station == all.front().station;
    if (is_first != (at < 1)) continue;
    parted.push_back(tag);
    (is_first ? last_before : first_beyond) =
        is_first ? std::max(last_before, at) : std::min(first_beyond, at);
  }
  REQUIRE(last_before < first_beyond);
  const HungTags judged = check_hung_tags(corridor.survey, corridor.rig, parted);
  REQUIRE_FALSE(judged.untied.empty());
  for (const UntiedPair& pair : judged.untied) {
    CHECK(find_tag(corridor.survey, std::string_view(pair.before))->chainage < 1);
    CHECK(find_tag(corridor.survey, std::string_view(pair.after))->chainage >= 1);
  }
  CHECK(untied_in_words(judged.untied)->find(judged.untied[0].before + " and ") !=
        std::string::npos);
  CHECK_FALSE(untied_in_words({}).has_value());
}

TEST_CASE("what is off is told as who faces the wall has to mend it") {
  struct Case {
    Vector3d shift;  // of the plate, right, down, into the wall
    const char* instruction;
  };
  for (const Case& c :
       {Case{{0.03, 0, 0}, "move it left by 30 mm"}, Case{{-0.03, 0, 0}, "move it right by 30 mm"},
        Case{{0, 0.03, 0}, "raise it by 30 mm"}, Case{{0, -0.03, 0}, "lower it by 30 mm"},
        Case{{0, 0, -0.03}, "set it back by 30 mm"},
        Case{{0, 0, 0.03}, "bring it out from the wall by 30 mm"}}) {
    for (const char* name : {"001L", "001R"}) {
      CAPTURE(c.instruction);
      CAPTURE(name);
      Corridor corridor;
      Pose& pose = corridor.at(name);
      pose.translation += pose.rotation * c.shift;
      const HungTag tag = corridor.judged(name);
      CHECK(tag.verdict == HangVerdict::off);
      CHECK(tag.rule == "moved");
      CHECK(tag.message ==
            std::string(name) + " hangs 30 mm from its surveyed place: " + c.instruction);
    }
  }
}

TEST_CASE("a moved tag that is to stay has an entry for the survey, by which it hangs right") {
  Corridor corridor;
  Pose& pose = corridor.at("001L");
  pose.translation += pose.rotation * Vector3d(0.03, -0.02, 0.01);
  pose.rotation *= turned(radians(4), Vector3d::UnitY());
  const HungTag tag = corridor.judged("001L");
  REQUIRE_FALSE(tag.placed.empty());
  const std::string text = *read_file("surveys/corridor/survey.yaml");
  const Diagnosed<Survey> reading = read_survey_text("surveys/corridor/as_built.yaml",
                                                     text + "placed:\n  - " + tag.placed + "\n");
  REQUIRE_MESSAGE(reading.value, to_string(reading.diagnostics, true));
  const PlacedTag& placed = *find_tag(*reading.value, std::string_view("001L"));
  CHECK((placed.world_from_plate.translation - pose.translation).norm() < 1e-3);
  CHECK(angle_between(placed.world_from_plate.rotation, pose.rotation) < radians(0.1));
  CHECK(placed.digits == find_tag(corridor.survey, std::string_view("001L"))->digits);
  const double of_each_axis = std::sqrt(tag.offset.sigma.squaredNorm() / 3);
  CHECK(placed.sigma / of_each_axis == doctest::Approx(1).epsilon(0.1));
  corridor.survey = *reading.value;
  CHECK(corridor.judged("001L").verdict == HangVerdict::fits);
}

TEST_CASE("a strange code is linked to the place where it hangs when no photo shows its tag") {
  const std::string code = "123456789012";
  Corridor corridor;
  std::vector<SightedTag> sighted = corridor.seen();
  const auto unknown_tags_of = [&] {
    return check_hung_tags(corridor.survey, corridor.rig, sighted).unknown_tags;
  };
  CHECK(unknown_tags_of().empty());
  // One more plate than the survey has, where none should hang.
  const SightedTag known = sighted.front();
  sighted.push_back(known);
  sighted.back().tag = code;
  for (PixelPoint& corner : sighted.back().seen.corners) corner.y -= 300;
  CHECK(unknown_tags_of().empty());
  // Where the tag hangs that bears the code, but it is seen there, too.
  sighted.back() = known;
  sighted.back().tag = code;
  CHECK(unknown_tags_of().empty());
  sighted.pop_back();
  std::size_t count = 0;
  for (SightedTag& tag : sighted) {
    if (tag.tag != "001R") continue;
    tag.tag = code;
    ++count;
  }
  const std::vector<UnknownTag> unknown_tags = unknown_tags_of();
  REQUIRE(count > 0);
  CHECK(unknown_tags.size() == count);
  for (const UnknownTag& unknown : unknown_tags) {
    CHECK(unknown.code == code);
    CHECK(unknown.place == "001R");
  }
  // By a rig that fits nothing no place is known.
  for (RigCamera& camera : corridor.rig.cameras) camera.camera.fx = camera.camera.fy = 1100;
  CHECK(unknown_tags_of().empty());
}

TEST_CASE(
    "what is off is told with the odds over the next explanation, which grow with the shift") {
  double before = 2.6;  // 12 of chi-square, below which a verdict is doubtful
  for (const double shift : {0.02, 0.03, 0.05}) {
    Corridor corridor;
    Pose& pose = corridor.at("001L");
    pose.translation += pose.rotation * Vector3d(0, shift, 0);
    const HungTag tag = corridor.judged("001L");
    REQUIRE(tag.verdict == HangVerdict::off);
    CHECK(tag.odds > before);
    before = tag.odds;
  }
}

TEST_CASE("turns are told by the side that has to move") {
  struct Case {
    Vector3d axis;
    const char* instruction;
  };
  for (const Case& c : {Case{Vector3d::UnitZ(), "turn it anticlockwise by 6.0 degrees"},
                        Case{-Vector3d::UnitZ(), "turn it clockwise by 6.0 degrees"},
                        Case{Vector3d::UnitY(), "press its right edge back by 6.0 degrees"},
                        Case{Vector3d::UnitX(), "tilt its top back by 6.0 degrees"}}) {
    CAPTURE(c.instruction);
    Corridor corridor;
    corridor.at("001L").rotation *= turned(radians(6), c.axis);
    const HungTag tag = corridor.judged("001L");
    CHECK(tag.rule == "moved");
    CHECK(tag.message.ends_with(std::string("surveyed place: ") + c.instruction));
  }
}

TEST_CASE("a plate on its head, in another's place, or exchanged is told as such") {
  Corridor head;
  Pose& pose = head.at("001L");
  pose.translation += pose.rotation * Vector3d(0.343, 0.168, 0);
  pose.rotation *= turned(std::numbers::pi, Vector3d::UnitZ());
  CHECK(head.judged("001L").rule == "upside-down");

  Corridor exchanged;
  std::swap(exchanged.at("001L"), exchanged.at("002L"));
  CHECK(exchanged.judged("001L").rule == "swapped");
  CHECK(exchanged.judged("002L").message ==
        "002L and 001L hang in each other's place: exchange them");

  Corridor opposite;
  opposite.at("001L") = opposite.at("001R");
  opposite.at("001R").translation.y() += 30;  // taken down
  const HungTag wrong_wall = opposite.judged("001L");
  CHECK(wrong_wall.rule == "wrong-wall");
  CHECK(wrong_wall.message.find("001R") != std::string::npos);
}

TEST_CASE("of two tags that contradict each other each is told what to do if it is the one") {
  Corridor corridor;
  corridor.survey.angle_sigma = radians(0.1);
  Pose& low = corridor.at("001L");
  low.translation += low.rotation * Vector3d(0, 0.03, 0);
  std::vector<SightedTag> picture = corridor.seen();
  std::erase_if(picture, [](const SightedTag& tag) {
    return tag.station != std::to_string(0.3) || (tag.tag != "001L" && tag.tag != "001R");
  });
  REQUIRE(picture.size() == 2);
  const HungTags result = check_hung_tags(corridor.survey, corridor.rig, picture);
  REQUIRE(result.tags.size() == 2);
  const std::string left =
      "001L and 001R do not fit together by 30 mm: one of them hangs wrong, "
      "and no other tag in view tells which. Measure them: if it is 001L, "
      "raise it by 30 mm; if it is 001R, lower it by 30 mm. A photo of 001L "
      "together with 000L would tell";
  const std::string right =
      "001R and 001L do not fit together by 30 mm: one of them hangs wrong, "
      "and no other tag in view tells which. Measure them: if it is 001R, "
      "lower it by 30 mm; if it is 001L, raise it by 30 mm. A photo of 001R "
      "together with 000R would tell";
  for (const HungTag& tag : result.tags) {
    CHECK(tag.verdict == HangVerdict::doubtful);
    CHECK(tag.rule == "contradiction");
    CHECK(tag.odds == 0);
    CHECK(tag.message == (tag.tag == "001L" ? left : right));
  }
}

TEST_CASE("an assumed angle_sigma gives way to what the pictures say of plates' tilt") {
  Corridor corridor;
  const auto turn_sigma = [&] { return corridor.judged("001L").turn.sigma.maxCoeff(); };
  const double estimated = turn_sigma();
  corridor.survey.angle_sigma = radians(3);
  CHECK(turn_sigma() > 1.01 * estimated);  // stated
  corridor.survey.states_angle_sigma = false;
  CHECK(turn_sigma() == doctest::Approx(estimated));
}

TEST_CASE("what survey and rig leave unsaid is among what the check of hung tags says") {
  Corridor corridor;
  CHECK(check_hung_tags(corridor.survey, corridor.rig, corridor.seen()).assumed.empty());
  corridor.survey.states_sigma = false;
  corridor.rig.cameras.front().assumed_sigma = "angle 0.5 degrees";
  CHECK(check_hung_tags(corridor.survey, corridor.rig, corridor.seen()).assumed.size() == 2);
}

TEST_CASE("of exchanged photos nobody is told to turn a plate round") {
  Corridor corridor;
  std::vector<SightedTag> picture = corridor.seen();
  std::erase_if(picture, [](const SightedTag& tag) {
    return tag.station != std::to_string(0.3) || (tag.tag != "001L" && tag.tag != "001R");
  });
  REQUIRE(picture.size() == 2);
  std::swap(picture[0].camera, picture[1].camera);
  for (const HungTag& tag : check_hung_tags(corridor.survey, corridor.rig, picture).tags) {
    CAPTURE(tag.message);
    CHECK(tag.rule == "contradiction");
    CHECK(tag.message.find("Are the photos of the cameras exchanged") != std::string::npos);
  }
}

TEST_CASE("a frame of another size is told with the least error of size that could be seen") {
  Corridor corridor;
  corridor.survey.angle_sigma = radians(0.1);
  corridor.small = "001L";
  const auto tells = [](const HungTag& tag, const std::string& words) {
    return tag.message.find(words) != std::string::npos;
  };
  const HungTag tag = corridor.judged("001L");
  CAPTURE(tag.message);
  CHECK(tag.rule == "wrong-scale");
  // Its size, and the least error that could be seen: percent both.
  std::smatch sizes;
  REQUIRE(std::regex_search(tag.message, sizes, std::regex(" 97\\.0 % .* ([0-9.]+) %")));
  CHECK(std::stod(sizes[1]) > 0.1);
  CHECK(std::stod(sizes[1]) < 3);
  std::vector<SightedTag> picture = corridor.seen();
  std::erase_if(picture, [](const SightedTag& seen) {
    return seen.station != std::to_string(0.3) || (seen.tag != "001L" && seen.tag != "001R");
  });
  const HungTags pair = check_hung_tags(corridor.survey, corridor.rig, picture);
  REQUIRE(pair.tags.size() == 2);
  CAPTURE(pair.tags[0].message);
  CHECK(pair.tags[0].rule == "contradiction");
  CHECK(tells(pair.tags[0], " 97."));
}

TEST_CASE("photos that no place of the cameras explains are findings of their tags, there only") {
  Corridor corridor;
  std::vector<SightedTag> sighted = corridor.seen();
  corridor.at("001R") = corridor.survey.tags[corridor.index("002R")].world_from_plate;
  const std::string row = std::to_string(1.1);
  std::erase_if(sighted, [&](const SightedTag& tag) { return tag.station == row; });
  for (const SightedTag& tag : corridor.seen()) {
    if (tag.station == row && tag.tag != "002R") sighted.push_back(tag);
  }
  const HungTags result = check_hung_tags(corridor.survey, corridor.rig, sighted);
  for (const HungTag& tag : result.tags) CHECK(tag.verdict != HangVerdict::off);
  REQUIRE(result.unplaced.size() == 1);
  CHECK(result.unplaced[0].station == row);
  const std::vector<HungTag>& tags = result.unplaced[0].tags;
  const auto copy = std::ranges::find(tags, "001R", &HungTag::tag);
  REQUIRE(copy != tags.end());
  CHECK(copy->verdict == HangVerdict::doubtful);
  CHECK(copy->rule == "no-common-place");
  CAPTURE(copy->message);
  CHECK(copy->message.find("002R") != std::string::npos);

  // In the photo of that row the tag is doubtful, in another it is in order.
  std::vector<VerifiedFile> photos(2);
  const fs::path folder = fs::current_path();
  Run run;
  run.measurements.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string& camera = corridor.rig.cameras[0].name;
    photos[i] = photo_of("001R", corridor.survey);
    photos[i].file = folder / fmt::format("{}.jpg", i);
    run.measurements[i].id = i == 0 ? "first" : "second";
    run.measurements[i].cameras[camera].image = photos[i].file;
  }
  const HangingSetup setup{corridor.rig, PhotoCameras::by_run(corridor.rig, run)};
  HungTags hung;
  hung.revision = survey_revision(corridor.survey);
  hung.tags = {HungTag{"001R", HangVerdict::fits, 2, {}, {}, {}, "", ""}};
  hung.unplaced = {{setup.cameras.origin_of(photos[1].file)->station, {*copy}}};
  for (VerifiedFile& photo : photos) judge_hanging(corridor.survey, setup, hung, photo);
  CHECK(photos[0].tags[0].finding.status == TagStatus::ok);
  CHECK(findings_of(photos[0]).empty());
  CHECK(photos[1].tags[0].finding.status == TagStatus::doubtful);
  CHECK(rules_of(photos[1]) == std::set<std::string>{"no-common-place"});
}

TEST_CASE("a second copy in the place of a tag that nobody saw is told where it is seen") {
  const Corridor corridor;
  const std::vector<SightedTag> seen = corridor.seen();
  const auto shown = std::ranges::find(seen, "004R", &SightedTag::tag);
  REQUIRE(std::ranges::count(seen, "004R", &SightedTag::tag) == 1);
  // Tags beside it in the same photo have been taken together with it; those of the other camera
  // may be of another row.
  for (const bool has_neighbours : {true, false}) {
    CAPTURE(has_neighbours);
    std::vector<SightedTag> sighted = seen;
    std::ranges::find(sighted, "004R", &SightedTag::tag)->tag = "000R";
    std::erase_if(sighted, [&](const SightedTag& tag) {
      return !has_neighbours && tag.station == shown->station && tag.camera == shown->camera &&
             tag.tag != "000R";
    });
    const HungTags result = check_hung_tags(corridor.survey, corridor.rig, sighted);
    for (const HungTag& tag : result.tags) CHECK(tag.verdict == HangVerdict::fits);
    REQUIRE(result.unplaced.size() == 1);
    CHECK(result.unplaced[0].station == shown->station);
    REQUIRE(result.unplaced[0].tags.size() == 1);
    const HungTag& copy = result.unplaced[0].tags[0];
    CHECK(copy.tag == "000R");
    CHECK(copy.rule == "second-copy");
    CHECK(
        copy.message.starts_with("a second copy of 000R hangs in the place of 004R: take it down"));
    CHECK(copy.verdict == (has_neighbours ? HangVerdict::off : HangVerdict::doubtful));
    CHECK((copy.message.find("Not certain: photos that were not taken together") ==
           std::string::npos) == has_neighbours);
  }
}

TEST_CASE(
    "what seems a copy is none for certain where no photo ties the original to its neighbours") {
  const Corridor corridor;
  std::vector<SightedTag> sighted = corridor.seen();
  const std::string station = std::ranges::find(sighted, "004R", &SightedTag::tag)->station;
  std::ranges::find(sighted, "004R", &SightedTag::tag)->tag = "000R";
  // The pair 000 by itself, and all others without it: a block that hangs nearer explains it, too.
  std::erase_if(sighted, [&](const SightedTag& tag) {
    const bool is_first_pair = tag.tag == "000L" || (tag.tag == "000R" && tag.station != station);
    return is_first_pair == (tag.station == station);
  });
  const HungTags result = check_hung_tags(corridor.survey, corridor.rig, sighted);
  for (const UnplacedTags& unplaced : result.unplaced) {
    for (const HungTag& tag : unplaced.tags) CHECK(tag.verdict == HangVerdict::doubtful);
  }
  const auto copy = std::ranges::find(result.unplaced, station, &UnplacedTags::station);
  REQUIRE(copy != result.unplaced.end());
  CHECK(copy->tags[0].rule == "second-copy");
  CHECK(copy->tags[0].message.find("a slip in the tape") != std::string::npos);
}

TEST_CASE("on walls that lean, each plate is compared with plates that all lean so") {
  Corridor corridor;
  for (Pose& hung : corridor.hung) hung.rotation *= turned(radians(-3), Vector3d::UnitX());
  const HungTags leaning = check_hung_tags(corridor.survey, corridor.rig, corridor.seen());
  CHECK(leaning.all_alike.find("plates of both walls that lean back by 3.0") != std::string::npos);
  CHECK(leaning.rig_doubt.empty());
  for (const HungTag& tag : leaning.tags) {
    CAPTURE(tag.tag);
    CHECK(tag.verdict == HangVerdict::fits);
    CHECK(tag.turn.value.norm() < radians(0.2));
  }
}

TEST_CASE("a camera that was knocked a degree about any axis is told as the rig's fault") {
  Corridor corridor;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  corridor.survey.states_angle_sigma = false;  // hung by eye, nobody says how well
  for (Pose& hung : corridor.hung) {
    hung.rotation *= turned(radians(0.1) * normal(random), Vector3d::UnitX());
    hung.rotation *= turned(radians(0.1) * normal(random), Vector3d::UnitY());
  }
  const Rig told = corridor.rig;
  CHECK_FALSE(rig_doubt(corridor.survey, told, corridor.seen()));
  for (int i = 0; i < 5; ++i) {
    corridor.rig = told;
    const Vector3d axis = Vector3d(normal(random), normal(random), normal(random)).normalized();
    corridor.rig.cameras[1].vehicle_from_camera.rotation *= turned(radians(1), axis);
    const auto doubt = rig_doubt(corridor.survey, told, corridor.seen());
    REQUIRE(doubt);
    CAPTURE(doubt->text);
    CHECK(doubt->text.find("right: ") != std::string::npos);
    for (const HungTag& tag : check_hung_tags(corridor.survey, told, corridor.seen()).tags) {
      CHECK(tag.verdict == HangVerdict::unchecked);
    }
  }
}

TEST_CASE("rows that have each other's photos of a camera are told, and no tag is accused") {
  const Corridor corridor;
  std::vector<SightedTag> sighted = corridor.seen();
  const std::string one = std::to_string(-0.5);
  const std::string other = std::to_string(1.1);
  for (SightedTag& tag : sighted) {
    if (tag.camera == 0 || tag.station == std::to_string(0.3)) continue;
    tag.station = tag.station == one ? other : one;
  }
  const HungTags result = check_hung_tags(corridor.survey, corridor.rig, sighted);
  for (const HungTag& tag : result.tags) CHECK(tag.rule == "");
  CHECK(result.unplaced.empty());
  REQUIRE(result.mixed.size() == 1);
  CHECK(
      in_words(result.mixed[0], corridor.rig) ==
      one + " and " + other +
          " are mixed up: each has the other's photo of camera left, or of all its other cameras");
  // Both rows' photos say so, and no longer when they are judged anew.
  VerifiedFile photo = photo_of("001R", corridor.survey);
  photo.file = fs::current_path() / "a.jpg";
  Run run;
  run.measurements.resize(1);
  run.measurements[0].id = "x";
  run.measurements[0].cameras[corridor.rig.cameras[0].name].image = photo.file;
  const HangingSetup setup{corridor.rig, PhotoCameras::by_run(corridor.rig, run)};
  HungTags hung;
  hung.revision = survey_revision(corridor.survey);
  hung.mixed = {{"row x", "row y", 0}};
  judge_hanging(corridor.survey, setup, hung, photo);
  CHECK(rules_of(photo) == std::set<std::string>{"mixed-photos"});
  judge_hanging(corridor.survey, setup, hung, photo);
  CHECK(findings_of(photo).size() == 1);
  hung.mixed.clear();
  judge_hanging(corridor.survey, setup, hung, photo);
  CHECK(findings_of(photo).empty());
}

TEST_CASE("tags that hang as surveyed are measured and have no finding") {
  const Corridor corridor;
  const HungTag tag = corridor.judged("001L");
  CHECK(tag.verdict == HangVerdict::fits);
  CHECK(tag.offset.value.norm() < 1e-4);
  CHECK(tag.offset.sigma.maxCoeff() < 0.01);
  CHECK(tag.stations >= 2);
}

TEST_CASE("tags that were hung by eye are not accused of being elsewhere, however few are seen") {
  std::mt19937_64 random(13);
  std::normal_distribution<double> angle(0, radians(0.5));
  int checked = 0;
  for (int draw = 0; draw < 40; ++draw) {
    Corridor corridor;
    for (Pose& pose : corridor.hung) {
      const Vector3d turn(angle(random), angle(random), angle(random));
      pose.rotation *= turned(turn.norm(), turn.normalized());
    }
    const std::vector<SightedTag> seen = corridor.seen();
    for (const char* other : {"001L", "001R", "002L"}) {
      std::vector<SightedTag> picture = seen;
      std::erase_if(picture, [&](const SightedTag& tag) {
        return tag.station != std::to_string(0.3) || (tag.tag != "002R" && tag.tag != other);
      });
      for (const HungTag& tag : check_hung_tags(corridor.survey, corridor.rig, picture).tags) {
        checked += tag.verdict == HangVerdict::unchecked ? 0 : 1;
        CHECK(tag.rule == "");
      }
    }
  }
  CHECK(checked > 100);
}

TEST_CASE("only photos that were verified against this state of the survey tell where tags hang") {
  const Corridor corridor;
  const HangingSetup setup{corridor.rig, PhotoCameras::by_names(corridor.rig)};
  VerifiedFile photo = photo_of("001L", corridor.survey);
  VerifiedFile page = photo;
  page.file = "page.pdf";
  page.width = 0;
  VerifiedFile older = photo;
  older.file = "older.jpg";
  older.revision = "another";
  int taken = 0;
  const auto files = [&](const std::function<void(const VerifiedFile&)>& each) -> Result<void> {
    for (const VerifiedFile& file : {photo, page, older, photo}) each(file);
    return {};
  };
  CHECK(for_each_sighted(corridor.survey, setup, files, [&](auto&, auto&) { ++taken; }));
  CHECK(taken == 1);
}

TEST_CASE("of photos whose camera is not known twenty are named, and more are counted") {
  const Corridor corridor;
  const HangingSetup setup{corridor.rig, PhotoCameras::by_names(corridor.rig)};
  const auto notes_of = [&](int photos) {
    const auto files = [&](const std::function<void(const VerifiedFile&)>& each) -> Result<void> {
      for (int i = 0; i < photos; ++i) {
        VerifiedFile photo = photo_of("001L", corridor.survey);
        photo.file = fmt::format("{:02}.jpg", i);
        each(photo);
      }
      return {};
    };
    return check_hanging(corridor.survey, setup, files).value().notes.size();
  };
  const std::size_t without = notes_of(0);
  CHECK(notes_of(1) == without + 1);
  CHECK(notes_of(20) == without + 20);
  CHECK(notes_of(21) == without + 21);
  CHECK(notes_of(22) == without + 21);
}

TEST_CASE("what was found is written into the files, in place of what was said before") {
  const Corridor corridor;
  VerifiedFile photo = photo_of("001L", corridor.survey);
  photo.tags[0].digits = corridor.survey.tags[corridor.index("001L")].digits;
  const RigCamera& camera = corridor.rig.cameras[0];
  photo.file = camera.name + ".jpg";
  photo.width = camera.camera.width;
  photo.height = camera.camera.height;
  const HangingSetup setup{corridor.rig, PhotoCameras::by_names(corridor.rig)};
  HungTags hung;
  hung.revision = survey_revision(corridor.survey);
  hung.tags = {HungTag{"001L", HangVerdict::fits, 2, {}, {}, {}, "", ""}};
  for (const TagStatus by_picture : {TagStatus::misplaced, TagStatus::doubtful}) {
    photo.tags[0].finding = {by_picture, "swapped", "the picture's order"};
    std::size_t sighted = 0;
    REQUIRE(for_each_sighted(
        corridor.survey, setup,
        [&](const auto& take) -> Result<void> {
          take(photo);
          return {};
        },
        [&](const auto& tags, auto&) { sighted += tags.size(); }));
    CHECK(sighted == 1);
    judge_hanging(corridor.survey, setup, hung, photo);
    CHECK(photo.tags[0].finding.status == TagStatus::ok);
    CHECK(findings_of(photo).empty());
    CHECK(rules_of(photo).empty());
  }

  hung.tags[0].verdict = HangVerdict::off;
  hung.tags[0].rule = "moved";
  hung.tags[0].message = "raise it";
  judge_hanging(corridor.survey, setup, hung, photo);
  CHECK(findings_of(photo) == std::vector<std::string>{"misplaced: raise it"});
  CHECK(rules_of(photo) == std::set<std::string>{"moved"});

  hung.tags.clear();
  judge_hanging(corridor.survey, setup, hung, photo);
  CHECK(photo.tags[0].finding.status == TagStatus::ok);
}

TEST_CASE("a rig that stands on its wheels tells which tags of a photo stand on their head") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  HangingSetup setup{load_rig("surveys/corridor/rig.yaml").value(), {}};
  setup.cameras = PhotoCameras::by_names(setup.rig);
  VerifiedFile upright = photo_of("000L", survey);
  upright.file = "corridor_01_left.jpg";
  upright.tags[0].corners = {{{470, 230}, {870, 270}, {870, 490}, {470, 490}}};
  VerifiedFile on_head = upright;
  std::swap(on_head.tags[0].corners[0], on_head.tags[0].corners[2]);
  std::swap(on_head.tags[0].corners[1], on_head.tags[0].corners[3]);
  HungTags hung;
  hung.revision = survey_revision(survey);
  const auto judged = [&](VerifiedFile photo) {
    judge_hanging(survey, setup, hung, photo);
    return photo;
  };
  CHECK(judged(upright).tags[0].finding.status == TagStatus::ok);
  CHECK(judged(on_head).tags[0].finding.rule == "upside-down");
  CHECK(judged(on_head).up == UpSource::rig);

  // What the camera's note made doubtful is in order when the rig's stance says so, and else wrong.
  for (const VerifiedFile& photo : {upright, on_head}) {
    VerifiedFile doubted = photo;
    doubted.up = UpSource::doubted;
    doubted.notes = {"all 2 tags" + std::string(kDoubtedUp), "damaged"};
    doubted.tags[0].finding = {TagStatus::doubtful, "upside-down", "on its head"};
    doubted = judged(doubted);
    const bool is_wrong = judged(photo).tags[0].finding.status != TagStatus::ok;
    CHECK(doubted.tags[0].finding.status == (is_wrong ? TagStatus::misprinted : TagStatus::ok));
    CHECK(findings_of(doubted).size() == (is_wrong ? 1 : 0));
    CHECK(doubted.notes == std::vector<std::string>{"damaged"});
    CHECK(doubted.up == UpSource::rig);
  }

  setup.rig.roll_sigma = radians(60);
  CHECK(judged(on_head).tags[0].finding.status == TagStatus::ok);
}

TEST_CASE("a plate that hangs by one screw, alone in its photo, is told by the rig's mounting") {
  for (const std::string name : {"001L", "001R"}) {
    for (const double by : {0.0, 6.0, 15.0, -15.0, 45.0, -90.0}) {
      CAPTURE(name);
      CAPTURE(by);
      Corridor corridor;
      Pose& pose = corridor.at(name);
      const Vector3d middle(0.19, 0.1, 0);
      const Eigen::Matrix3d turn = turned(radians(by), Vector3d::UnitZ());
      pose.translation += pose.rotation * (middle - turn * middle);
      pose.rotation *= turn;
      std::vector<SightedTag> seen = corridor.seen();
      std::erase_if(seen, [&](const SightedTag& tag) { return tag.tag != name; });
      REQUIRE(!seen.empty());
      VerifiedFile photo = photo_of(name, corridor.survey);
      photo.file = "1_" + corridor.rig.cameras[seen[0].camera].name + ".jpg";
      for (std::size_t c = 0; c < 4; ++c) {
        photo.tags[0].corners[c] = seen[0].seen.corners[c];
      }
      const HangingSetup setup{corridor.rig, PhotoCameras::by_names(corridor.rig)};
      HungTags hung;
      hung.revision = survey_revision(corridor.survey);
      judge_hanging(corridor.survey, setup, hung, photo);
      CHECK(photo.tags[0].finding.rule == (std::abs(by) > 10 ? "turned" : ""));
      const std::string way = by > 10 ? " clockwise by" : by < -10 ? " anticlockwise by" : "";
      CHECK(photo.tags[0].finding.message.find(way) != std::string::npos);
      judge_hanging(corridor.survey, setup, hung, photo);
      CHECK(photo.tags[0].finding.rule == (std::abs(by) > 10 ? "turned" : ""));
    }
  }
}

}  // namespace tagsmith::detail
