// SPDX-License-Identifier: Apache-2.0
// Tags seen through lenses that bend straight lines. Usage: bench_lens [N [POSITIONS]]
//
// First N simulated pictures a lens of one tag each, at the same places and sizes for every lens:
// what is read and how far the corners are off, with the camera unknown to the reader and known.
// Then so many positions a lens in the shipped corridor, a third of N when not said. N = 45 by
// default: every size five times.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/core.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/median.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/draws.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Draws;

namespace {

struct Lens {
  std::string name;
  Camera camera;
};

// A wide lens of 77 degrees across an image of 1280 x 960 when nothing bends, and fisheyes.
std::vector<Lens> lenses() {
  std::vector<Lens> all;
  for (const double k1 : {0.0, -0.1, -0.2, -0.28, -0.35}) {
    Camera camera{1280, 960, 800, 800, 639.5, 479.5};
    camera.distortion[0] = k1;
    camera.distortion[1] = 0.08 * (k1 / 0.28) * (k1 / 0.28);
    all.push_back({k1 == 0 ? "straight" : fmt::format("k1 = {:.2f}", k1), camera});
  }
  Camera tangential{1280, 960, 800, 800, 655.0, 468.0, {-0.28, 0.08, 0.001, -0.0015}};
  all.push_back({"k1 = -0.28, off centre", tangential});
  Camera fisheye{1280, 960, 620, 622, 645, 470, {-0.03, 0.01, -0.004, 0.0007}, LensModel::fisheye};
  all.push_back({"fisheye", fisheye});
  return all;
}

// --- single tags ---

struct Picture {
  Digits digits{};
  View view;
  double module_px = 0;
};

// A tag at a place anywhere in the image, its frame within it; nothing where it does not fit.
std::optional<ScenePlate> place_tag(const Camera& camera, const Digits& digits, double module_px,
                                    Draws& draws) {
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), digits);
  const double half_width = 55 * module_px, half_height = 35 * module_px;
  const Vector2d pixel(draws.uniform(half_width, camera.width - half_width),
                       draws.uniform(half_height, camera.height - half_height));
  const double yaw = radians(draws.uniform(-45, 45));
  const double pitch = radians(draws.uniform(-20, 20));
  const double roll = radians(draws.uniform(-15, 15));
  double away = camera.fx * plate.drawing.module / module_px;
  for (int i = 0; i < 6; ++i) {
    plate.camera_from_plate =
        camera_from_turned_plate(camera, plate.drawing, pixel, away, yaw, pitch, roll);
    const PlateTruth truth = plate_truths(camera, std::span(&plate, 1)).front();
    if (truth.module_px <= 0) return std::nullopt;
    away *= truth.module_px / module_px;
  }
  const PlateTruth truth = plate_truths(camera, std::span(&plate, 1)).front();
  if (truth.visible_fraction < 1 || radians(60) < truth.incidence) return std::nullopt;
  return plate;
}

Digits random_code(Draws& draws) {
  Digits digits{};
  for (auto& digit : digits) digit = static_cast<std::uint8_t>(draws.index(10));
  digits.back() = check_digit(CheckDigit::sum10, std::span(digits).first<11>());
  return digits;
}

constexpr double kSizes[] = {0.7, 0.9, 1.2, 1.6, 2, 3, 4, 5, 6};

Picture take_picture(const Camera& camera, std::size_t index) {
  Draws draws(index + 1);
  Picture picture;
  picture.digits = random_code(draws);
  picture.module_px = kSizes[index % std::size(kSizes)];
  std::optional<ScenePlate> plate;
  while (!plate) plate = place_tag(camera, picture.digits, picture.module_px, draws);
  ViewOptions options;
  options.sensor.blur_sigma_px = 0.4;
  options.sensor.noise_sigma = 1.5;
  options.sensor.exposure = 0.85;
  options.seed = index;
  picture.view = render_view(camera, std::span(&*plate, 1), options);
  return picture;
}

struct Score {
  int asked = 0;
  int read = 0;
  int wrong = 0;
  std::vector<double> errors;       // of each corner's coordinate, pixels, absolute
  std::vector<double> chi_squares;  // of each tag's corners by their covariance, over 8

  void add(const Picture& picture, const ReadResult& result) {
    ++asked;
    for (const Reading& reading : result.tags) {
      if (reading.digits != picture.digits) {
        ++wrong;
        continue;
      }
      ++read;
      const auto fit = bench::corner_fit(reading, bench::corners_of(picture.view.plates.front()));
      for (const double value : fit.error) errors.push_back(std::abs(value));
      chi_squares.push_back(fit.chi_square);
    }
  }
};

void print(const std::string& lens, const std::string& sizes, const std::string& camera,
           const Score& score) {
  fmt::print("| {} | {} | {} | {} of {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} | {:.2f} |\n",
             lens, sizes, camera, score.read, score.asked, score.wrong,
             bench::quantile(score.errors, 0.5), bench::quantile(score.errors, 0.95),
             bench::quantile(score.errors, 1), bench::quantile(score.chi_squares, 0.5),
             bench::quantile(score.chi_squares, 0.95));
}

void print_pictures(int count) {
  fmt::print(
      "| lens | px a module | camera | read | wrong | corner error, px: median | 95 % | greatest "
      "| chi-square/8: median | 95 % |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Lens& lens : lenses()) {
    Score unknown[2], known[2];
    for (int i = 0; i < count; ++i) {
      const Picture picture = take_picture(lens.camera, static_cast<std::size_t>(i));
      const bool large = picture.module_px >= 2;
      ReadOptions options;
      options.check = CheckDigit::sum10;
      unknown[large].add(picture, read_tags(picture.view.image.view(), options));
      options.camera = lens.camera;
      known[large].add(picture, read_tags(picture.view.image.view(), options));
    }
    for (const bool large : {false, true}) {
      const std::string sizes = large ? "2 to 6" : "0.7 to 1.6";
      print(lens.name, sizes, "unknown", unknown[large]);
      print(lens.name, sizes, "known", known[large]);
    }
    std::fflush(stdout);
  }
}

// --- positions ---

struct Corridor {
  Survey survey;
  Rig rig;
  Run run;
};

struct Positions {
  int asked = 0;
  int located = 0;
  int tags = 0;
  double square = 0;
  double greatest = 0;
  double nees = 0;
};

Fix locate(const Corridor& corridor, const Rig& rig, const VehiclePose& vehicle,
           std::uint64_t seed) {
  ViewOptions options;
  options.lighting = tunnel_lighting();
  options.sensor.noise_sigma = 1.5;
  options.seed = seed;
  const ReaderChoice reader{read_tags, kFittedCornerSigmaPx};
  const std::vector<Survey> surveys{corridor.survey};
  Observation seen;
  for (const RigCamera& camera : rig.cameras) {
    const SurveyView view =
        render_survey_view(corridor.survey, camera, world_from_vehicle(vehicle), options, 1);
    observe_image(seen, camera, view.view.image.view(), camera.name, surveys, reader);
  }
  return localize_jointly(seen, surveys, rig);
}

void print_positions(const Corridor& corridor, int count) {
  fmt::print(
      "\n| lens | located | tags a position | root mean square error, mm | greatest, mm | NEES/3 "
      "|\n|---|---|---|---|---|---|\n");
  for (const Lens& lens : lenses()) {
    Rig rig = corridor.rig;
    for (RigCamera& camera : rig.cameras) camera.camera = lens.camera;
    Draws draws(11);
    Positions sum;
    for (int i = 0; i < count; ++i) {
      const auto& points = corridor.run.measurements;
      const Vector3d truth = *points[static_cast<std::size_t>(i) % points.size()].truth_in_grid;
      VehiclePose vehicle =
          vehicle_pose_of(vehicle_in_tunnel(corridor.survey, truth, std::nullopt));
      vehicle.heading += radians(draws.uniform(-8, 8));
      vehicle.pitch += radians(draws.uniform(-2, 2));
      vehicle.roll += radians(draws.uniform(-2, 2));
      const Fix fix = locate(corridor, rig, vehicle, static_cast<std::uint64_t>(i));
      ++sum.asked;
      if (!fix.position_in_grid) continue;
      ++sum.located;
      sum.tags += static_cast<int>(fix.tags.size());
      const Vector3d error = *fix.position_in_grid - truth;
      const Eigen::Matrix3d covariance = fix.pose_covariance_in_grid->topLeftCorner<3, 3>();
      sum.square += error.squaredNorm();
      sum.greatest = std::max(sum.greatest, error.norm());
      sum.nees += error.dot(covariance.ldlt().solve(error)) / 3;
    }
    const double n = std::max(1, sum.located);
    fmt::print("| {} | {} of {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} |\n", lens.name, sum.located,
               sum.asked, sum.tags / n, 1000 * std::sqrt(sum.square / n), 1000 * sum.greatest,
               sum.nees / n);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 45;
  const int positions = argc > 2 ? std::atoi(argv[2]) : count / 3;
  print_pictures(count);
  auto survey = load_survey("surveys/corridor/survey.yaml");
  auto rig = load_rig("surveys/corridor/rig.yaml");
  if (!survey || !rig) return 2;
  auto run = load_run("surveys/corridor/run.csv", *rig);
  if (!run) return 2;
  // Plates exactly where the survey has them: what is left is the pictures'.
  survey->sigma = 0;
  for (PlacedTag& tag : survey->tags) tag.sigma = 0;
  print_positions({std::move(*survey), std::move(*rig), std::move(*run)}, positions);
  return 0;
}
