// SPDX-License-Identifier: Apache-2.0
// Looks for wrong readings: simulated tags degraded at random in every way at once, tags whose
// check digit is wrong, and frames that hold other symbols (random stripes, EAN-13, a gap in the
// code). Tables the stated confidence against what was right. Usage: bench_read_mass [TAGS] [SEED]
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith;

namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

int integer(std::mt19937_64& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

Digits random_code(std::mt19937_64& random) {
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(integer(random, 0, 9));
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

// Element widths that are no UPC-A symbol: 0 = random stripes, 1 = EAN-13 (three of the left digits
// mirrored), 2 = one digit drawn with widths of no digit.
std::vector<int> foreign_elements(int kind, const Digits& digits, std::mt19937_64& random) {
  const auto elements = elements_of(digits);
  std::vector<int> widths(elements.begin(), elements.end());
  if (kind == 0) {
    for (std::size_t i = 3; i + 3 < widths.size(); ++i) widths[i] = integer(random, 1, 4);
    return widths;
  }
  std::array<int, 5> places{1, 2, 3, 4, 5};
  std::ranges::shuffle(places, random);
  for (std::size_t k = 0; k < (kind == 1 ? 3U : 1U); ++k) {
    const auto first = widths.begin() + first_element_of_digit(places[k]);
    if (kind == 1) {
      std::reverse(first, first + kElementsPerDigit);
    } else {
      constexpr std::array<int, 4> kNoDigit{2, 3, 1, 1};
      std::ranges::copy(kNoDigit, first);
    }
  }
  return widths;
}

// The symbol's bars from element widths, scaled to the usual 95 modules.
std::vector<Rectangle> bars_from(const std::vector<int>& widths, const TagDrawing& drawing) {
  int total = 0;
  for (const int width : widths) total += width;
  const double module = drawing.module * kModuleCount / total;
  const Rectangle& first = drawing.bars.front();
  std::vector<Rectangle> bars;
  double x = first.x;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (i % 2 == 0) bars.push_back({x, first.y, widths[i] * module, first.height});
    x += widths[i] * module;
  }
  return bars;
}

enum class Kind { tag, wrong_check, stripes, ean13, no_digit, count };

std::string name_of(Kind kind) {
  switch (kind) {
    case Kind::tag:
      return "tags";
    case Kind::wrong_check:
      return "wrong check digit";
    case Kind::stripes:
      return "random stripes";
    case Kind::ean13:
      return "EAN-13 in a frame";
    default:
      return "one digit of no kind";
  }
}

void degrade(ScenePlate& plate, SensorModel& sensor, std::mt19937_64& random) {
  sensor.blur_sigma_px = std::exp(uniform(random, std::log(0.3), std::log(2.5)));
  sensor.noise_sigma = uniform(random, 0, 1) < 0.3 ? uniform(random, 5, 40) : uniform(random, 0, 6);
  sensor.tone = uniform(random, 0, 1) < 0.3 ? SensorTone::linear : SensorTone::srgb;
  sensor.exposure = uniform(random, 0.1, 1.3);
  if (uniform(random, 0, 1) < 0.3) {
    sensor.motion_px = {uniform(random, -6, 6), uniform(random, -6, 6)};
  }
  const double contrast = uniform(random, 0.15, 1);
  plate.finish.white_reflectance = 0.435 + 0.385 * contrast;
  plate.finish.ink_reflectance = 0.435 - 0.385 * contrast;
  if (uniform(random, 0, 1) < 0.4) plate.finish.bar_growth = uniform(random, -0.8, 0.8);
  if (uniform(random, 0, 1) < 0.3) {
    plate.finish.shading = {uniform(random, -0.6, 0.6), uniform(random, -0.6, 0.6)};
  }
  if (uniform(random, 0, 1) < 0.3) {
    plate.finish.dirt = {uniform(random, 0, 0.4), uniform(random, 0.005, 0.05),
                         uniform(random, 0.05, 0.6), random()};
  }
  const Rectangle& frame = plate.drawing.frame_inner;
  if (uniform(random, 0, 1) < 0.25) {
    plate.finish.cover = {{uniform(random, 0, frame.width), uniform(random, -0.05, frame.height),
                           uniform(random, 0.01, 0.15), uniform(random, 0.01, 0.2)},
                          uniform(random, 0, 0.9)};
  }
  if (uniform(random, 0, 1) < 0.2) {
    plate.finish.glare = {{uniform(random, 0, frame.width), uniform(random, 0, frame.height)},
                          uniform(random, 0.01, 0.08),
                          uniform(random, 0.2, 3)};
  }
}

struct Outcome {
  Kind kind = Kind::tag;
  bool right = false;
  bool wrong = false;
  double confidence = 0;
  std::string story;
};

Outcome run_one(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Outcome outcome;
  const double lot = uniform(random, 0, 1);
  outcome.kind = lot < 0.6   ? Kind::tag
                 : lot < 0.7 ? Kind::wrong_check
                 : lot < 0.8 ? Kind::stripes
                 : lot < 0.9 ? Kind::ean13
                             : Kind::no_digit;
  Digits code = random_code(random);
  if (outcome.kind == Kind::wrong_check) {
    code.back() = static_cast<std::uint8_t>((code.back() + integer(random, 1, 9)) % 10);
  }
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), code);
  if (outcome.kind == Kind::stripes || outcome.kind == Kind::ean13 ||
      outcome.kind == Kind::no_digit) {
    const int kind = static_cast<int>(outcome.kind) - static_cast<int>(Kind::stripes);
    plate.drawing.bars = bars_from(foreign_elements(kind, code, random), plate.drawing);
  }
  const double module_px = std::exp(uniform(random, std::log(0.3), std::log(4.0)));
  Camera camera;
  camera.width = camera.height = static_cast<int>(std::max(120.0, 170.0 * module_px));
  camera.fx = camera.fy = 1600;
  camera.cx = camera.cy = (camera.width - 1) / 2.0;
  const double tilt =
      radians(uniform(random, 0, 1) < 0.7 ? uniform(random, 0, 45) : uniform(random, 45, 75));
  const double distance = camera.fx * plate.drawing.module * std::cos(tilt) / module_px;
  plate.camera_from_plate = camera_from_turned_plate(
      camera, plate.drawing, {camera.cx, camera.cy}, distance,
      uniform(random, 0, 1) < 0.5 ? tilt : -tilt, radians(uniform(random, -20, 20)),
      uniform(random, 0, 2 * std::numbers::pi));
  ViewOptions view;
  view.seed = seed;
  view.background_light = uniform(random, 0.02, 0.7);
  degrade(plate, view.sensor, random);
  const View picture = render_view(camera, std::span(&plate, 1), view);
  ReadOptions options;
  if (uniform(random, 0, 1) < 0.5) options.check = CheckDigit::gs1;
  options.min_confidence = 0.5;
  for (const Reading& reading : read_tags(picture.image.view(), options).tags) {
    const bool known = reading.digits == code && outcome.kind == Kind::tag;
    // Without a stated scheme a wrong gs1 digit may be a right sum10 one: that is no misreading.
    const bool excusable = outcome.kind == Kind::wrong_check && reading.digits == code;
    if (excusable) continue;
    outcome.right = outcome.right || known;
    outcome.confidence = std::max(outcome.confidence, reading.confidence);
    if (known) continue;
    outcome.wrong = true;
    outcome.confidence = reading.confidence;
    outcome.story = fmt::format(
        "seed {} {}: {} for {}, confidence 1 - {:.2g}, {:.2f} px/module, blur {:.2f}, noise "
        "{:.1f}, "
        "growth {:.2f}",
        seed, name_of(outcome.kind), to_string(reading.digits), to_string(code),
        1 - reading.confidence, reading.module_px, view.sensor.blur_sigma_px,
        view.sensor.noise_sigma, plate.finish.bar_growth);
  }
  return outcome;
}

struct Tally {
  int shown = 0;
  int right = 0;
  int wrong = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 10000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  if (count < 1) {
    fmt::print(stderr, "usage: bench_read_mass [TAGS] [SEED]\n");
    return 2;
  }
  std::atomic<int> next = 0;
  std::mutex guard;
  std::map<std::string, Tally> kinds;
  std::map<int, Tally> doubts;  // by -log10(1 - confidence), at most 12
  const double threshold = ReadOptions{}.min_confidence;
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) {
      const Outcome outcome = run_one(seed * 1'000'000'000ULL + static_cast<std::uint64_t>(i));
      const std::scoped_lock lock(guard);
      Tally& kind = kinds[name_of(outcome.kind)];
      ++kind.shown;
      const bool sure = outcome.confidence >= threshold;
      kind.right += outcome.right && sure ? 1 : 0;
      kind.wrong += outcome.wrong && sure ? 1 : 0;
      if (outcome.wrong && sure) fmt::print("WRONG {}\n", outcome.story);
      if (!outcome.right && !outcome.wrong) continue;
      const double doubt = -std::log10(std::max(1 - outcome.confidence, 1e-12));
      Tally& bin = doubts[static_cast<int>(std::floor(doubt))];
      bin.right += outcome.wrong ? 0 : 1;
      bin.wrong += outcome.wrong ? 1 : 0;
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    threads.emplace_back(work);
  }
  threads.clear();
  fmt::print(
      "| what was in the frame | shown | read | wrong, stated as sure |\n|---|---|---|---|\n");
  for (const auto& [name, tally] : kinds) {
    fmt::print("| {} | {} | {} | {} |\n", name, tally.shown, tally.right, tally.wrong);
  }
  fmt::print(
      "\n| stated doubt, 1 - confidence | readings | wrong | observed |\n|---|---|---|---|\n");
  for (const auto& [doubt, tally] : doubts) {
    const int readings = tally.right + tally.wrong;
    fmt::print("| 1e-{} to 1e-{} | {} | {} | {:.2g} |\n", doubt, doubt + 1, readings, tally.wrong,
               static_cast<double>(tally.wrong) / readings);
  }
  return 0;
}
