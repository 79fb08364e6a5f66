// SPDX-License-Identifier: Apache-2.0
// Is a tag found that does not hang where the survey has it? Usage: bench_displaced [ROWS] [SEED]
//
// The survey's place of one tag at a time is moved by 30 mm along the wall, up or down, into or out
// of it, or turned by 5 degrees, or its frame printed smaller, and the same pictures are checked
// against it: the shipped runs, and rendered ones of ROWS places. All its places are off by the
// survey's standard deviation, too. Last the survey with no more than that, for false alarms, and
// with plates hung by eye. With a SEED other than 0 pictures and surveys are others than those that
// constants were chosen on.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/plates/hung_tags.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/run.hpp"
#include "tests/bench/bench_site.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;

namespace {

struct PictureSet {
  std::string name;
  Survey survey;
  Rig rig;
  std::vector<SightedTag> sighted;
};

void add_seen(PictureSet& set, const std::string& station, const Observation& observation) {
  for (const SeenTag& seen : observation.tags) {
    const auto camera = std::ranges::find(set.rig.cameras, seen.camera, &RigCamera::name);
    set.sighted.push_back({station, static_cast<std::size_t>(camera - set.rig.cameras.begin()),
                           seen.tag.name, *seen.seen_corners});
  }
}

PictureSet load_set(const std::string& name) {
  bench::Site site = bench::load_shipped_site(name).value();
  return {name, std::move(site.survey), std::move(site.rig), {}};
}

PictureSet shipped(const std::string& name) {
  PictureSet set = load_set(name);
  set.name += ", shipped run";
  const std::vector<Survey> surveys{set.survey};
  const Run run = load_run("surveys/" + name + "/run.csv", set.rig).value();
  for (const Measurement& row : run.measurements) {
    add_seen(set, row.id, observe(row, surveys, set.rig, {read_tags}));
  }
  return set;
}

double normal(std::mt19937_64& random, double sigma) {
  return sigma * std::normal_distribution<double>()(random);
}

// A vehicle anywhere before the tags, as far from level and from the middle as rigs allow for.
Pose random_vehicle(const PictureSet& set, std::mt19937_64& random) {
  const Centerline& line = set.survey.tunnel.centerline;
  const double to = set.survey.tags.back().chainage;
  const auto chainage = std::uniform_real_distribution<double>(-0.5, to - 0.5)(random);
  const CenterlinePoint at = line.at(chainage);
  VehiclePose pose;
  pose.position =
      at.position + normal(random, 0.1 * least_width(set.survey.tunnel)) * right_of(at.heading);
  pose.position.z() += set.rig.vehicle_height + normal(random, 0.01);
  pose.heading = at.heading + normal(random, radians(3));
  pose.pitch = normal(random, radians(1));
  pose.roll = normal(random, radians(1));
  return world_from_vehicle(pose);
}

void render_rows(PictureSet& set, int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<Survey> surveys{set.survey};
  for (int row = 0; row < rows; ++row) {
    const Pose vehicle = random_vehicle(set, random);
    Observation observation;
    for (const RigCamera& camera : set.rig.cameras) {
      ViewOptions options;
      options.lighting = tunnel_lighting();
      options.sensor.noise_sigma = 2;
      options.seed = random();
      const SurveyView seen = render_survey_view(set.survey, camera, vehicle, options, seed);
      observe_image(observation, camera, seen.view.image.view(), camera.name, surveys, {read_tags});
    }
    add_seen(set, fmt::format("{}", row), observation);
  }
}

PictureSet rendered(const std::string& name, int rows, std::uint64_t seed) {
  PictureSet set = load_set(name);
  set.name += fmt::format(", {} rendered rows", rows);
  render_rows(set, rows, seed);
  return set;
}

// Pictures of one camera that sees several tags, each picture by itself.
PictureSet single_pictures(int rows, std::uint64_t seed) {
  PictureSet set = load_set("corridor");
  set.name = fmt::format("corridor, {} rendered pictures of one wide camera, each alone", rows);
  RigCamera camera = set.rig.cameras[0];
  camera.camera = {1920, 1080, 1100, 1100, 959.5, 539.5};
  camera.vehicle_from_camera = vehicle_from_side_camera(Side::left, radians(50));
  set.rig.cameras = {camera};
  render_rows(set, rows, seed);
  return set;
}

struct Tally {
  int trials = 0;
  int named = 0;
  int in_doubt = 0;
  int missed = 0;
  int told_size = 0;  // named or in doubt, with the size that the frame may have
  // Trials, and of these found, by how many of its stated standard deviations a shift upwards of
  // 30 mm is: 0 to 1, ..., the last beyond.
  std::array<std::pair<int, int>, 6> by_sigmas{};
  int checked_others = 0;
  int accused_others = 0;
};

// True when the message holds against the tag itself that its frame has another size.
bool tells_size(const HungTag& tag) {
  if (tag.rule == "wrong-scale") return true;
  const auto own = tag.message.find("if it is " + tag.tag);
  if (own == std::string::npos) return false;
  return tag.message.substr(own, tag.message.find(';', own) - own).find("a frame of") !=
         std::string::npos;
}

void count(Tally& tally, const std::string& moved, const HungTags& result) {
  for (const HungTag& tag : result.tags) {
    if (tag.verdict == HangVerdict::unchecked) continue;
    if (tag.tag != moved) {
      ++tally.checked_others;
      if (tag.verdict == HangVerdict::off) ++tally.accused_others;
      if (tag.verdict == HangVerdict::doubtful &&
          std::ranges::find(tag.rivals, moved) == tag.rivals.end()) {
        ++tally.accused_others;
      }
      continue;
    }
    ++tally.trials;
    const double sigmas = 0.03 / std::max(tag.offset.sigma[1], 1e-4);
    const auto last = tally.by_sigmas.size() - 1;
    auto& bin = tally.by_sigmas[std::min(static_cast<std::size_t>(sigmas), last)];
    ++bin.first;
    if (tag.verdict != HangVerdict::fits) ++bin.second;
    if (tag.verdict == HangVerdict::off) ++tally.named;
    if (tells_size(tag)) ++tally.told_size;
    if (tag.verdict == HangVerdict::doubtful) ++tally.in_doubt;
    if (tag.verdict == HangVerdict::fits) ++tally.missed;
  }
}

struct Displacement {
  const char* name;
  Vector3d shift;  // plate axes
  double turn = 0;
  double angle_sigma = kLeastAngleSigma;  // of all plates
  double print_scale = 1;
};

Survey displaced(Survey survey, std::size_t tag, const Displacement& by) {
  Pose& pose = survey.tags[tag].world_from_plate;
  pose.translation += pose.rotation * by.shift;
  pose.rotation *= Eigen::AngleAxisd(by.turn, Vector3d::UnitZ()).toRotationMatrix();
  return survey;
}

void print(const std::string& set, const std::string& what, const Tally& tally) {
  const double n = std::max(1, tally.trials);
  fmt::print("| {} | {} | {} | {:.1f} % | {:.1f} % | {:.1f} % | {} of {} |\n", set, what,
             tally.trials, 100 * tally.named / n, 100 * tally.in_doubt / n, 100 * tally.missed / n,
             tally.accused_others, tally.checked_others);
}

// The tags as they are seen when one of them was printed at another scale: its frame about its
// middle, in the plane that its corners span.
std::vector<SightedTag> printed_at(std::vector<SightedTag> group, const std::string& name,
                                   double scale) {
  if (scale == 1) return group;
  for (SightedTag& tag : group) {
    if (tag.tag != name) continue;
    const Homography image_from_frame = homography_to(tag.seen.corners);
    const double low = 0.5 - scale / 2;
    const double high = 0.5 + scale / 2;
    tag.seen.corners = {image_from_frame(low, low), image_from_frame(high, low),
                        image_from_frame(high, high), image_from_frame(low, high)};
  }
  return group;
}

void print_share(const std::string& set, const std::string& what, const Tally& tally) {
  fmt::print("| {} | {} | {} | {:.1f} % | | | |\n", set, what, tally.trials,
             100.0 * tally.told_size / std::max(1, tally.trials));
}

void print_by_sigmas(const std::string& set, const Tally& tally) {
  for (std::size_t i = 0; i < tally.by_sigmas.size(); ++i) {
    const auto [trials, found] = tally.by_sigmas[i];
    if (trials == 0) continue;
    fmt::print("| {} | of these, 30 mm are {} stated sigmas and more | {} | found {} | | | |\n",
               set, i, trials, found);
  }
}

// The survey as a surveyor brings it: every place off by normal errors.
Survey surveyed(Survey survey, double angle_sigma, std::mt19937_64& random) {
  for (PlacedTag& tag : survey.tags) {
    Pose& pose = tag.world_from_plate;
    for (double& coordinate : pose.translation) coordinate += normal(random, survey.sigma);
    Vector3d turn;
    for (double& angle : turn) angle = normal(random, angle_sigma);
    pose.rotation *= Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  return survey;
}

using Groups = std::vector<std::vector<SightedTag>>;

void measure_false_alarms(const PictureSet& set, const Groups& groups, const char* what,
                          double angle_sigma, double stated_sigma, std::uint64_t seed) {
  constexpr int kDraws = 20;
  std::mt19937_64 random(seed);
  Tally none;
  for (int draw = 0; draw < kDraws; ++draw) {
    Survey survey = surveyed(set.survey, angle_sigma, random);
    survey.angle_sigma = stated_sigma;
    for (const auto& group : groups) count(none, "", check_hung_tags(survey, set.rig, group));
  }
  print(set.name, what, none);
}

void measure(const PictureSet& set, const Groups& groups, std::uint64_t seed) {
  const std::vector<Displacement> displacements{
      {"30 mm along the wall", {0.03, 0, 0}},
      {"30 mm back along it", {-0.03, 0, 0}},
      {"30 mm up", {0, -0.03, 0}},
      {"30 mm down", {0, 0.03, 0}},
      {"30 mm out of the wall", {0, 0, -0.03}},
      {"30 mm into the wall", {0, 0, 0.03}},
      {"turned 5 degrees", {0, 0, 0}, radians(5)},
      {"30 mm up, all plates tilted by 0.5 degrees", {0, -0.03, 0}, 0, radians(0.5)},
      {"printed at 99.5 %", {0, 0, 0}, 0, kLeastAngleSigma, 0.995},
      {"printed at 99 %", {0, 0, 0}, 0, kLeastAngleSigma, 0.99},
      {"printed at 98.5 %", {0, 0, 0}, 0, kLeastAngleSigma, 0.985},
      {"printed at 98 %", {0, 0, 0}, 0, kLeastAngleSigma, 0.98},
      {"printed at 97 %", {0, 0, 0}, 0, kLeastAngleSigma, 0.97},
      {"printed at 90 %", {0, 0, 0}, 0, kLeastAngleSigma, 0.9}};
  std::mt19937_64 random(seed + 5);
  for (const Displacement& by : displacements) {
    Tally tally;
    for (std::size_t i = 0; i < set.survey.tags.size(); ++i) {
      const Survey survey = displaced(surveyed(set.survey, by.angle_sigma, random), i, by);
      for (const auto& group : groups) {
        if (std::ranges::find(group, survey.tags[i].name, &SightedTag::tag) == group.end())
          continue;
        const auto seen = printed_at(group, survey.tags[i].name, by.print_scale);
        count(tally, survey.tags[i].name, check_hung_tags(survey, set.rig, seen));
      }
    }
    print(set.name, by.name, tally);
    if (by.angle_sigma > kLeastAngleSigma) print_by_sigmas(set.name, tally);
    if (by.print_scale != 1) {
      print_share(set.name, std::string(by.name) + ", told with its size", tally);
    }
  }
  measure_false_alarms(set, groups, "nothing", kLeastAngleSigma, 0, seed + 3);
  measure_false_alarms(set, groups, "nothing; plates tilted by 0.5 degrees, and it is stated",
                       radians(0.5), radians(0.5), seed + 3);
  measure_false_alarms(set, groups, "nothing; plates tilted by 0.5 degrees, not stated",
                       radians(0.5), 0, seed + 3);
}

// Each station's pictures apart, as one who verifies them one by one gets them.
Groups by_station(const std::vector<SightedTag>& sighted) {
  Groups groups;
  for (const SightedTag& seen : sighted) {
    if (groups.empty() || groups.back().front().station != seen.station) groups.emplace_back();
    groups.back().push_back(seen);
  }
  return groups;
}

}  // namespace

int main(int argc, char** argv) {
  const int rows = argc > 1 ? std::atoi(argv[1]) : 24;
  const std::uint64_t seed = argc > 2 ? 1000 * std::strtoull(argv[2], nullptr, 10) : 0;
  fmt::print(
      "| pictures | one tag is off by | trials | it is named | doubtful | missed | others "
      "accused |\n|---|---|---|---|---|---|---|\n");
  for (const char* name : {"corridor", "curved"}) {
    const PictureSet set = shipped(name);
    measure(set, {set.sighted}, seed);
  }
  const PictureSet run = rendered("corridor", rows, seed + 1);
  measure(run, {run.sighted}, seed);
  const PictureSet alone = single_pictures(rows, seed + 2);
  measure(alone, by_station(alone.sighted), seed);
  return 0;
}
