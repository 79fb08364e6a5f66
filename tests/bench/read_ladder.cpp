// SPDX-License-Identifier: Apache-2.0
// What the reader manages on simulated tags, one degradation at a time: share read, wrong readings
// and corner errors by pixels per module, incidence, roll, blur, noise, bar growth and tone curve.
// Usage: bench_read_ladder [TAGS_PER_CELL] [rolls]; with `rolls` small tags by their roll alone,
// and how many of those that were not read a reader could tell that knows the picture exactly.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/reader/judge.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/scan/tuning.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/median.hpp"
#include "tests/bench/other_readers.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;

namespace {

struct Conditions {
  double module_px = 2;
  double incidence = 0;  // radians; random up to 40 degrees where negative
  double roll = -1;      // radians; random where negative
  double blur_px = 0.5;  // sigma; a camera's own pixels come on top
  double noise = 4;      // grey levels
  double exposure = 1;   // times that of a plate that is not quite white
  double growth = 0;     // modules
  double contrast = 1;   // of the plate, 1 = 0.82 against 0.05
  double motion_px = 0;
  SensorTone tone = SensorTone::srgb;
  std::size_t book = 0;  // codes in the code book; 0 = none
  bool ask_ideal = false;
};

struct OtherOutcome {
  bool read = false;
  bool wrong = false;
};

struct Outcome {
  std::vector<OtherOutcome> others;  // as bench::other_readers()
  bool read = false;
  bool wrong = false;
  bool is_told = true;             // where it is asked: by the picture to an ideal reader
  std::array<double, 8> errors{};  // of corner coordinates, pixels
  double chi_square = 0;           // of them, per degree of freedom
};

Camera camera_for(double module_px) {
  Camera camera;
  const double size = std::max(200.0, 190.0 * module_px);
  camera.width = static_cast<int>(size);
  camera.height = static_cast<int>(size);
  camera.fx = camera.fy = 1600;
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  return camera;
}

ScenePlate place(const Camera& camera, const Digits& code, const Conditions& conditions,
                 std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(0, 1);
  const double tilt = conditions.incidence < 0 ? radians(40 * any(random)) : conditions.incidence;
  const double way = any(random) < 0.5 ? 1 : -1;
  const double roll = conditions.roll < 0 ? 2 * std::numbers::pi * any(random) : conditions.roll;
  const Eigen::Vector2d pixel(camera.cx + any(random), camera.cy + any(random));
  ScenePlate plate = bench::plate_at(camera, draw_tag(test::corridor_template(), code),
                                     {pixel, conditions.module_px, way * tilt, roll});
  plate.finish.bar_growth = conditions.growth;
  plate.finish.white_reflectance = 0.435 + 0.385 * conditions.contrast;
  plate.finish.ink_reflectance = 0.435 - 0.385 * conditions.contrast;
  return plate;
}

// Squared differences of two pictures over the variance of a pixel.
double chi_square_between(const GrayImage& a, const GrayImage& b, double variance) {
  double sum = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    const double off = static_cast<double>(a.samples[i]) - static_cast<double>(b.samples[i]);
    sum += off * off / variance;
  }
  return sum;
}

// Whether a reader that knows camera, plate and noise exactly could believe the code by the limits
// of ours: every code with a single other digit, which is a misprint or a stranger, changes the
// picture by enough.
bool is_told(const Camera& camera, ScenePlate plate, const Digits& code, ViewOptions view,
             bool with_book) {
  const double least =
      with_book ? 2 * std::log(kOdds.near_stranger / (1 - kSureWithBook))
                : 2 * std::log(kOdds.understated * kOdds.wrong_check / (1 - kSureInFrame));
  const double variance = std::pow(view.sensor.noise_sigma, 2) + 1.0 / 12;
  view.sensor.noise_sigma = 0;
  const auto picture_of = [&](const Digits& digits) {
    plate.drawing = draw_tag(test::corridor_template(), digits);
    return render_view(camera, std::span(&plate, 1), view).image;
  };
  const GrayImage as_it_is = picture_of(code);
  for (std::size_t place = 0; place < kDigitCount; ++place) {
    Digits other = code;
    for (std::uint8_t digit = 0; digit < 10; ++digit) {
      if (digit == code[place]) continue;
      other[place] = digit;
      if (chi_square_between(as_it_is, picture_of(other), variance) < least) return false;
    }
  }
  return true;
}

Outcome run_one(const Conditions& conditions, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Digits code = bench::random_code(random);
  const Camera camera = camera_for(conditions.module_px);
  const ScenePlate plate = place(camera, code, conditions, random);
  ViewOptions view;
  view.sensor.blur_sigma_px = conditions.blur_px;
  view.sensor.noise_sigma = conditions.noise;
  view.sensor.tone = conditions.tone;
  view.sensor.motion_px = {conditions.motion_px, 0};
  view.sensor.exposure = 0.85 * conditions.exposure;
  view.seed = seed;
  const View picture = render_view(camera, std::span(&plate, 1), view);
  ReadOptions options;
  if (conditions.book > 0) options.code_book = bench::book_with(code, conditions.book, random);
  Outcome outcome;
  const GrayView view_of_picture = picture.image.view();
  for (const bench::OtherReader& reader : bench::other_readers()) {
    const std::set<std::string> codes = reader.read(view_of_picture);
    const bool right = codes.contains(to_string(code));
    outcome.others.push_back({right, codes.size() > (right ? 1U : 0U)});
  }
  for (const Reading& reading : read_tags(view_of_picture, options).tags) {
    if (reading.digits != code) {
      outcome.wrong = true;
      continue;
    }
    outcome.read = true;
    outcome.errors = bench::corner_errors(reading, picture.plates.front());
    outcome.chi_square = bench::corner_chi_square(reading, picture.plates.front());
  }
  if (conditions.ask_ideal && !outcome.read) {
    outcome.is_told = is_told(camera, plate, code, view, conditions.book > 0);
  }
  return outcome;
}

void run_cell(const std::string& name, const Conditions& conditions, int count) {
  std::vector<Outcome> outcomes(static_cast<std::size_t>(count));
  tbb::parallel_for(std::size_t{0}, outcomes.size(),
                    [&](std::size_t i) { outcomes[i] = run_one(conditions, 1000 + i); });
  int read = 0, wrong = 0, untold = 0;
  std::vector<double> errors, chi_squares;
  for (const Outcome& outcome : outcomes) {
    wrong += outcome.wrong ? 1 : 0;
    untold += outcome.is_told ? 0 : 1;
    if (!outcome.read) continue;
    ++read;
    errors.insert(errors.end(), outcome.errors.begin(), outcome.errors.end());
    chi_squares.push_back(outcome.chi_square);
  }
  fmt::print("| {} | {:.1f} % | {} | {:.3f} | {:.2f} |", name, 100.0 * read / count, wrong,
             bench::median(errors), bench::median(chi_squares));
  if (conditions.ask_ideal) fmt::print(" {:.1f} % |", 100.0 * (count - untold) / count);
  for (std::size_t r = 0; r < bench::other_readers().size(); ++r) {
    int others_read = 0;
    int others_wrong = 0;
    for (const Outcome& outcome : outcomes) {
      others_read += outcome.others[r].read ? 1 : 0;
      others_wrong += outcome.others[r].wrong ? 1 : 0;
    }
    fmt::print(" {:.0f} %, {} |", 100.0 * others_read / count, others_wrong);
  }
  fmt::print("\n");
  std::fflush(stdout);
}

// Turned by up to 40 degrees, and in the picture's plane at will.
Conditions typical() {
  Conditions conditions;
  conditions.incidence = -1;
  return conditions;
}

void print_head(int count, bool ask_ideal) {
  fmt::print(
      "| condition ({} tags each) | read | wrong | median corner error, px | chi-square a degree |",
      count);
  if (ask_ideal) fmt::print(" an ideal reader |");
  for (const bench::OtherReader& reader : bench::other_readers()) {
    fmt::print(" {}: read, wrong |", reader.name);
  }
  fmt::print("\n|---|---|---|---|---|{}", ask_ideal ? "---|" : "");
  for (std::size_t r = 0; r < bench::other_readers().size(); ++r) fmt::print("---|");
  fmt::print("\n");
}

void run_resolutions(int count) {
  for (const double module_px : {0.35, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0, 4.0}) {
    Conditions conditions = typical();
    conditions.module_px = module_px;
    run_cell(fmt::format("{} px/module, incidence 0-40", module_px), conditions, count);
    conditions.blur_px = 0.35;
    conditions.noise = 2;
    run_cell(fmt::format("{} px/module, clean", module_px), conditions, count);
    if (module_px > 0.6) continue;
    conditions = typical();
    conditions.module_px = module_px;
    conditions.book = 200;
    run_cell(fmt::format("{} px/module, code book of 200", module_px), conditions, count);
  }
}

// Small tags whose bars stand along the pixels' columns or rows, as a level camera sees them, or
// across them; through a lens of usual sharpness and one sharper than the pixels.
void run_rolls(int count) {
  for (const double module_px : {0.4, 0.5, 0.6, 0.8}) {
    for (const double roll : {0.0, 2.0, 5.0, 15.0, 90.0}) {
      for (const double blur_px : {0.1, 0.2, 0.35, 0.5}) {
        Conditions conditions;
        conditions.module_px = module_px;
        conditions.roll = radians(roll);
        conditions.blur_px = blur_px;
        conditions.noise = 1.5;
        conditions.ask_ideal = true;
        if (module_px == 0.4) conditions.book = 200;
        run_cell(fmt::format("roll {} at {} px/module, blur sigma {} px{}", roll, module_px,
                             blur_px, conditions.book > 0 ? ", code book of 200" : ""),
                 conditions, count);
      }
    }
  }
}

void run_views(int count) {
  for (const double incidence : {50.0, 60.0, 65.0, 70.0}) {
    Conditions conditions;
    conditions.module_px = 1.5;
    conditions.incidence = radians(incidence);
    run_cell(fmt::format("incidence {} at 1.5 px/module", incidence), conditions, count);
  }
  for (const double roll : {10.0, 30.0, 45.0, 70.0, 90.0}) {
    Conditions conditions = typical();
    conditions.roll = radians(roll);
    run_cell(fmt::format("roll {} at 2 px/module", roll), conditions, count);
  }
}

void run_spoilt(int count) {
  for (const double noise : {10.0, 20.0, 30.0}) {
    Conditions conditions = typical();
    conditions.noise = noise;
    run_cell(fmt::format("noise sigma {} at 2 px/module", noise), conditions, count);
  }
  for (const double growth : {-0.6, -0.4, -0.2, 0.2, 0.4, 0.6}) {
    Conditions conditions = typical();
    conditions.growth = growth;
    run_cell(fmt::format("bar growth {} at 2 px/module", growth), conditions, count);
  }
  for (const double blur : {1.0, 1.5, 2.0}) {
    Conditions conditions = typical();
    conditions.blur_px = blur;
    run_cell(fmt::format("blur sigma {} px at 2 px/module", blur), conditions, count);
  }
}

void run_cameras(int count) {
  Conditions linear = typical();
  linear.tone = SensorTone::linear;
  run_cell("linear camera at 2 px/module", linear, count);
  Conditions pale = typical();
  pale.contrast = 0.25;
  run_cell("quarter contrast at 2 px/module", pale, count);
  for (const double exposure : {2, 3, 4}) {
    Conditions bright = typical();
    bright.exposure = exposure;
    run_cell(fmt::format("exposure {} times at 2 px/module", exposure), bright, count);
    bright.module_px = 1;
    run_cell(fmt::format("exposure {} times at 1 px/module", exposure), bright, count);
  }
  Conditions motion = typical();
  motion.motion_px = 4;
  run_cell("motion of 4 px at 2 px/module", motion, count);
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 60;
  if (count < 1) {
    fmt::print(stderr, "usage: bench_read_ladder [TAGS_PER_CELL] [rolls]\n");
    return 2;
  }
  if (argc > 2) {
    print_head(count, true);
    run_rolls(count);
    return 0;
  }
  print_head(count, false);
  run_resolutions(count);
  run_views(count);
  run_spoilt(count);
  run_cameras(count);
  return 0;
}
