// SPDX-License-Identifier: Apache-2.0
// What is read of photos when something befalls plate, lamp, lens or camera, by disturbance.
// Usage: bench_disturbed [-v] [-n DRAWS] [-d NAME]... FOLDER...; folders have a truth.json, -n
// draws each disturbance so many times on each photo, -d takes the named ones alone, -v lists each
// reading whose corners are off. Numbers of tags are of all draws.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/bench/corner_fit.hpp"
#include "tests/bench/disturbances.hpp"
#include "tests/bench/median.hpp"
#include "tests/bench/photo_truth.hpp"

using namespace tagsmith::detail;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

struct Photo {
  std::string file;
  GrayImage image;
  json plates;
};

// One reading of a plate, or of none.
struct Read {
  std::string text;  // photo and digits
  bool is_wrong = false;
  bench::CornerFit fit;
};

struct Outcome {
  int tags = 0;
  std::vector<Read> reads;
};

cv::Matx33d to_modules(const json& plate) {
  const FrameCorners corners = bench::corners_of(plate);
  std::vector<cv::Point2f> pixels;
  for (const PixelPoint& corner : corners) {
    pixels.emplace_back(static_cast<float>(corner.x), static_cast<float>(corner.y));
  }
  constexpr auto kLength = static_cast<float>(bench::kFrameLength);
  constexpr auto kHeight = static_cast<float>(bench::kFrameHeight);
  const std::vector<cv::Point2f> modules{{0, 0}, {kLength, 0}, {kLength, kHeight}, {0, kHeight}};
  return cv::Matx33d(cv::getPerspectiveTransform(pixels, modules));
}

bench::Scene scene_of(const Photo& photo) {
  bench::Scene scene;
  const GrayView view = photo.image.view();
  cv::Mat(view.height, view.width, CV_8U, const_cast<std::uint8_t*>(view.data))
      .copyTo(scene.picture);
  for (const json& plate : photo.plates) {
    if (plate.value("fraction_in_image", 1.0) > 0.1) scene.to_modules.push_back(to_modules(plate));
  }
  return scene;
}

Read read_of(const Photo& photo, const Reading& reading) {
  Read read;
  const std::string code = to_string(reading.digits);
  read.text = photo.file + " " + code;
  const auto plate = std::ranges::find_if(
      photo.plates, [&](const json& of) { return of.value("code", std::string()) == code; });
  read.is_wrong = plate == photo.plates.end();
  if (!read.is_wrong) read.fit = bench::corner_fit(reading, bench::corners_of(*plate));
  return read;
}

Outcome read_disturbed(const Photo& photo, const bench::Disturbance& disturbance,
                       std::uint64_t draw) {
  bench::Scene scene = scene_of(photo);
  cv::RNG draws(draw * 0x9E3779B97F4A7C15U + 1);
  for (int i = 0; i < 8; ++i) draws.next();  // neighbouring seeds begin alike
  disturbance.apply(scene, draws);
  const GrayView view{scene.picture.data, scene.picture.cols, scene.picture.rows,
                      static_cast<std::ptrdiff_t>(scene.picture.step)};
  Outcome outcome;
  for (const json& plate : photo.plates) {
    if (plate.at("kind") == "upca" && plate.at("frame_in_image").get<bool>()) ++outcome.tags;
  }
  for (const Reading& reading : read_tags(view).tags) {
    outcome.reads.push_back(read_of(photo, reading));
  }
  return outcome;
}

// Errors far beyond what is stated: the root mean square of eight coordinates is more than three of
// their standard deviations.
bool is_off(const Read& read) { return read.fit.chi_square > 10; }

void print_row(const bench::Disturbance& disturbance, const std::vector<Outcome>& outcomes,
               bool verbose) {
  int tags = 0, read = 0, wrong = 0, off = 0;
  std::vector<double> errors, chi_squares;
  for (const Outcome& outcome : outcomes) {
    tags += outcome.tags;
    for (const Read& one : outcome.reads) {
      if (one.is_wrong) {
        ++wrong;
        fmt::print("WRONG {} {}\n", disturbance.name, one.text);
        continue;
      }
      ++read;
      for (const double error : one.fit.error) errors.push_back(std::abs(error));
      chi_squares.push_back(one.fit.chi_square);
      if (!is_off(one)) continue;
      ++off;
      if (!verbose) continue;
      fmt::print("OFF {} {} {:.2f} px off, stated {:.2f}, chi-square {:.1f}\n", disturbance.name,
                 one.text, one.fit.error.lpNorm<Eigen::Infinity>(), one.fit.sigma,
                 one.fit.chi_square);
    }
  }
  fmt::print("| {} | {} | {} | {} | {} | {:.3f} | {:.1f} | {:.1f} | {:.0f} |\n", disturbance.what,
             tags, read, wrong, off, bench::quantile(errors, 0.5),
             bench::quantile(chi_squares, 0.5), bench::quantile(chi_squares, 0.95),
             bench::quantile(chi_squares, 1));
  std::fflush(stdout);
}

std::optional<std::vector<Photo>> load(const std::vector<fs::path>& folders) {
  std::vector<Photo> photos;
  for (const fs::path& folder : folders) {
    const Result<json> truth = bench::read_truth(folder);
    if (!truth) {
      fmt::print(stderr, "{}\n", truth.error().message);
      return std::nullopt;
    }
    for (const json& item : truth->at("images")) {
      const std::string file = item.at("file").get<std::string>();
      Result<GrayImage> image = load_gray_image(folder / file);
      if (!image) {
        fmt::print(stderr, "{}\n", image.error().message);
        return std::nullopt;
      }
      photos.push_back({file, std::move(*image), item.at("plates")});
    }
  }
  return photos;
}

struct Options {
  bool verbose = false;
  std::size_t draws = 1;
  std::vector<std::string> names;
  std::vector<fs::path> folders;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "-v") {
      options.verbose = true;
    } else if (argument == "-n" && i + 1 < argc) {
      options.draws = std::strtoul(argv[++i], nullptr, 10);
    } else if (argument == "-d" && i + 1 < argc) {
      options.names.emplace_back(argv[++i]);
    } else {
      options.folders.emplace_back(argument);
    }
  }
  return options;
}

bool is_known(const std::string& name) {
  const auto all = bench::disturbances();
  if (std::ranges::find(all, name, &bench::Disturbance::name) != all.end()) return true;
  fmt::print(stderr, "no disturbance is called {}; there are:", name);
  for (const bench::Disturbance& one : all) fmt::print(stderr, " {}", one.name);
  fmt::print(stderr, "\n");
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  if (!std::ranges::all_of(options.names, is_known)) return 2;
  const auto photos = load(options.folders);
  if (!photos) return 2;
  cv::setNumThreads(1);
  fmt::print(
      "| disturbance | tags | read | wrong | off | error, px | chi-square: median | 95 % | "
      "greatest |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const bench::Disturbance& disturbance : bench::disturbances()) {
    if (!options.names.empty() &&
        std::ranges::find(options.names, disturbance.name) == options.names.end()) {
      continue;
    }
    std::vector<Outcome> outcomes(photos->size() * options.draws);
    tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t i) {
      outcomes[i] = read_disturbed((*photos)[i % photos->size()], disturbance, i);
    });
    print_row(disturbance, outcomes, options.verbose);
  }
  return 0;
}
