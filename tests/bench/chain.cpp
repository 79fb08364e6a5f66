// SPDX-License-Identifier: Apache-2.0
// What the reader manages on tags as phones and webcams store them: simulated through camera chains
// whose strengths are drawn anew for each tag, by resolution. Usage: bench_chain [N] [SEED] [-v]
// [-w] [-c] [-b]; N tags for each chain and resolution; -w: plates white on black; -c: the scheme
// of the check digit is named; -b: small tags, with a code book of 400, as a plan takes them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/simulate/sensor.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/drawn_chain.hpp"
#include "tests/bench/median.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;

namespace {

struct Outcome {
  bool read = false;
  bool wrong = false;
  Eigen::Matrix<double, 8, 1> error;  // of corner coordinates, pixels
  double outward = 0;                 // mean over the corners of how far the frame is too large
  double chi_square = 0;              // over 8
  double growth = 0;                  // pixels, of the bars
};

bool white_on_black = false;
std::optional<CheckDigit> check;  // nothing = either
bool with_book = false;

Camera camera_for(double module_px) {
  Camera camera;
  camera.width = camera.height = static_cast<int>(std::max(320.0, 190.0 * module_px));
  camera.fx = camera.fy = 1600;
  camera.cx = camera.cy = (camera.width - 1) / 2.0;
  return camera;
}

ScenePlate place(const Camera& camera, const Digits& code, double module_px,
                 std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(0, 1);
  const double tilt = radians(55 * any(random)) * (any(random) < 0.5 ? 1 : -1);
  const double roll = 2 * std::numbers::pi * any(random);
  const double size = module_px * (0.92 + 0.16 * any(random));
  const Eigen::Vector2d pixel(camera.cx + 5 * any(random), camera.cy + 5 * any(random));
  TagTemplate tag = test::corridor_template();
  tag.white_on_black = white_on_black;
  return bench::plate_at(camera, draw_tag(tag, code), {pixel, size, tilt, roll});
}

void note_corners(const Reading& reading, const PlateTruth& truth, Outcome& outcome) {
  const FrameCorners corners = bench::corners_of(truth);
  const bench::CornerFit fit = bench::corner_fit(reading, corners);
  outcome.error = fit.error;
  outcome.chi_square = fit.chi_square;
  PixelPoint middle{};
  for (const PixelPoint& corner : corners) middle = middle + 0.25 * corner;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PixelPoint outward = corners[i] - middle;
    outcome.outward += dot(reading.corners[i] - corners[i], outward) / length(outward) / 4;
  }
}

Result<Outcome> run_one(const std::string& name, double module_px, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  const Digits code = bench::random_code(random);
  const Camera camera = camera_for(module_px);
  const ScenePlate plate = place(camera, code, module_px, random);
  const CameraChain chain = bench::drawn_chain(name, random);
  ViewOptions view;
  view.sensor.blur_sigma_px = 0.4 + 0.2 * any(random);
  view.sensor.exposure = 0.85;
  view.sensor.noise_sigma = 1.5;
  if (name != "none") view.sensor = through_chain(view.sensor, chain);
  view.seed = seed;
  const View picture = render_view(camera, std::span(&plate, 1), view);
  const auto stored = compressed(picture.image.view(), chain.jpeg_quality);
  if (!stored) return tl::unexpected(stored.error());
  Outcome outcome;
  ReadOptions options;
  options.white_on_black = white_on_black;
  options.check = check;
  if (with_book) {
    options.code_book = {code};
    while (options.code_book.size() < 400) options.code_book.push_back(bench::random_code(random));
  }
  for (const Reading& reading : read_tags(stored->view(), options).tags) {
    if (reading.digits != code) {
      outcome.wrong = true;
      continue;
    }
    outcome.read = true;
    if (reading.symbol) {
      outcome.growth = reading.symbol->decoding.fit.image.growth * reading.module_px;
    }
    note_corners(reading, picture.plates.front(), outcome);
  }
  return outcome;
}

void print_cell(const std::string& name, double module_px, const std::vector<Outcome>& outcomes) {
  constexpr double kOf95Percent = 15.507 / 8;  // chi-square of eight degrees of freedom
  int wrong = 0, beyond = 0;
  std::vector<double> errors, chi_squares, outward;
  for (const Outcome& outcome : outcomes) {
    wrong += outcome.wrong ? 1 : 0;
    if (!outcome.read) continue;
    for (const double error : outcome.error) errors.push_back(std::abs(error));
    chi_squares.push_back(outcome.chi_square);
    outward.push_back(outcome.outward);
    beyond += outcome.chi_square > kOf95Percent ? 1 : 0;
  }
  double mean = 0;
  for (const double value : chi_squares) mean += value / static_cast<double>(chi_squares.size());
  fmt::print("| {} | {} | {} of {} | {} | {:.3f} | {:+.3f} | {:.2f} | {:.2f} | {:.0f} % |\n", name,
             module_px, chi_squares.size(), outcomes.size(), wrong, bench::quantile(errors, 0.5),
             bench::quantile(outward, 0.5), bench::quantile(chi_squares, 0.5), mean,
             100.0 * beyond / std::max<double>(1, static_cast<double>(chi_squares.size())));
  std::fflush(stdout);
}

void list(const std::vector<Outcome>& outcomes) {
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    fmt::print("{} {}{} outward {:+.3f} growth {:+.3f} chi2/8 {:.2f}\n", i,
               outcome.read ? "read" : "missed", outcome.wrong ? " WRONG" : "", outcome.outward,
               outcome.growth, outcome.chi_square);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 40;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const std::vector<std::string> flags(argv + std::min(argc, 3), argv + argc);
  const bool verbose = std::ranges::count(flags, "-v") > 0;
  white_on_black = std::ranges::count(flags, "-w") > 0;
  if (std::ranges::count(flags, "-c") > 0) check = CheckDigit::gs1;
  with_book = std::ranges::count(flags, "-b") > 0;
  if (count < 1) {
    fmt::print(stderr, "usage: bench_chain [TAGS_PER_CELL] [SEED] [-v] [-w] [-c] [-b]\n");
    return 2;
  }
  fmt::print(
      "| chain | px a module | read | wrong | corner error, median px | outward | chi-square a "
      "degree: median | mean | beyond 95 % |\n|---|---|---|---|---|---|---|---|---|\n");
  const std::vector<double> resolutions =
      with_book ? std::vector{0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.8, 0.95}
                : std::vector{0.8, 1.1, 1.5, 2.1, 3.0, 4.2};
  for (const std::string name : {"none", "mild", "strong", "night"}) {
    for (const double module_px : resolutions) {
      std::vector<Outcome> outcomes(static_cast<std::size_t>(count));
      std::vector<std::string> failures(outcomes.size());
      tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t i) {
        const auto outcome = run_one(name, module_px, 100'000 * seed + 1000 + i);
        if (outcome) outcomes[i] = *outcome;
        if (!outcome) failures[i] = outcome.error().message;
      });
      for (const std::string& failure : failures) {
        if (failure.empty()) continue;
        fmt::print(stderr, "{}\n", failure);
        return 2;
      }
      if (verbose) list(outcomes);
      print_cell(name, module_px, outcomes);
    }
  }
  return 0;
}
