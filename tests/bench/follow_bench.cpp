// SPDX-License-Identifier: Apache-2.0
// From two loaded images to a position: cold, and with the position from the motion. Runs from the
// project root: `./dev bench two_images`.
#include <algorithm>
#include <cstddef>
#include <ctime>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/live_track.hpp"
#include "decoder/localize/localize_images.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

struct Scene {
  std::vector<Survey> surveys;
  Rig rig;
  std::vector<std::vector<GrayImage>> images;  // of each measurement, in the order of the cameras
};

std::optional<Scene> load_scene() {
  auto survey = load_survey("surveys/corridor/survey.yaml");
  auto rig = load_rig("surveys/corridor/rig.yaml");
  if (!survey || !rig) return std::nullopt;
  const auto run = load_run("surveys/corridor/run.csv", *rig);
  if (!run) return std::nullopt;
  Scene scene{{std::move(*survey)}, std::move(*rig), {}};
  for (const Measurement& measurement : run->measurements) {
    std::vector<GrayImage> images;
    for (const RigCamera& camera : scene.rig.cameras) {
      auto image = load_gray_image(measurement.cameras.at(camera.name).image);
      if (!image) return std::nullopt;
      images.push_back(std::move(*image));
    }
    scene.images.push_back(std::move(images));
  }
  return scene;
}

Fix locate_in(const Scene& scene, std::size_t index, const std::optional<PosePrior>& prior) {
  std::vector<CameraImage> images;
  for (std::size_t c = 0; c < scene.rig.cameras.size(); ++c) {
    images.push_back({&scene.rig.cameras[c], scene.images[index][c].view(), ""});
  }
  Observation seen;
  return localize_images(seen, images, scene.surveys, scene.rig, prior);
}

// Where the motion puts the vehicle: a centimetre and a quarter of a degree from where it is.
PosePrior prior_near(const Scene& scene, const Fix& fix) {
  const Grid& grid = scene.surveys.front().grid;
  PosePrior prior;
  prior.vehicle.position = world_from_grid(grid, *fix.position_in_grid);
  prior.vehicle.position += Eigen::Vector3d(0.006, 0.008, 0);
  prior.vehicle.heading = world_heading_from_grid(grid, fix.attitude->heading) + 0.004;
  prior.position_sigma = 0.01;
  prior.angle_sigma = 0.005;
  return prior;
}

// Each iteration is the next of the ten points; p50 and p99 over all of them, in processor time,
// which other work on the machine disturbs less.
void two_images_to_position(benchmark::State& state, bool with_prior) {
  const auto scene = load_scene();
  if (!scene) return state.SkipWithError("the shipped corridor cannot be loaded");
  std::vector<std::optional<PosePrior>> priors(scene->images.size());
  for (std::size_t i = 0; i < priors.size() && with_prior; ++i) {
    const Fix fix = locate_in(*scene, i, std::nullopt);
    if (!fix.position_in_grid) return state.SkipWithError("a point is not located");
    priors[i] = prior_near(*scene, fix);
  }
  std::vector<double> times;
  std::size_t located = 0;
  for ([[maybe_unused]] const auto _ : state) {
    const std::size_t i = times.size() % priors.size();
    const std::clock_t begin = std::clock();
    const Fix fix = locate_in(*scene, i, priors[i]);
    const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    located += fix.position_in_grid ? 1 : 0;
    state.SetIterationTime(took);
    times.push_back(1e3 * took);
  }
  std::ranges::sort(times);
  state.counters["located"] = static_cast<double>(located) / static_cast<double>(times.size());
  state.counters["least_ms"] = times.front();
  state.counters["p50_ms"] = times[times.size() / 2];
  state.counters["p99_ms"] = times[times.size() * 99 / 100];
}

void two_images_cold(benchmark::State& state) { two_images_to_position(state, false); }
BENCHMARK(two_images_cold)->Unit(benchmark::kMillisecond)->UseManualTime()->MinTime(4);

void two_images_with_prior(benchmark::State& state) { two_images_to_position(state, true); }
BENCHMARK(two_images_with_prior)->Unit(benchmark::kMillisecond)->UseManualTime()->MinTime(4);

}  // namespace
}  // namespace tagsmith::detail
