// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/as_built.hpp"

#include <doctest/doctest.h>

#include "tagsmith/base/statistics.hpp"
#include "tests/support/as_built_drive.hpp"

namespace tagsmith::detail::test {
namespace {

const AsBuiltTag& tag_of(const AsBuiltSurvey& found, const std::string& name) {
  const auto tag = std::ranges::find(found.tags, name, &AsBuiltTag::tag);
  REQUIRE(tag != found.tags.end());
  return *tag;
}

// A short drive between two pairs of control tags.
AsBuiltDrive short_drive(Draws& draws, double control_every = 8) {
  AsBuiltDriveOptions options;
  options.pairs = 11;
  options.stations = 40;
  options.control_every = control_every;
  return as_built_drive(options, draws);
}

std::size_t index_of(const AsBuiltDrive& drive, std::string_view name) {
  return static_cast<std::size_t>(find_tag(drive.survey, name) - drive.survey.tags.data());
}

}  // namespace

TEST_CASE("tags hang within 3.5 mm of where they are found, and as surely as is stated") {
  // Between control tags errors are alike: only many draws tell whether they are as stated.
  std::vector<double> distances;
  double nees = 0;
  constexpr int kDraws = 8;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    CAPTURE(seed);
    Draws draws(seed);
    AsBuiltDriveOptions options;
    options.pairs = 51;
    options.stations = 500;
    const AsBuiltDrive drive = as_built_drive(options, draws);
    const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, drive.control);
    REQUIRE_MESSAGE(found, found.error().message);
    const AsBuiltErrors errors = errors_of(drive, *found);
    CHECK(errors.distances.size() == 96);
    distances.insert(distances.end(), errors.distances.begin(), errors.distances.end());
    nees += errors.nees / kDraws;
    CHECK(found->sigma_factor < 1.05);
  }
  CHECK(quantile(distances, 0.95) < 0.0035);
  CHECK(nees > 0.8);
  CHECK(nees < 1.25);
}

TEST_CASE("the sigma for a survey holds for the mean of tags that are seen together") {
  double nees = 0;
  double as_single = 0;
  constexpr int kDraws = 12;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    Draws draws(seed);
    const AsBuiltDrive drive = short_drive(draws);
    const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, drive.control);
    REQUIRE_MESSAGE(found, found.error().message);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double variance = 0;
    double of_single = 0;
    for (const char* name : {"004L", "004R", "005L", "005R", "006L", "006R"}) {
      const AsBuiltTag& tag = tag_of(*found, name);
      mean += tag.world_from_plate.translation - drive.hung[index_of(drive, name)].translation;
      variance += tag.survey_sigma * tag.survey_sigma;
      of_single += tag.covariance.topLeftCorner<3, 3>().trace() / 3;
    }
    nees += mean.squaredNorm() / (3 * variance) / kDraws;
    as_single += mean.squaredNorm() / (3 * of_single) / kDraws;
  }
  CHECK(nees < 1.4);
  CHECK(nees > 0.3);
  CHECK(as_single > 2);
}

TEST_CASE("a tag in another place and a misread tag spoil nothing") {
  Draws draws(3);
  AsBuiltDrive drive = short_drive(draws);
  // 004L and 005L hang in each other's place: their photos say the other's name.
  for (SightedTag& tag : drive.sighted) {
    if (tag.tag == "004L" || tag.tag == "005L") tag.tag = tag.tag == "004L" ? "005L" : "004L";
  }
  std::swap(drive.hung[index_of(drive, "004L")], drive.hung[index_of(drive, "005L")]);
  drive.sighted[drive.sighted.size() / 2].tag = "000R";
  const std::string station = drive.sighted[drive.sighted.size() / 2].station;
  const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, drive.control);
  REQUIRE_MESSAGE(found, found.error().message);
  const AsBuiltErrors errors = errors_of(drive, *found);
  CHECK(errors.distances.size() == 18);
  CHECK(std::ranges::max(errors.distances) < 0.006);
  CHECK(std::ranges::any_of(found->left_out, [&](const LeftOutSighting& out) {
    return out.tag == "000R" && out.station == station;
  }));
}

// What judge_control makes of a drive with a control pair every 10 m.
struct JudgedControl {
  AsBuiltSurvey found;
  std::vector<std::string> contradicted;
};

JudgedControl judged(const AsBuiltDrive& drive) {
  auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, drive.control);
  REQUIRE_MESSAGE(found, found.error().message);
  JudgedControl result{std::move(*found), {}};
  judge_control(drive.survey, result.found);
  for (const AsBuiltTag& tag : result.found.tags) {
    if (tag.status == AsBuiltStatus::contradicted) result.contradicted.push_back(tag.tag);
  }
  return result;
}

AsBuiltDrive drive_of_pairs(std::uint64_t seed) {
  AsBuiltDriveOptions options;
  options.pairs = 51;
  options.stations = 300;
  options.control_every = 10;
  Draws draws(seed);
  return as_built_drive(options, draws);
}

TEST_CASE("control tags that are surveyed right are held by each other, and none is accused") {
  const AsBuiltDrive drive = drive_of_pairs(21);
  const JudgedControl control = judged(drive);
  CHECK(control.contradicted.empty());
  REQUIRE(control.found.groups.size() == drive.control.size() / 2);
  for (std::size_t i = 0; i < control.found.groups.size(); ++i) {
    const ControlGroup& group = control.found.groups[i];
    CAPTURE(group.tags.front());
    CHECK(group.tags.size() == 2);
    CHECK(group.chi_square < 25);
    CHECK(group.shift < group.unnoticed);
    CHECK(group.unnoticed < 0.02);
  }
  // At the ends of the drive the others are on one side only.
  CHECK(control.found.groups.front().unnoticed > control.found.groups[1].unnoticed);
}

TEST_CASE("a control pair that is wrong together is named, whichever tag its photos strain") {
  for (const Eigen::Vector3d& wrong :
       {Eigen::Vector3d(0, 0.04, 0), Eigen::Vector3d(0, 0, 0.04), Eigen::Vector3d(0.04, 0, 0)}) {
    CAPTURE(wrong.transpose());
    AsBuiltDrive drive = drive_of_pairs(22);
    const std::vector<std::string> pair{drive.control[4], drive.control[5]};
    for (const std::string& name : pair) {
      drive.survey.tags[index_of(drive, name)].world_from_plate.translation += wrong;
    }
    const JudgedControl control = judged(drive);
    CHECK(control.contradicted == pair);
  }
}

TEST_CASE("a single control tag that is wrong is named beside no other") {
  AsBuiltDrive drive = drive_of_pairs(23);
  drive.survey.tags[index_of(drive, drive.control[4])].world_from_plate.translation.z() += 0.04;
  CHECK(judged(drive).contradicted == std::vector<std::string>{drive.control[4]});
}

TEST_CASE("two groups of control tags contradict each other: any may be wrong") {
  Draws draws(24);
  AsBuiltDrive drive = short_drive(draws);
  REQUIRE(drive.control.size() == 4);
  for (const std::size_t i : {2U, 3U}) {
    drive.survey.tags[index_of(drive, drive.control[i])].world_from_plate.translation.y() += 0.06;
  }
  CHECK(judged(drive).contradicted.size() == 4);
}

TEST_CASE("what nothing ties to a control tag is named") {
  Draws draws(4);
  AsBuiltDrive drive = short_drive(draws);
  // Photos of 009L and 010L by themselves, of 008R in no chain, of all others as they are.
  std::erase_if(drive.sighted, [](const SightedTag& tag) {
    return tag.tag == "010L" || tag.tag == "010R" || tag.tag == "009R" || tag.tag == "009L";
  });
  const auto corners = drive.sighted.front().seen;
  drive.sighted.push_back({"alone", 0, "009L", corners});
  drive.sighted.push_back({"apart", 0, "009R", corners});
  drive.sighted.push_back({"apart", 1, "010R", corners});
  const std::vector<std::string> control{"000L", "000R"};
  const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, control);
  REQUIRE_MESSAGE(found, found.error().message);
  CHECK(tag_of(*found, "009L").reason == "it was never seen together with another tag");
  CHECK(tag_of(*found, "009R").reason == "no chain of photos ties it to a control tag");
  CHECK(tag_of(*found, "009R").status == AsBuiltStatus::undetermined);
  CHECK(tag_of(*found, "000L").status == AsBuiltStatus::control);
  CHECK(tag_of(*found, "003L").status == AsBuiltStatus::adjusted);
}

TEST_CASE("a control tag that does not hang as surveyed is contradicted") {
  for (const double shift : {0.03, 2.0}) {
    CAPTURE(shift);
    Draws draws(5);
    AsBuiltDriveOptions options;
    options.pairs = 31;
    options.stations = 120;
    options.control_every = 4;
    AsBuiltDrive drive = as_built_drive(options, draws);
    for (PlacedTag& tag : drive.survey.tags) {
      if (tag.name == "015L") tag.world_from_plate.translation.y() += shift;
    }
    const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, drive.control);
    REQUIRE_MESSAGE(found, found.error().message);
    const AsBuiltTag wrong = tag_of(*found, "015L");
    CHECK(wrong.status == AsBuiltStatus::contradicted);
    CHECK(wrong.shift.y() == doctest::Approx(-shift).epsilon(0.3));
    CHECK(tag_of(*found, "000L").status == AsBuiltStatus::control);
  }
}

TEST_CASE("a pair of control tags that is too high is told by its direction") {
  // 0.1 m on 3.2 m: all tags could be tilted by 1.8 degrees, and each pair supports itself.
  Draws draws(8);
  AsBuiltDrive drive = short_drive(draws);
  const std::vector<std::string> control{"000L", "000R", "004L", "004R"};
  const auto is_contradicted = [&] {
    const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, control);
    return !found ||
           std::ranges::count(found->tags, AsBuiltStatus::contradicted, &AsBuiltTag::status) > 0 ||
           !found->cut_off.empty();
  };
  for (const std::string& name : control) {
    PlacedTag& tag = drive.survey.tags[index_of(drive, name)];
    tag.world_from_plate = drive.hung[index_of(drive, name)];
  }
  CHECK_FALSE(is_contradicted());
  for (int tenths = 1; tenths <= 4; ++tenths) {
    CAPTURE(tenths);
    for (const char* name : {"000L", "000R"}) {
      drive.survey.tags[index_of(drive, name)].world_from_plate.translation.z() += 0.1;
    }
    CHECK(is_contradicted());
  }
}

TEST_CASE("a control tag that no other one confirms hangs as surveyed, to the survey's sigma") {
  Draws draws(7);
  const AsBuiltDrive drive = short_drive(draws);
  const std::vector<std::string> control{"005L"};
  const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, control);
  REQUIRE_MESSAGE(found, found.error().message);
  const AsBuiltTag only = tag_of(*found, "005L");
  const PlacedTag& surveyed = drive.survey.tags[index_of(drive, "005L")];
  CHECK(only.status == AsBuiltStatus::control);
  CHECK(only.shift.norm() == 0);
  CHECK((only.world_from_plate.translation - surveyed.world_from_plate.translation).norm() == 0);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double variance = surveyed.sigma * surveyed.sigma;
    CHECK(only.covariance(axis, axis) / variance == doctest::Approx(1));
  }
  CHECK(only.survey_sigma == doctest::Approx(surveyed.sigma));  // it is what the file gets
}

TEST_CASE("a single control tag is contradicted by the others where these agree") {
  for (std::uint64_t seed = 11; seed < 17; ++seed) {
    CAPTURE(seed);
    Draws draws(seed);
    AsBuiltDrive drive = short_drive(draws, 4);
    const auto contradicted = [&] {
      return contradicted_by_others(drive.survey, drive.rig, drive.sighted, "005L");
    };
    CHECK_FALSE(contradicted());
    PlacedTag& control = drive.survey.tags[index_of(drive, "005L")];
    control.world_from_plate.translation.y() += 0.1;
    const auto moved = contradicted();
    REQUIRE(moved);
    CHECK(moved->shift.y() == doctest::Approx(-0.1).epsilon(0.4));
    // Others that were hung by eye tell less.
    for (PlacedTag& tag : drive.survey.tags) {
      if (tag.name != "005L") tag.world_from_plate.translation += draws.normals(0.3);
    }
    CHECK_FALSE(contradicted());
  }
}

TEST_CASE("without control tags in the photos nothing is adjusted") {
  Draws draws(6);
  const AsBuiltDrive drive = short_drive(draws);
  CHECK_FALSE(adjust_as_built(drive.survey, drive.rig, drive.sighted, {}));
  CHECK_FALSE(adjust_as_built(drive.survey, drive.rig, {}, drive.control));
}

}  // namespace tagsmith::detail::test
