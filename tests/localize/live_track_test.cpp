// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/live_track.hpp"

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

Fix fix_at(double y, std::vector<std::string> tags) {
  Fix fix;
  fix.id = "x";
  fix.method = "joint";
  fix.survey = "corridor";
  fix.position_in_grid = Eigen::Vector3d(1, y, 0.24);
  fix.attitude = Attitude{};
  fix.pose_covariance_in_grid = 1e-6 * PoseCovariance::Identity();
  fix.covariance_in_grid = fix.pose_covariance_in_grid->topLeftCorner<3, 3>();
  if (tags.size() == 1) fix.notes = {kOneTagOnly};
  fix.confirmations = static_cast<int>(tags.size()) - 1;
  fix.tags = std::move(tags);
  return fix;
}

std::vector<Survey> corridor() {
  auto survey = load_survey("surveys/corridor/survey.yaml");
  REQUIRE(survey.has_value());
  survey->name = "corridor";
  return {*survey};
}

bool is_noted(const Fix& fix, const std::string& note) {
  return std::ranges::any_of(fix.notes,
                             [&](const std::string& text) { return text.find(note) == 0; });
}

// Half a metre a second, seen every tenth, ending at y = 1.5, t = 1.
std::optional<LiveTrack> driven() {
  std::optional<LiveTrack> track;
  for (int i = 0; i <= 10; ++i) {
    const Fix fix = follow_track(track, fix_at(1 + 0.05 * i, {"a", "b"}), 0.1 * i);
    CHECK(fix.position_in_grid.has_value());
    CHECK(fix.notes.empty());
  }
  return track;
}

}  // namespace

TEST_CASE("a lone tag that the motion contradicts gives no position, one that fits is confirmed") {
  std::optional<LiveTrack> track = driven();
  const Fix right = follow_track(track, fix_at(1.55, {"a"}), 1.1);
  CHECK(right.position_in_grid.has_value());
  CHECK(right.notes.empty());
  const Fix wrong = follow_track(track, fix_at(1.9, {"a"}), 1.2);
  CHECK(!wrong.position_in_grid.has_value());
  CHECK(wrong.reason.find("the only tag, a, puts the vehicle 0.3") == 0);
  CHECK(wrong.survey == "corridor");
  // Refused again and again, and not remembered.
  CHECK(!follow_track(track, fix_at(1.95, {"a"}), 1.3).position_in_grid);
  CHECK(follow_track(track, fix_at(1.70, {"a"}), 1.4).position_in_grid);
  // Long after, nothing is known of the motion any more.
  const Fix later = follow_track(track, fix_at(4, {"a"}), 9);
  CHECK(later.position_in_grid.has_value());
  CHECK(is_noted(later, kOneTagOnly));
}

TEST_CASE("only the motion by another tag, known well, confirms a lone tag") {
  std::optional<LiveTrack> track;
  for (int i = 0; i <= 10; ++i) {
    const Fix fix = follow_track(track, fix_at(1 + 0.05 * i, {"a"}), 0.1 * i);
    CHECK(fix.confirmations == 0);
    CHECK(is_noted(fix, kOneTagOnly));
  }
  const Fix other = follow_track(track, fix_at(1.55, {"b"}), 1.1);
  CHECK(other.confirmations == 1);
  CHECK_FALSE(is_noted(other, kOneTagOnly));
  const Fix first = follow_track(track, fix_at(1.60, {"a"}), 1.2);
  CHECK(first.confirmations == 1);
  // Two seconds later the vehicle may be a metre off: a plate that is agrees with that.
  const Fix late = follow_track(track, fix_at(2.60, {"c"}), 3.2);
  CHECK(late.position_in_grid.has_value());
  CHECK(late.confirmations == 0);
  CHECK(is_noted(late, kOneTagOnly));
}

TEST_CASE("tags that were seen together confirm a later position by one of them") {
  std::optional<LiveTrack> track;
  follow_track(track, fix_at(0.95, {"c"}), -0.1);
  for (int i = 0; i <= 10; ++i) {
    follow_track(track, fix_at(1 + 0.05 * i, {"a", "b"}), 0.1 * i);
  }
  // Two seconds later the motion is not known well enough to confirm anything.
  std::optional<LiveTrack> other = track;
  CHECK(follow_track(other, fix_at(2.5, {"c"}), 3).confirmations == 0);
  CHECK(follow_track(track, fix_at(2.5, {"a"}), 3).confirmations == 1);
}

TEST_CASE("a wrong plate is not confirmed by its own earlier fixes, however often it is seen") {
  for (const double off : {0.05, 0.1, 0.2, 0.4}) {
    CAPTURE(off);
    std::optional<LiveTrack> track;
    for (int i = 0; i < 60; ++i) {
      // Fifteen by a right plate, then one that hangs off along the wall.
      const bool right = i < 15;
      const double y = 1 + 0.05 * i + (right ? 0 : off);
      const Fix fix = follow_track(track, fix_at(y, {right ? "a" : "wrong"}), 0.1 * i);
      CHECK(fix.confirmations == 0);
      if (!right && off > 0.15) CHECK_FALSE(fix.position_in_grid.has_value());
    }
  }
}

TEST_CASE("a track goes on from survey to survey, in which tags of one name are different tags") {
  std::optional<LiveTrack> track;
  const auto confirmations = [&](int step, const char* survey, const char* tag) {
    Fix fix = fix_at(1 + 0.05 * step, {tag});
    fix.survey = survey;
    return follow_track(track, fix, 0.1 * step).confirmations;
  };
  for (int i = 0; i <= 10; ++i) CHECK(confirmations(i, "corridor", "a") == 0);
  // The same tag, seen from the other survey's tunnel, confirms nothing; another one does.
  CHECK(confirmations(11, "beyond", "corridor/a") == 0);
  CHECK(track->used == 12);
  CHECK(confirmations(12, "beyond", "a") == 1);
  CHECK(confirmations(13, "corridor", "a") == 1);
}

TEST_CASE("a time that runs backwards begins a new track and is noted") {
  std::optional<LiveTrack> track = driven();
  const Fix fix = follow_track(track, fix_at(1.2, {"a"}), 0.4);
  CHECK(fix.position_in_grid.has_value());
  CHECK(is_noted(fix, "time 0.4 is not after the 1 of the position before"));
  CHECK(track->used == 1);
}

TEST_CASE("several tags against the motion begin a new track") {
  std::optional<LiveTrack> track = driven();
  const Fix fix = follow_track(track, fix_at(3, {"a", "b"}), 1.1);
  CHECK(fix.position_in_grid.has_value());
  CHECK(is_noted(fix, "not where the motion"));
  CHECK(track->used == 1);
  CHECK(track->estimate.mean[1] == doctest::Approx(3).epsilon(1e-6));
}

TEST_CASE("what was expected grows uncertain with time, and ends") {
  const std::vector<Survey> surveys = corridor();
  const std::optional<LiveTrack> track = driven();
  const auto soon = prior_at(*track, 1.05, surveys, {});
  const auto late = prior_at(*track, 2, surveys, {});
  REQUIRE(soon.has_value());
  REQUIRE(late.has_value());
  CHECK(soon->vehicle.position.y() == doctest::Approx(1.525).epsilon(1e-3));
  CHECK(soon->position_sigma < 0.02);
  CHECK(late->position_sigma > 5 * soon->position_sigma);
  CHECK(!prior_at(*track, 7, surveys, {}));
  CHECK(!prior_at(*track, 1, surveys, {}));  // no later than the last
}

TEST_CASE("images are read where the tags are expected as they are without") {
  const std::vector<Survey> surveys = corridor();
  const auto rig = load_rig("surveys/corridor/rig.yaml");
  REQUIRE(rig.has_value());
  const ReaderChoice reader{read_tags, kFittedCornerSigmaPx};
  const Pose truth = vehicle_in_tunnel(surveys[0], {0.9, 2.0, 0.24}, std::nullopt);
  PosePrior prior;
  prior.vehicle = vehicle_pose_of(truth);
  prior.vehicle.position += Eigen::Vector3d(0.004, -0.006, 0.002);
  prior.position_sigma = 0.005;
  prior.angle_sigma = 0.002;
  for (const RigCamera& camera : rig->cameras) {
    CHECK(expected_tags(prior, std::vector<Survey>{surveys[0], surveys[0]}, camera).size() ==
          2 * expected_tags(prior, surveys[0], camera).size());
    const SurveyView view = render_survey_view(surveys[0], camera, truth, {}, 5);
    CHECK(!expected_tags(prior, surveys[0], camera).empty());
    Observation with;
    Observation without;
    observe_image(with, camera, view.view.image.view(), "", surveys, reader, prior);
    observe_image(without, camera, view.view.image.view(), "", surveys, reader);
    REQUIRE(!without.tags.empty());
    for (const SeenTag& seen : without.tags) {
      const double size = distance(seen.seen_corners->corners[0], seen.seen_corners->corners[1]);
      const auto same = [&](const SeenTag& other) {
        return other.tag.name == seen.tag.name &&
               distance(other.seen_corners->corners[0], seen.seen_corners->corners[0]) < 0.05;
      };
      // Smaller ones are not worth expecting.
      if (size > 80) CHECK(std::ranges::any_of(with.tags, same));
    }
  }
  prior.position_sigma = 1;
  CHECK(expected_tags(prior, surveys[0], rig->cameras[0]).empty());
}

}  // namespace tagsmith::detail
