// SPDX-License-Identifier: Apache-2.0
// Simulated fixes of the joint method, from corners on: are its covariances true, and does a wrong
// tag or range ever make a wrong position? Usage: bench_fixes [N] [SEED]
//
// Each draw stands the vehicle anywhere in a shipped survey, as far from level and from the center
// line as the rig says it may be; moves plates by the survey's sigma and cameras by a
// calibration's; finds the tags' corners with noise of a covariance like the reader's; and breaks
// tags and ranges.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/core.h>

#include "decoder/localize/joint_method.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tests/bench/fix_trial.hpp"
#include "tests/support/draws.hpp"

using namespace tagsmith::detail;
using bench::corners_in_image;
using bench::noisy;
using bench::PoseError;
using bench::Site;
using Eigen::Vector3d;
using test::disturbed;
using test::Draws;
using test::small_turn;

namespace {

constexpr double kWrongTag = 0.03;    // probability of each tag
constexpr double kGrossRange = 0.05;  // of each range
constexpr double kNoRange = 0.2;

// Where a plate with this code really hangs when something went wrong.
Pose wrong_place(const Survey& survey, const PlacedTag& tag, Draws& draws) {
  if (draws.chance(0.5)) {
    for (;;) {  // swapped with another
      const PlacedTag& other = survey.tags[draws.index(survey.tags.size())];
      if (other.name != tag.name) return other.world_from_plate;
    }
  }
  Pose pose = tag.world_from_plate;  // rehung, or its place written down wrongly
  const double away = std::exp(draws.uniform(std::log(0.05), std::log(1.0)));
  const double angle = draws.uniform(-3.14, 3.14);
  pose.translation +=
      away * (std::cos(angle) * pose.rotation.col(0) + std::sin(angle) * pose.rotation.col(1));
  return pose;
}

struct Draw {
  VehiclePose truth;
  Observation observation;
  int wrong_tags = 0;
  bool gross_range = false;
};

Draw draw_from(const Site& site, Draws& draws) {
  Draw draw;
  draw.truth = bench::random_pose(site, draws);
  const Rig rig = disturbed(site.rig, draws);
  for (const PlacedTag& tag : site.survey.tags) {
    const bool wrong = draws.chance(kWrongTag);
    Pose hung = wrong ? wrong_place(site.survey, tag, draws) : tag.world_from_plate;
    hung.translation += draws.normals(site.survey.sigma);
    hung.rotation *= small_turn(draws, site.survey.angle_sigma);
    for (const RigCamera& camera : rig.cameras) {
      const auto corners = corners_in_image(camera, draw.truth, hung, site.survey.tag_template);
      if (!corners) continue;
      draw.observation.tags.push_back({camera.name, 0, tag, noisy(*corners, draws), {}});
      draw.wrong_tags += wrong ? 1 : 0;
    }
  }
  for (const RigRange& range : site.rig.ranges) {
    if (draws.chance(kNoRange)) continue;
    double distance =
        bench::true_range(site, range, draw.truth.position) + draws.normal(range.sigma);
    if (draws.chance(kGrossRange)) {
      distance = draws.uniform(range.min, range.max);
      draw.gross_range = true;
    }
    draw.observation.ranges[range.name] = distance;
  }
  return draw;
}

// What a kind of draws came to.
struct Tally {
  int draws = 0;
  int located = 0;
  int beyond_five = 0;
  int in_ellipse = 0;
  double nees_position = 0;
  double nees_pose = 0;
  double greatest = 0;  // error in standard deviations, any coordinate
};

void count(Tally& tally, const Fix& fix, const VehiclePose& truth, const Grid& grid) {
  ++tally.draws;
  if (!fix.position_in_grid) return;
  ++tally.located;
  const PoseError e = bench::error_of(fix, truth, grid);
  const Vector3d position = e.error.head<3>();
  const Eigen::Matrix3d covariance = e.covariance.topLeftCorner<3, 3>();
  const Eigen::Vector2d plane = position.head<2>();
  const double d2 = plane.dot(covariance.topLeftCorner<2, 2>().ldlt().solve(plane));
  if (d2 < 5.991) ++tally.in_ellipse;  // chi-square, 2 degrees, 95 %
  tally.nees_position += position.dot(covariance.ldlt().solve(position)) / 3;
  tally.nees_pose += e.error.dot(e.covariance.ldlt().solve(e.error)) / 6;
  const double most = e.greatest_sigmas();
  tally.greatest = std::max(tally.greatest, most);
  if (most > 5) ++tally.beyond_five;
}

void print(const std::string& name, const Tally& tally) {
  const double n = std::max(1, tally.located);
  fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.1f} % | {} | {:.1f} |\n", name, tally.draws,
             tally.located, tally.nees_position / n, tally.nees_pose / n,
             100 * tally.in_ellipse / n, tally.beyond_five, tally.greatest);
}

std::string kind_of(const Draw& draw) {
  const std::size_t tags = draw.observation.tags.size();
  std::string kind = tags == 1 ? "1 tag" : tags == 2 ? "2 tags" : "3 tags and more";
  const auto wrong = static_cast<std::size_t>(draw.wrong_tags);
  if (wrong == 0) return kind + ", all right";
  if (wrong == tags) return kind + ", all of them wrong";
  return kind + ", " + (wrong == 1 ? "one" : "several") + " wrong";
}

// The first words of a reason, up to what differs from case to case.
std::string kind_of_reason(const std::string& reason) {
  return reason.substr(0, reason.find_first_of(":(0123456789"));
}

}  // namespace

int main(int argc, char** argv) {
  const int count_wanted = argc > 1 ? std::atoi(argv[1]) : 10'000;
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::vector<Site> sites;
  for (const char* name : {"corridor", "curved"}) {
    Result<Site> site = bench::calibrated_site(name);
    if (!site) {
      fmt::print(stderr, "{}\n", site.error().message);
      return 2;
    }
    sites.push_back(std::move(*site));
  }
  Draws draws(seed);
  std::map<std::string, Tally> tallies;
  std::map<std::string, int> reasons;
  std::vector<double> times;
  Tally all;
  Tally confirmed;
  Tally unconfirmed;
  int gross = 0;
  int gross_used = 0;
  while (all.draws < count_wanted) {
    const Site& site = sites[draws.index(sites.size())];
    const Draw draw = draw_from(site, draws);
    if (draw.observation.tags.empty()) continue;
    const std::vector<Survey> surveys{site.survey};
    const std::clock_t start = std::clock();
    const Fix fix = localize_jointly(draw.observation, surveys, site.rig);
    times.push_back(1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    const std::string kind = kind_of(draw);
    count(tallies[kind], fix, draw.truth, site.survey.grid);
    // Nothing in the measurements tells when no right tag is seen.
    if (kind.find("all of them") == std::string::npos) {
      count(all, fix, draw.truth, site.survey.grid);
    }
    count(fix.confirmations > 0 ? confirmed : unconfirmed, fix, draw.truth, site.survey.grid);
    if (!fix.position_in_grid) ++reasons[kind_of_reason(fix.reason)];
    if (draw.gross_range && fix.position_in_grid) {
      ++gross;
      gross_used += fix.ranges.empty() ? 0 : 1;
    }
  }
  fmt::print(
      "| what was seen | draws | located | NEES/3 | NEES/6 of the pose | in the 95 % ellipse "
      "| beyond 5 sigma | greatest, sigma |\n|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, tally] : tallies) print(name, tally);
  print("all with a right tag", all);
  print("any, confirmed by a second tag", confirmed);
  print("any, by one tag or not located", unconfirmed);
  fmt::print("\nno position:\n");
  for (const auto& [reason, times_said] : reasons) fmt::print("  {:5} {}\n", times_said, reason);
  fmt::print("gross ranges: {}, used: {}\n", gross, gross_used);
  std::ranges::sort(times);
  fmt::print("processor time of a fix: median {:.0f} us, 99 % {:.0f} us\n", times[times.size() / 2],
             times[times.size() * 99 / 100]);
  return 0;
}
