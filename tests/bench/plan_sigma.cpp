// SPDX-License-Identifier: Apache-2.0
// Does the localizer scatter as a plan says? Poses drawn at random over a plan, corners, ranges,
// plates and cameras off by the sigmas that the plan assumes; each is localized, and the errors are
// set against the plan's covariance. The same for the paper's method.
// Usage: bench_plan_sigma [POSES [SURVEY RIG]...]
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/paper_method.hpp"
#include "tagsmith/paper_plan/expected_by_paper.hpp"
#include "tests/bench/bench_site.hpp"
#include "tests/support/plan_trial.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using bench::Site;

namespace {

struct Joint {
  TrialTally all;
  std::map<std::size_t, TrialTally> by_tags;  // 1, 2, and 3 for more
  TrialTally stated;                          // by the localizer's own covariances
  std::map<std::string, int> refusals;
};

std::size_t count_tags(const PlanTrial& trial) {
  std::vector<std::size_t> tags;
  for (const PlateSight& sight : trial.sights) {
    if (std::ranges::find(tags, sight.tag) == tags.end()) tags.push_back(sight.tag);
  }
  return std::min<std::size_t>(tags.size(), 3);
}

// The first words of a reason, up to what differs from case to case.
std::string kind_of(const std::string& reason) {
  return reason.substr(0, reason.find_first_of(":(0123456789"));
}

Joint try_joint(const SightModel& model, const TrialPoses& poses, int count_wanted) {
  Joint joint;
  Draws draws(7);
  AccuracyOptions options;
  options.speed = model.rig().envelope ? model.rig().envelope->speed : 0;
  const std::vector<Survey> surveys{model.survey()};
  while (joint.all.expected < count_wanted && joint.all.trials < 20 * count_wanted) {
    ++joint.all.trials;
    const PlanTrial trial = draw_trial(model, poses, options, draws);
    if (trial.sights.empty()) continue;
    const auto expected = expected_covariance(model, trial, options);
    if (!expected) continue;
    TrialTally& kind = joint.by_tags[count_tags(trial)];
    ++joint.all.expected;
    ++kind.expected;
    const Fix fix = localize_jointly(trial.observation, surveys, model.rig());
    if (!fix.position_in_grid) {
      ++joint.refusals[kind_of(fix.reason)];
      continue;
    }
    const auto error = error_in_world(fix, trial.truth, model.survey().grid);
    count(joint.all, error, *expected, trial.floor.heading);
    count(kind, error, *expected, trial.floor.heading);
    VehicleCovariance stated = *fix.pose_covariance_in_grid;
    Eigen::Matrix<double, 6, 1> signs = Eigen::Matrix<double, 6, 1>::Ones();
    signs.head<3>() = world_from_grid(model.survey().grid, Eigen::Vector3d::Ones());
    signs[vehicle_parameter::kHeading] = world_heading_from_grid(model.survey().grid, 1);
    stated = signs.asDiagonal() * stated * signs.asDiagonal();
    count(joint.stated, error, stated, trial.floor.heading);
  }
  return joint;
}

void print(const std::string& name, const std::string& what, const TrialTally& tally) {
  fmt::print("| {} | {} | {} of {} |", name, what, tally.located, tally.expected);
  for (const double ratio : tally.ratios()) fmt::print(" {:.2f} |", ratio);
  const double n = std::max(1, tally.located);
  fmt::print(" {:.2f} | {:.2f} | {:.1f} % |\n", tally.nees_position / n, tally.nees_pose / n,
             100 * tally.in_ellipse / n);
}

void print(const std::string& name, const Joint& joint) {
  print(name, "all", joint.all);
  for (const auto& [tags, tally] : joint.by_tags) {
    print(name, tags == 1 ? "1 tag" : tags == 2 ? "2 tags" : "3 tags and more", tally);
  }
  TrialTally stated = joint.stated;
  stated.expected = joint.all.expected;
  print(name, "by the fix's own covariance", stated);
  for (const auto& [reason, times] : joint.refusals) fmt::print("<!-- {} {} -->\n", times, reason);
  std::fflush(stdout);
}

// Observed against expected, of the paper's method.
struct Paper {
  int pairs = 0;
  int located = 0;
  int compared = 0;                                    // of these, with errors expected
  double no_solution = 0;                              // expected share, summed
  double magnification = 0;                            // summed
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();   // of errors along, across, z
  Eigen::Vector3d expected = Eigen::Vector3d::Zero();  // likewise
};

Paper try_paper(const SightModel& model, TrialPoses poses, int count_wanted) {
  poses.tilts = false;  // the method takes the cameras to be level
  Paper paper;
  Draws draws(8);
  const std::vector<Survey> surveys{model.survey()};
  int trials = 0;
  while (paper.pairs < count_wanted && trials < 20 * count_wanted) {
    ++trials;
    const PlanTrial trial = draw_trial(model, poses, {}, draws);
    const auto expected =
        expect_by_paper(model.survey(), model.rig(), trial.truth, trial.sights, {});
    if (!expected) continue;
    ++paper.pairs;
    paper.no_solution += expected->no_solution_share;
    paper.magnification += expected->magnification;
    const Fix fix = localize_by_paper(trial.observation, surveys, model.rig());
    if (!fix.position_in_grid) continue;
    ++paper.located;
    const Eigen::Vector3d along = direction_of(trial.floor.heading);
    const Eigen::Vector3d across = right_of(trial.floor.heading);
    const Eigen::Vector3d error = error_in_world(fix, trial.truth, model.survey().grid).head<3>();
    if (!expected->mean_square.allFinite()) continue;
    ++paper.compared;
    paper.squares += Eigen::Vector3d(along.dot(error), across.dot(error), error.z()).cwiseAbs2();
    paper.expected +=
        Eigen::Vector3d(along.dot(expected->mean_square * along),
                        across.dot(expected->mean_square * across), expected->mean_square(2, 2));
  }
  return paper;
}

void print(const std::string& name, const std::string& what, const Paper& paper) {
  if (paper.compared == 0) return;
  const double n = paper.compared;
  const Eigen::Vector3d observed = 1000 * (paper.squares / n).cwiseSqrt();
  const Eigen::Vector3d expected = 1000 * (paper.expected / n).cwiseSqrt();
  fmt::print("| {} | {} | {} | {:.2f} |", name, what, paper.pairs,
             paper.magnification / paper.pairs);
  for (Eigen::Index i = 0; i < 3; ++i) {
    fmt::print(" {:.1f} / {:.1f} = {:.2f} |", observed[i], expected[i], observed[i] / expected[i]);
  }
  fmt::print(" {:.1f} / {:.1f} % |\n", 100.0 * (paper.pairs - paper.located) / paper.pairs,
             100 * paper.no_solution / paper.pairs);
  std::fflush(stdout);
}

// The same site with a range sensor this good.
Rig with_range_sigma(Rig rig, double sigma) {
  for (RigRange& range : rig.ranges) range.sigma = sigma;
  return rig;
}

TrialPoses all_along(const Survey& survey) { return {0, survey.tunnel.centerline.length(), true}; }

}  // namespace

int main(int argc, char** argv) {
  const int poses = argc > 1 ? std::atoi(argv[1]) : 1000;
  std::vector<std::string> files(argv + std::min(argc, 2), argv + argc);
  if (poses < 1 || files.size() % 2 != 0) {
    fmt::print(stderr, "usage: bench_plan_sigma [POSES [SURVEY RIG]...]\n");
    return 2;
  }
  if (files.empty()) {
    for (const char* folder : {"surveys/corridor", "surveys/curved", "tests/bench/decline"}) {
      files.push_back(std::string(folder) + "/survey.yaml");
      files.push_back(std::string(folder) + "/rig.yaml");
    }
  }
  std::vector<Site> sites;
  for (std::size_t i = 0; i + 1 < files.size(); i += 2) {
    Result<Site> site = bench::load_site(files[i], files[i + 1]);
    if (!site) {
      fmt::print(stderr, "{}\n", site.error().message);
      return 2;
    }
    sites.push_back(std::move(*site));
  }
  fmt::print(
      "Joint method: observed over expected standard deviations\n\n"
      "| survey | what was seen | located | along | across | z | heading | pitch | roll | NEES/3 | "
      "NEES/6 | in the 95 % ellipse |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Site& site : sites) {
    print(site.survey.name, try_joint({site.survey, site.rig}, all_along(site.survey), poses));
  }
  fmt::print(
      "\nThe paper's method: observed / expected errors, mm, and measurements without solution\n\n"
      "| survey | d's sigma | poses | 1/tan(theta) | along | across | z | no solution |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const Site& site : sites) {
    for (const double sigma : {0.001, 0.003, 0.01}) {
      const Rig rig = with_range_sigma(site.rig, sigma);
      print(site.survey.name, fmt::format("{:.0f} mm", 1000 * sigma),
            try_paper({site.survey, rig}, all_along(site.survey), poses));
    }
  }
  return 0;
}
