// SPDX-License-Identifier: Apache-2.0
// Reads folders of photos that have a truth.json and tables what was read: recall by resolution,
// wrong readings, refusals where no tag is, corner errors. Usage: bench_photo_sets [-v] [-c] [-b]
// [-x GAIN] [-g GAMMA]
// [-s SHARE] FOLDER...; -v lists every tag, -c names the check digit, -b gives the folder's codes
// as the code book, -x makes the photos so many times as bright, what is whiter than white being
// lost, -g gives them another tone curve: the share of white to this power, -s casts a shadow with
// a straight edge over a plate of each, in which this share of the light is left.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/bench/corner_fit.hpp"
#include "tests/bench/median.hpp"
#include "tests/bench/other_readers.hpp"
#include "tests/bench/photo_truth.hpp"

using namespace tagsmith::detail;
using bench::CornerFit;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// Tags of one level of degradation and one range of resolution.
struct Cell {
  std::vector<int> others;  // read, as bench::other_readers()
  int tags = 0;
  int read = 0;
  std::vector<double> errors;       // of each coordinate of each corner, pixels, absolute
  std::vector<double> chi_squares;  // of each tag's corners against their covariance, over 8
};

// What a folder of photos gave.
struct Outcome {
  std::map<std::string, Cell> cells;
  int wrong = 0;
  int far = 0;             // with a corner that is more than a pixel off
  int false_refusals = 0;  // of what is no tag of ours, on which `verify` then reports
  std::vector<double> times_ms;
};

struct Photo {
  std::string file;
  ReadResult result;
  std::vector<std::set<std::string>> others;  // codes, as bench::other_readers()
};

std::string bin_of(double module_px) {
  if (module_px >= 2) return "2.0+";
  if (module_px >= 1.5) return "1.5-2.0";
  if (module_px >= 1) return "1.0-1.5";
  return module_px >= 0.8 ? "0.8-1.0" : "0.0-0.8";
}

// What the reader is told of the tags.
struct Given {
  bool check = false;
  bool book = false;
  double gain = 1;
  double gamma = 1;
  double left_in_shadow = 1;
};

// The photo as a camera with another exposure and another tone curve would have stored it.
void expose(GrayImage& image, const Given& given) {
  const ToneCurve& tone = ToneCurve::srgb();
  std::array<std::uint8_t, 256> exposed{};
  for (std::size_t i = 0; i < exposed.size(); ++i) {
    const double sample = tone.sample_of(given.gain * tone.light_of(static_cast<int>(i)));
    exposed[i] = static_cast<std::uint8_t>(std::lround(255 * std::pow(sample / 255, given.gamma)));
  }
  for (std::uint8_t& sample : image.samples) sample = exposed[sample];
}

// Where the edge of a shadow runs: through a place, and what lies across it is dark.
struct ShadowEdge {
  PixelPoint at;
  PixelPoint across;  // unit
};

// Over a plate near its middle, in another direction and at another place for each photo.
ShadowEdge edge_over(const json& plate, std::size_t number) {
  const auto corner = [&](const char* name) {
    const auto& at = plate.at("corners_px").at(name);
    return PixelPoint{at[0].get<double>(), at[1].get<double>()};
  };
  const double turns = 0.618 * static_cast<double>(number);  // the golden section spreads them
  const double angle = 2 * std::numbers::pi * turns;
  const double aside = 0.6 * (turns * 7 - std::floor(turns * 7) - 0.5);
  const PixelPoint across{std::cos(angle), std::sin(angle)};
  const PixelPoint middle = 0.5 * (corner("P") + corner("R"));
  return {middle + aside * distance(corner("P"), corner("Q")) * across, across};
}

// Leaves this share of the light beyond the edge.
void cast_shadow(GrayImage& image, const ShadowEdge& edge, double left) {
  constexpr double kPenumbra = 1.5;  // pixels, standard deviation
  const ToneCurve& tone = ToneCurve::srgb();
  std::uint8_t* sample = image.samples.data();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x, ++sample) {
      const PixelPoint here{static_cast<double>(x), static_cast<double>(y)};
      const double off = dot(here - edge.at, edge.across) / (std::numbers::sqrt2 * kPenumbra);
      const double share = 1 - (1 - left) * 0.5 * std::erfc(-off);
      *sample =
          static_cast<std::uint8_t>(std::lround(tone.sample_of(share * tone.light_of(*sample))));
    }
  }
}

ReadOptions options_for(const json& truth, const Given& given) {
  ReadOptions options;
  if (given.check) options.check = parse_check_digit(truth.at("check").get<std::string>());
  if (given.book) options.code_book = bench::codes_of(truth);
  return options;
}

void print_read(const Photo& photo, const json& plate, const Reading& reading,
                const CornerFit& fit) {
  std::string text;
  for (Eigen::Index c = 0; c < 8; c += 2) {
    text += fmt::format(" {:+.3f},{:+.3f}", fit.error[c], fit.error[c + 1]);
  }
  fmt::print("{} {} ppm {:.2f} inc {:.0f} conf {:.9f} err{} sigma {:.4f} chi2/8 {:.2f}\n",
             photo.file, to_string(reading.digits), plate.at("px_per_module").get<double>(),
             plate.at("incidence_deg").get<double>(), reading.confidence, text, fit.sigma,
             fit.chi_square);
}

void print_missed(const Photo& photo, const json& plate) {
  fmt::print("{} {} MISSED ppm {:.2f} inc {:.0f} visible {:.2f}:", photo.file,
             plate.at("code").get<std::string>(), plate.at("px_per_module").get<double>(),
             plate.at("incidence_deg").get<double>(), plate.at("fraction_visible").get<double>());
  for (const Rejection& rejection : photo.result.rejected) {
    fmt::print(" [{} {:.0f},{:.0f}]", describe(rejection), rejection.corners[0].x,
               rejection.corners[0].y);
  }
  fmt::print("\n");
}

// One plate of ours that is wholly in the picture.
void count_plate(const Photo& photo, const json& plate, bool verbose, Cell& cell) {
  const std::string code = plate.at("code").get<std::string>();
  ++cell.tags;
  cell.others.resize(photo.others.size());
  for (std::size_t r = 0; r < photo.others.size(); ++r) {
    cell.others[r] += photo.others[r].contains(code) ? 1 : 0;
  }
  const auto reading = std::ranges::find(photo.result.tags, code,
                                         [](const Reading& tag) { return to_string(tag.digits); });
  if (reading == photo.result.tags.end()) {
    if (verbose) print_missed(photo, plate);
    return;
  }
  ++cell.read;
  const CornerFit fit = bench::corner_fit(*reading, bench::corners_of(plate));
  for (const double error : fit.error) cell.errors.push_back(std::abs(error));
  cell.chi_squares.push_back(fit.chi_square);
  if (verbose) print_read(photo, plate, *reading, fit);
}

// Readings that are none of the picture's plates.
int count_wrong(const Photo& photo, const json& plates) {
  int wrong = 0;
  for (const Reading& reading : photo.result.tags) {
    const std::string code = to_string(reading.digits);
    if (std::ranges::any_of(plates, [&](const json& plate) {
          return plate.value("code", std::string()) == code;
        })) {
      continue;
    }
    ++wrong;
    fmt::print("WRONG {} {} conf {:.9f} at {:.0f},{:.0f} ppm {:.2f}\n", photo.file, code,
               reading.confidence, reading.corners[0].x, reading.corners[0].y, reading.module_px);
  }
  return wrong;
}

// Readings of the picture's plates, a second one of the same too, with a corner more than a pixel
// off.
int count_far(const Photo& photo, const json& plates) {
  int far = 0;
  for (const Reading& reading : photo.result.tags) {
    for (const json& plate : plates) {
      if (plate.value("code", std::string()) != to_string(reading.digits)) continue;
      const CornerFit fit = bench::corner_fit(reading, bench::corners_of(plate));
      if (fit.error.lpNorm<Eigen::Infinity>() <= 1) continue;
      ++far;
      fmt::print("FAR {} {} {:.2f} px off, stated {:.2f}\n", photo.file, to_string(reading.digits),
                 fit.error.lpNorm<Eigen::Infinity>(), fit.sigma);
    }
  }
  return far;
}

// Whether the middle of a refused frame is on a plate of ours, the white around its frame included.
bool is_of_plate(const Rejection& rejection, const json& plate) {
  constexpr double kPlate = 1.5;  // size by that of the frame
  Quad around = bench::corners_of(plate);
  const PixelPoint middle = centre_of(around);
  for (PixelPoint& corner : around) corner = middle + kPlate * (corner - middle);
  return contains(around, centre_of(rejection.corners));
}

int count_false_refusals(const Photo& photo, const json& plates, bool verbose) {
  int count = 0;
  for (const Rejection& rejection : photo.result.rejected) {
    const auto is_refused = [&](const json& plate) { return is_of_plate(rejection, plate); };
    if (std::ranges::any_of(plates, is_refused)) continue;
    ++count;
    if (!verbose) continue;
    const PixelPoint at = centre_of(rejection.corners);
    fmt::print("{} refused {} at {:.0f},{:.0f}, where no tag is\n", photo.file, describe(rejection),
               at.x, at.y);
  }
  return count;
}

Photo read_photo(const std::string& file, const GrayView& image, const ReadOptions& options,
                 std::vector<double>& times_ms) {
  Photo photo;
  photo.file = file;
  const auto start = std::chrono::steady_clock::now();
  photo.result = read_tags(image, options);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  times_ms.push_back(time.count());
  for (const bench::OtherReader& reader : bench::other_readers()) {
    photo.others.push_back(reader.read(image));
  }
  return photo;
}

Result<Outcome> read_folder(const fs::path& folder, const Given& given, bool verbose) {
  const Result<json> truth = bench::read_truth(folder);
  if (!truth) return tl::unexpected(truth.error());
  const ReadOptions options = options_for(*truth, given);
  Outcome outcome;
  for (const auto& item : truth->at("images")) {
    const std::string file = item.at("file").get<std::string>();
    Result<GrayImage> image = load_gray_image(folder / file);
    if (!image) return tl::unexpected(image.error());
    expose(*image, given);
    const json& plates = item.at("plates");
    if (given.left_in_shadow < 1 && !plates.empty()) {
      cast_shadow(*image, edge_over(plates[0], outcome.times_ms.size()), given.left_in_shadow);
    }
    const Photo photo = read_photo(file, image->view(), options, outcome.times_ms);
    for (const auto& plate : plates) {
      if (plate.at("kind") != "upca" || !plate.at("frame_in_image").get<bool>()) continue;
      const std::string level = item.value("level", std::string("all"));
      const std::string bin = bin_of(plate.at("px_per_module").get<double>());
      count_plate(photo, plate, verbose, outcome.cells[level + " " + bin]);
    }
    outcome.wrong += count_wrong(photo, plates);
    outcome.far += count_far(photo, plates);
    outcome.false_refusals += count_false_refusals(photo, plates, verbose);
  }
  return outcome;
}

void print(const std::string& name, const Outcome& outcome) {
  fmt::print(
      "{}: {} images, {} wrong, {} with corners far off, {} refused where no tag is, median "
      "{:.2f} ms, max {:.2f} ms\n",
      name, outcome.times_ms.size(), outcome.wrong, outcome.far, outcome.false_refusals,
      bench::median(outcome.times_ms), *std::ranges::max_element(outcome.times_ms));
  for (const auto& [cell_name, cell] : outcome.cells) {
    fmt::print(
        "  {:20} {:3}/{:3} read, corner error median {:.3f} px, of its covariance {:.2f}, at most "
        "{:.1f}",
        cell_name, cell.read, cell.tags, bench::median(cell.errors),
        bench::median(cell.chi_squares),
        cell.chi_squares.empty() ? 0 : std::ranges::max(cell.chi_squares));
    for (std::size_t r = 0; r < cell.others.size(); ++r) {
      fmt::print(", {} {}", bench::other_readers()[r].name, cell.others[r]);
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  bool verbose = false;
  Given given;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "-v") {
      verbose = true;
    } else if (argument == "-c") {
      given.check = true;
    } else if (argument == "-b") {
      given.book = true;
    } else if (argument == "-x" && i + 1 < argc) {
      given.gain = std::strtod(argv[++i], nullptr);
    } else if (argument == "-g" && i + 1 < argc) {
      given.gamma = std::strtod(argv[++i], nullptr);
    } else if (argument == "-s" && i + 1 < argc) {
      given.left_in_shadow = std::strtod(argv[++i], nullptr);
    } else {
      const Result<Outcome> outcome = read_folder(argument, given, verbose);
      if (!outcome) {
        fmt::print(stderr, "{}\n", outcome.error().message);
        return 2;
      }
      print(fs::path(argument).filename().string(), *outcome);
    }
  }
  return 0;
}
