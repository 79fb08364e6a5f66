// SPDX-License-Identifier: Apache-2.0
// How long a plan takes: 1 km at 1 cm steps, 5 lateral offsets, 5 headings, a tag a metre; and how
// that grows with the length. Part of `./dev bench`.
#include <benchmark/benchmark.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tests/placement/corridors.hpp"

namespace tagsmith::detail {
namespace {

// A tag a metre; bends of 50 m radius make up a part of the drive when it is not straight.
Survey long_survey(double length, bool is_straight) {
  Survey survey;
  survey.name = "long";
  survey.tunnel.left = -1.5;
  survey.tunnel.right = 1.5;
  survey.tunnel.height = 3;
  std::vector<CenterlineElement> elements;
  for (int hundred = 0; 100 * hundred < length; ++hundred) {
    elements.push_back({60, 0, 0});
    elements.push_back({40, is_straight ? 0 : (elements.size() % 4 == 1 ? 0.02 : -0.02), 0});
  }
  survey.tunnel.centerline = Centerline({0, 0, 0}, 0, elements);
  survey.tag_template = test::corridor_template();
  survey.sigma = 0.002;
  survey.series = TagSeries{0.9, 1.6, 0.1, static_cast<int>(length / 2), std::nullopt};
  for (int pair = 0; pair < survey.series->pairs; ++pair) {
    survey.tags.push_back(place_in_series(survey, pair, Side::left));
    survey.tags.push_back(place_in_series(survey, pair, Side::right));
  }
  return survey;
}

// The crawler of the paper on a taller vehicle that sways.
Rig two_cameras() {
  Rig rig = test::crawler();
  rig.vehicle_height = 0.8;
  rig.envelope = VehicleEnvelope{0.4, radians(8), 0, 0, 0};
  return rig;
}

// The same with lenses that distort as wide ones of mine vehicles do.
Rig two_distorting_cameras() {
  Rig rig = two_cameras();
  for (RigCamera& camera : rig.cameras) {
    camera.camera.distortion = {-0.28, 0.09, 0.0007, -0.0005, -0.013};
  }
  return rig;
}

void plan(benchmark::State& state, const Rig& rig, bool is_straight, bool accuracy) {
  const Survey survey = long_survey(static_cast<double>(state.range(0)), is_straight);
  PlanOptions options;
  options.step = 0.01;
  options.accuracy = accuracy;
  std::size_t poses = 0;
  for ([[maybe_unused]] const auto _ : state) {
    const Result<DrivePlan> planned = plan_drive(survey, rig, options);
    if (!planned) return state.SkipWithError(planned.error().message.c_str());
    poses = planned->columns.size() * static_cast<std::size_t>(planned->poses_per_column);
  }
  state.counters["poses"] = static_cast<double>(poses);
  state.counters["tags"] = static_cast<double>(survey.tags.size());
  state.SetComplexityN(state.range(0));
}

void plan_straight_metres(benchmark::State& state) { plan(state, two_cameras(), true, true); }
BENCHMARK(plan_straight_metres)
    ->RangeMultiplier(2)
    ->Range(125, 4000)
    ->Arg(1000)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);

void plan_bends_metres(benchmark::State& state) { plan(state, two_cameras(), false, true); }
BENCHMARK(plan_bends_metres)->Arg(1000)->UseRealTime()->Unit(benchmark::kMillisecond);

void plan_distorted_metres(benchmark::State& state) {
  plan(state, two_distorting_cameras(), true, true);
}
BENCHMARK(plan_distorted_metres)->Arg(1000)->UseRealTime()->Unit(benchmark::kMillisecond);

void plan_sight_alone_metres(benchmark::State& state) { plan(state, two_cameras(), true, false); }
BENCHMARK(plan_sight_alone_metres)->Arg(1000)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tagsmith::detail
