// SPDX-License-Identifier: Apache-2.0
// Measures what the reader manages on simulated tags and writes it as the one table that the
// planner compiles in: least pixels per module by incidence and blur, and the corners' noise.
// Usage: bench_reader_limits [TAGS_PER_CELL [FILE]]
//        bench_reader_limits frames [TAGS_PER_CELL]: thin strokes, low frames and leaning plates
// against what plans take them for
//        bench_reader_limits symbols [TAGS_PER_CELL]: narrow margins and low bars
#include "tagsmith/placement/reader_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/crop.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;

namespace {

constexpr const char* kTable = "tagsmith/placement/reader_limits.inc";

// Degrees: finer where plates turn edge on. The last one is the greatest at which plans count on a
// plate at all.
constexpr std::array<double, 7> kIncidences{0, 60, 70, 76, 79, 82, 84};
constexpr std::array<double, 6> kBlurs{0.35, 0.7, 1.0, 1.4, 2.0, 2.8};
constexpr std::array<double, 7> kSigmaModules{0.4, 0.45, 0.5, 0.6, 1.0, 2.0, 4.0};
constexpr std::array<double, 4> kSigmaBlurs{0.35, 0.7, 1.4, 2.8};

constexpr std::size_t kBook = 200;  // codes in the code book
constexpr double kNoise = 4;        // grey levels, as in the ladder's typical picture
constexpr double kDistance = 2.5;   // metres, for a frame of 0.34 m
constexpr double kRoll = 10;        // degrees to either side: plates hang level

// Resolutions tried: 8 % apart, from the least that any reader could use.
double module_px_at(int step) { return 0.2 * std::pow(1.08, step); }
constexpr int kSteps = 42;            // up to 5 px
constexpr int kStepsToReliable = 16;  // what is not reliable at 3.4 times the half's never is
constexpr double kNever = 1e9;

struct Conditions {
  double module_px = 2;  // at the end of the frame that is farther away
  double incidence = 0;  // radians, the plate turned about its vertical axis
  double lean = 0;       // radians, about its horizontal axis
  double blur_px = 0.5;
  bool code_book = false;
  bool part = false;  // the picture's border cuts it: kPartInSight of the frame is in sight
  TagTemplate tag = test::corridor_template();
};

// Of a plate that is turned away the modules at the middle are wider than those at the farther end.
double middle_module_px(const Conditions& conditions) {
  const double farther = conditions.tag.frame_inner_length / 2 * std::sin(conditions.incidence);
  return conditions.module_px * std::pow(1 + farther / kDistance, 2);
}

struct Outcome {
  bool read = false;
  std::array<double, 8> errors{};  // of corner coordinates, pixels
  double chi_square = 0;           // of them by their covariance, per degree of freedom
};

// An image with room for the plate and a margin of 40 px. The lens grows with the resolution, so
// that the perspective is that of a tag at kDistance in all cells.
Camera camera_for(const Conditions& conditions) {
  Camera camera;
  const TagTemplate& tag = conditions.tag;
  const double px_per_metre = middle_module_px(conditions) / module_width(tag);
  camera.width = static_cast<int>(80 + 1.3 * px_per_metre * tag.plate_length);
  camera.height = static_cast<int>(80 + 1.3 * px_per_metre * tag.plate_height /
                                            std::max(0.1, std::cos(conditions.incidence)));
  camera.fx = camera.fy = px_per_metre * kDistance / std::cos(conditions.incidence);
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  return camera;
}

// Turned about its vertical axis, as a plate on a wall is, to this width of its modules.
ScenePlate place(const Camera& camera, const Digits& code, const Conditions& conditions,
                 std::mt19937_64& random) {
  std::uniform_real_distribution<double> either(-1, 1);
  const double way = either(random) < 0 ? -1 : 1;
  const double roll = radians(kRoll) * either(random);
  const Eigen::Vector2d pixel(camera.cx + either(random), camera.cy + either(random));
  return bench::plate_at(camera, draw_tag(conditions.tag, code),
                         {pixel, middle_module_px(conditions), way * conditions.incidence, roll,
                          way * conditions.lean});
}

// The columns up to the place along a frame's middle, from either of its ends, where its part in
// sight ends; the camera is moved with them.
GrayView cut(GrayView picture, const PlateTruth& plate, bool keeps_left, Camera& camera) {
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d corner = plate.corners[i].value_or(Eigen::Vector2d::Zero());
    corners[i] = {corner.x(), corner.y()};
  }
  const double share = keeps_left ? kPartInSight : 1 - kPartInSight;
  const int place = static_cast<int>(std::lround(homography_to(corners)(share, 0.5).x));
  const bench::Crop crop =
      keeps_left ? bench::Crop{0, place + 1} : bench::Crop{place, picture.width - place};
  camera.width = crop.width;
  camera.cx -= crop.first;
  return bench::cropped(picture, crop);
}

bool identifies(const ReadResult& result, const Digits& code) {
  return std::ranges::any_of(result.parts, [&](const PartReading& part) {
    return part.candidates.size() == 1 && part.candidates.front().digits == code;
  });
}

Outcome run_one(const Conditions& conditions, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Digits code = bench::random_code(random);
  const Camera camera = camera_for(conditions);
  const ScenePlate plate = place(camera, code, conditions, random);
  ViewOptions view;
  view.sensor.blur_sigma_px = conditions.blur_px;
  view.sensor.noise_sigma = kNoise;
  view.sensor.exposure = 0.85;
  view.seed = seed;
  const View picture = render_view(camera, std::span(&plate, 1), view);
  ReadOptions options;
  options.check = CheckDigit::gs1;
  options.layouts = {layout_of(conditions.tag)};
  if (conditions.code_book) options.code_book = bench::book_with(code, kBook, random);
  Outcome outcome;
  if (conditions.part) {
    Camera known = camera;
    const GrayView part =
        cut(picture.image.view(), picture.plates.front(), random() % 2 == 0, known);
    options.camera = known;
    outcome.read = identifies(read_tags(part, options), code);
    return outcome;
  }
  for (const Reading& reading : read_tags(picture.image.view(), options).tags) {
    if (reading.digits != code) continue;
    outcome.read = true;
    outcome.errors = bench::corner_errors(reading, picture.plates.front());
    outcome.chi_square = bench::corner_chi_square(reading, picture.plates.front());
  }
  return outcome;
}

std::vector<Outcome> run_cell(const Conditions& conditions, int count) {
  std::vector<Outcome> outcomes(static_cast<std::size_t>(count));
  tbb::parallel_for(std::size_t{0}, outcomes.size(),
                    [&](std::size_t i) { outcomes[i] = run_one(conditions, 1000 + i); });
  return outcomes;
}

double share_read(const std::vector<Outcome>& outcomes) {
  return static_cast<double>(std::ranges::count_if(outcomes, &Outcome::read)) /
         static_cast<double>(outcomes.size());
}

// Resolutions tried in one cell, and what share was read.
class Ladder {
 public:
  Ladder(const Conditions& conditions, int count) : conditions_(conditions), count_(count) {}

  double read_at(int step) {
    if (!shares_.contains(step)) {
      conditions_.module_px = module_px_at(step);
      shares_[step] = share_read(run_cell(conditions_, count_));
    }
    return shares_[step];
  }

  // The least step in (low, high] at which this share is read, found by halving; `high` + 1 when
  // none is enough.
  int least_step(double share, int low, int high) {
    ++high;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (read_at(middle) >= share ? high : low) = middle;
    }
    return high;
  }

 private:
  Conditions conditions_;
  int count_;
  std::map<int, double> shares_;
};

// Standard deviation of a coordinate, from the median of the errors without their sign.
double corner_sigma(const Conditions& conditions, int count) {
  std::vector<double> errors;
  for (const Outcome& outcome : run_cell(conditions, count)) {
    if (outcome.read) errors.insert(errors.end(), outcome.errors.begin(), outcome.errors.end());
  }
  if (errors.empty()) return 1;
  std::ranges::sort(errors);
  return 1.4826 * errors[errors.size() / 2];
}

std::string number(double value) {
  return value >= kNever ? "kNever" : fmt::format("{:.3f}", value);
}

template <class Values>
std::string list(const Values& values, const std::function<std::string(double)>& text) {
  std::string line;
  for (const double value : values) line += (line.empty() ? "" : ", ") + text(value);
  return "{" + line + "}";
}

using Rows = std::array<std::array<double, kBlurs.size()>, kIncidences.size()>;
using Table = std::array<Rows, 2>;

std::string cells(const std::string& name, const Table& table) {
  std::string text =
      fmt::format("constexpr double {}[2][{}][{}] = {{\n", name, kIncidences.size(), kBlurs.size());
  for (const auto& rows : table) {
    text += "    {\n";
    for (const auto& row : rows) text += "        " + list(row, number) + ",\n";
    text += "    },\n";
  }
  return text + "};\n";
}

std::string cells(const std::string& name, const Rows& rows) {
  std::string text =
      fmt::format("constexpr double {}[{}][{}] = {{\n", name, kIncidences.size(), kBlurs.size());
  for (const auto& row : rows) text += "    " + list(row, number) + ",\n";
  return text + "};\n";
}

struct Limits {
  Table reliable{};
  Table half{};
};

// Where half and where 99 % are read, pixels per module; kNever where not even half are.
struct Least {
  double half = kNever;
  double reliable = kNever;
};

Least least_module_px(const Conditions& conditions, int count) {
  Ladder ladder(conditions, count);
  Least least;
  if (ladder.read_at(kSteps) < 0.5) return least;
  const int half = ladder.least_step(0.5, -1, kSteps);
  least.half = module_px_at(half);
  const int last = std::min(kSteps, half + kStepsToReliable);
  const int reliable = ladder.least_step(0.99, half - 1, last);
  if (reliable <= last) least.reliable = module_px_at(reliable);
  return least;
}

// Of parts of tags, 99 %.
Rows measure_parts(int count) {
  Rows least{};
  for (std::size_t i = 0; i < kIncidences.size(); ++i) {
    for (std::size_t b = 0; b < kBlurs.size(); ++b) {
      Conditions conditions;
      conditions.incidence = radians(kIncidences[i]);
      conditions.blur_px = kBlurs[b];
      conditions.code_book = conditions.part = true;
      const Least cell = least_module_px(conditions, count);
      least[i][b] = cell.reliable;
      fmt::print("| part | {} | {} | {:.2f} | {:.2f} |\n", kIncidences[i], kBlurs[b], cell.reliable,
                 cell.half);
      std::fflush(stdout);
    }
  }
  return least;
}

Limits measure_limits(int count) {
  Limits limits;
  for (std::size_t book = 0; book < 2; ++book) {
    for (std::size_t i = 0; i < kIncidences.size(); ++i) {
      for (std::size_t b = 0; b < kBlurs.size(); ++b) {
        Conditions conditions;
        conditions.incidence = radians(kIncidences[i]);
        conditions.blur_px = kBlurs[b];
        conditions.code_book = book == 1;
        const Least cell = least_module_px(conditions, count);
        limits.half[book][i][b] = cell.half;
        limits.reliable[book][i][b] = cell.reliable;
        fmt::print("| {} | {} | {} | {:.2f} | {:.2f} |\n", book == 1 ? "yes" : "no", kIncidences[i],
                   kBlurs[b], limits.reliable[book][i][b], limits.half[book][i][b]);
        std::fflush(stdout);
      }
    }
  }
  return limits;
}

std::string measure_corners(int count) {
  std::string text = fmt::format("constexpr double kCornerSigmaPx[{}][{}] = {{\n",
                                 kSigmaModules.size(), kSigmaBlurs.size());
  for (const double module_px : kSigmaModules) {
    std::vector<double> row;
    for (const double blur_px : kSigmaBlurs) {
      Conditions conditions;
      conditions.module_px = module_px;
      conditions.incidence = radians(30);
      conditions.blur_px = blur_px;
      conditions.code_book = true;
      row.push_back(corner_sigma(conditions, count));
    }
    text += "    " + list(row, number) + ",\n";
  }
  return text + "};\n";
}

// --- other frames than the table's ---

struct Frame {
  double stroke = 0;  // modules
  double height = 0;  // inner, modules
  double lean = 0;    // degrees
};

// Module width at which 99 % are read, beside the one that plans ask for.
void compare_frame(const Frame& frame, double blur_px, int count) {
  Conditions conditions;
  conditions.blur_px = blur_px;
  conditions.code_book = true;
  const double usual = tagsmith::detail::least_module_px(true, 0, blur_px, ReadShare::reliable);
  conditions.tag.frame_stroke = frame.stroke * module_width(conditions.tag);
  conditions.tag.frame_inner_height = frame.height * module_width(conditions.tag);
  conditions.lean = radians(frame.lean);
  const Least least = least_module_px(conditions, count);
  const double planned = usual / frame_share(conditions.tag, std::cos(conditions.lean));
  fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", frame.stroke, frame.height,
             frame.lean, blur_px, least.reliable, least.half, planned);
  std::fflush(stdout);
}

void compare_frames(int count) {
  fmt::print(
      "| stroke, modules | inner height, modules | leaning, degrees | blur, px | px/module, 99 % "
      "read | 50 % read | as planned |\n|---|---|---|---|---|---|---|\n");
  constexpr double kStroke = 3.95, kHeight = 55.3;  // of the table's template
  for (const double blur_px : {0.35, 0.7, 1.4}) {
    for (const double stroke : {1.0, 2.0, 3.0, 6.0}) {
      for (const double lean : {0.0, 60.0, 75.0}) {
        compare_frame({stroke, kHeight, lean}, blur_px, count);
      }
    }
    for (const double height : {40.0, 30.0, 23.0}) {
      compare_frame({kStroke, height, 0}, blur_px, count);
    }
    for (const double lean : {45.0, 70.0, 80.0}) {
      compare_frame({kStroke, kHeight, lean}, blur_px, count);
    }
  }
}

// --- other symbols than the table's ---

// How many are read at the width of modules that plans ask for and at multiples of it, and the
// corners' mean chi-square per degree of freedom.
void compare_symbol(Conditions conditions, int count) {
  const double planned = tagsmith::detail::least_module_px(true, conditions.incidence,
                                                           conditions.blur_px, ReadShare::reliable);
  fmt::print(
      "| {} | {:.1f} | {:.1f} | {:.0f} |", conditions.tag.name, conditions.tag.margin_modules,
      bar_height(conditions.tag) / module_width(conditions.tag), degrees(conditions.incidence));
  for (const double times : {1.0, 3.0}) {
    conditions.module_px = times * planned / frame_share(conditions.tag, 1);
    std::vector<Outcome> outcomes = run_cell(conditions, count);
    std::erase_if(outcomes, [](const Outcome& outcome) { return !outcome.read; });
    double sum = 0;
    for (const Outcome& outcome : outcomes) sum += outcome.chi_square;
    const double read = static_cast<double>(outcomes.size());
    fmt::print(" {:.0f} % | {:.2f} |", 100 * read / count, sum / std::max(1.0, read));
  }
  fmt::print("\n");
  std::fflush(stdout);
}

void compare_symbols(int count) {
  fmt::print(
      "| template | margin, modules | bars, modules | incidence | read as planned | chi-square | "
      "3 times as wide | chi-square |\n"
      "|---|---|---|---|---|---|---|---|\n");
  TagTemplate large = test::corridor_template();
  large.name = "tag-1400x750";
  large.plate_length = 1.4, large.plate_height = 0.75;
  large.frame_inner_length = 1.244, large.frame_inner_height = 0.56, large.frame_stroke = 0.036;
  for (const double incidence : {0.0, 70.0}) {
    for (const TagTemplate& tag : {test::corridor_template(), large}) {
      Conditions conditions;
      conditions.tag = tag;
      conditions.incidence = radians(incidence);
      conditions.blur_px = 0.7;
      conditions.code_book = true;
      for (const double margin : {9.0, 4.0, 3.0, 2.0, 1.0, 0.0}) {
        conditions.tag.margin_modules = margin;
        compare_symbol(conditions, count);
      }
      for (const double bars : {20.0, 12.0, 6.0, 3.0, 1.0}) {
        conditions.tag.margin_modules = (tag.frame_inner_height / module_width(tag) - bars) / 2;
        compare_symbol(conditions, count);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "frames") {
    compare_frames(argc > 2 ? std::max(1, std::atoi(argv[2])) : 100);
    return 0;
  }
  if (argc > 1 && std::string(argv[1]) == "symbols") {
    compare_symbols(argc > 2 ? std::max(1, std::atoi(argv[2])) : 100);
    return 0;
  }
  const int count = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::string file = argc > 2 ? argv[2] : kTable;
  if (count < 1) {
    fmt::print(stderr,
               "usage: bench_reader_limits [TAGS_PER_CELL [FILE]]\n"
               "       bench_reader_limits frames|symbols [TAGS_PER_CELL]\n");
    return 2;
  }
  fmt::print(
      "| code book | incidence | blur, px | px/module, 99 % read | 50 % read |\n"
      "|---|---|---|---|---|\n");
  const auto plain = [](double value) { return fmt::format("{}", value); };
  const Limits limits = measure_limits(count);
  const std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Written by `./dev bench limits`, {} simulated tags a cell; not to be edited.\n"
      "constexpr std::array<double, {}> kIncidencesDeg{};\n"
      "constexpr std::array<double, {}> kBlursPx{};\n"
      "// [without, with code book][incidence][blur]: least px/module of which 99 % are read.\n"
      "{}"
      "// The same for 50 %.\n"
      "{}"
      "// Of parts of tags, with code book: [incidence][blur], least px/module of which 99 % are "
      "identified.\n"
      "{}"
      "constexpr std::array<double, {}> kSigmaModulesPx{};\n"
      "constexpr std::array<double, {}> kSigmaBlursPx{};\n"
      "// [px/module][blur]: standard deviation of a corner's coordinate, pixels, at 30 degrees.\n"
      "{}",
      count, kIncidences.size(), list(kIncidences, plain), kBlurs.size(), list(kBlurs, plain),
      cells("kReliableModulePx", limits.reliable), cells("kHalfModulePx", limits.half),
      cells("kPartModulePx", measure_parts(count)), kSigmaModules.size(),
      list(kSigmaModules, plain), kSigmaBlurs.size(), list(kSigmaBlurs, plain),
      measure_corners(count));
  const Result<void> written = write_file(file, text);
  if (!written) {
    fmt::print(stderr, "bench_reader_limits: {}\n", written.error().message);
    return 2;
  }
  fmt::print("written: {}\n", file);
  return 0;
}
