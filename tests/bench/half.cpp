// SPDX-License-Identifier: Apache-2.0
// What is read of tags that the picture's border cuts, by the share of the bars in sight.
// Usage: bench_half [-v] [FOLDER...] | bench_half drive [N] [SEED] [K1]
// [ROWS]
//
// With folders of photos that have a truth.json: the tags in sight, something in front of them or
// not, those that the border cuts, and each whole one with the photo cropped across its bars at a
// drawn place or, of upright tags, beside its bars or along its length, or with a post painted over
// what is cut off. The book holds the folder's codes. `drive`: pictures simulated on the center
// lines of the shipped surveys, their plates and cameras taken for exact, these with lenses of this
// first coefficient of distortion (0) and with the upper ROWS of their pictures (all); what of the
// line has a position with and without parts of tags, and how true the positions' covariances are.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tests/bench/corner_fit.hpp"
#include "tests/bench/crop.hpp"
#include "tests/bench/fix_trial.hpp"
#include "tests/bench/median.hpp"
#include "tests/bench/photo_truth.hpp"
#include "tests/support/draws.hpp"

using namespace tagsmith::detail;
using nlohmann::json;
using test::Draws;
namespace fs = std::filesystem;

namespace {

struct Row {
  int tags = 0, whole = 0, identified = 0, candidates = 0, wrong = 0;
  std::vector<double> errors;       // of coordinates of corners, pixels
  std::vector<double> chi_squares;  // over 8
};

// By tenths of the bars' length in sight.
using Table = std::array<Row, 11>;

void count_corners(const auto& read, const FrameCorners& truth, Row& row) {
  const bench::CornerFit fit = bench::corner_fit(read, truth);
  for (const double off : fit.error) row.errors.push_back(std::abs(off));
  row.chi_squares.push_back(fit.chi_square);
}

// Counts what was read of a plate; whether the part is its.
void count_plate(const ReadResult& result, const Digits& code, const FrameCorners& truth,
                 double share, const std::string& story, bool verbose, Table& table) {
  Row& row = table[static_cast<std::size_t>(std::clamp(10 * share, 0.0, 10.0))];
  ++row.tags;
  const auto near = [&](const PartReading& part) {
    const PixelPoint middle = 0.5 * (truth[0] + truth[2]);
    return contains(part.corners, middle) || distance(part.corners[0], truth[0]) < 20;
  };
  const auto is_it = [&](const PartCandidate& candidate) { return candidate.digits == code; };
  const bool is_whole =
      std::ranges::any_of(result.tags, [&](const Reading& tag) { return tag.digits == code; });
  const auto part = std::ranges::find_if(result.parts, near);
  std::string said = is_whole ? "whole" : "nothing";
  if (is_whole) {
    ++row.whole;
    count_corners(*std::ranges::find(result.tags, code, &Reading::digits), truth, row);
  } else if (part != result.parts.end()) {
    const bool holds = std::ranges::any_of(part->candidates, is_it);
    const bool single = part->candidates.size() == 1;
    said = !holds ? "WRONG" : single ? "identified" : "candidates";
    ++(!holds ? row.wrong : single ? row.identified : row.candidates);
    if (holds) count_corners(*part, truth, row);
    if (holds) said += fmt::format(" chi2/8 {:.2f}", row.chi_squares.back());
    said += " " + digits_in_sight(*part);
  }
  if (verbose || said.starts_with("WRONG")) {
    fmt::print("{} {} share {:.2f}: {}\n", story, to_string(code), share, said);
  }
}

void print(const Table& table) {
  fmt::print(
      "| bars in sight | tags | read whole | identified | several candidates | wrong | "
      "corner error, median | chi-square / 8, mean | greatest "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Row& row = table[i];
    if (row.tags == 0) continue;
    double mean = 0, greatest = 0;
    for (const double value : row.chi_squares) {
      mean += value / static_cast<double>(row.chi_squares.size());
      greatest = std::max(greatest, value);
    }
    fmt::print("| {} to {} % | {} | {} | {} | {} | {} | {:.3f} px | {:.2f} | {:.1f} |\n", 10 * i,
               std::min<std::size_t>(100, 10 * i + 10), row.tags, row.whole, row.identified,
               row.candidates, row.wrong, bench::median(row.errors), mean, greatest);
  }
}

// The camera of a part of a photo that begins at a pixel.
Camera camera_of(const json& item, const GrayView& part, PixelPoint first) {
  const json& truth = item.at("camera");
  Camera camera;
  camera.width = part.width;
  camera.height = part.height;
  camera.fx = truth.at("fx").get<double>();
  camera.fy = truth.at("fy").get<double>();
  camera.cx = truth.at("cx").get<double>() - first.x;
  camera.cy = truth.at("cy").get<double>() - first.y;
  camera.distortion = {truth.at("k1").get<double>(), truth.at("k2").get<double>()};
  return camera;
}

// A round post before all that a crop cuts off of a tag, leaning a little.
GrayImage with_post(const GrayView& image, const FrameCorners& corners, const bench::Crop& crop,
                    std::mt19937_64& random) {
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  GrayImage result = copy_of(image);
  const auto [left, right] = std::ranges::minmax(corners, {}, &PixelPoint::x);
  const bool keeps_left = crop.first == 0;
  const double edge = keeps_left ? crop.width : crop.first;
  const double across = (keeps_left ? right.x - edge : edge - left.x) * uniform(1.3, 2);
  const double lean = uniform(-0.1, 0.1), grey = uniform(20, 150);
  const double height = 0.5 * (corners[0].y + corners[2].y);
  for (int y = 0; y < image.height; ++y) {
    const double from = edge + lean * (y - height) - (keeps_left ? 0 : across);
    for (int x = 0; x < image.width; ++x) {
      const double at = (x - from) / across;
      if (at < 0 || at > 1) continue;
      const double shade = 0.4 + 0.6 * std::sin(std::numbers::pi * at);
      const double noise = std::normal_distribution(0.0, 2.0)(random);
      result.samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                     static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(std::clamp(grey * shade + noise, 0.0, 255.0));
    }
  }
  return result;
}

// Whether a column of pixels crosses a tag along its bars, or nearly so.
bool is_upright(const FrameCorners& corners) {
  return std::abs(corners[1].x - corners[0].x) > 0.7 * distance(corners[0], corners[1]);
}

// Reads a folder's photos as they are and cropped.
bool read_folder(const fs::path& folder, bool verbose) {
  const Result<json> truth = bench::read_truth(folder);
  if (!truth) {
    fmt::print(stderr, "{}\n", truth.error().message);
    return false;
  }
  ReadOptions options;
  options.code_book = bench::codes_of(*truth);
  options.check = parse_check_digit(truth->at("check").get<std::string>());
  Table whole, as_they_are, cut, sides, heights, posts;
  std::mt19937_64 random(1), random_side(1), random_height(1);
  for (const auto& item : truth->at("images")) {
    const std::string file = item.at("file").get<std::string>();
    const Result<GrayImage> image = load_gray_image(folder / file);
    if (!image) {
      fmt::print(stderr, "{}\n", image.error().message);
      return false;
    }
    const GrayView view = image->view();
    options.camera = camera_of(item, view, {});
    const ReadResult result = read_tags(view, options);
    for (const auto& plate : item.at("plates")) {
      if (plate.at("kind") != "upca" ||
          plate.at("px_per_module").get<double>() < bench::kLeastCroppedModule)
        continue;
      const Digits code = parse_digits(plate.at("code").get<std::string>()).value();
      const FrameCorners corners = bench::corners_of(plate);
      const double share = bench::share_in_sight(corners, view.width, view.height);
      if (!plate.at("frame_in_image").get<bool>()) {
        if (share > 0.1) count_plate(result, code, corners, share, file, verbose, as_they_are);
        continue;
      }
      count_plate(result, code, corners, plate.value("fraction_visible", 1.0), file, verbose,
                  whole);
      const auto count_part = [&](const GrayView& part, PixelPoint first, const std::string& which,
                                  std::optional<double> left, Table& table) {
        options.camera = camera_of(item, part, first);
        const FrameCorners there = bench::moved(corners, -1 * first);
        const double in_sight =
            left ? *left : bench::share_in_sight(there, part.width, part.height);
        count_plate(read_tags(part, options), code, there, in_sight, file + which, verbose, table);
        return in_sight;
      };
      const auto count_columns = [&](const bench::Crop& crop, Table& table) {
        return count_part(bench::cropped(view, crop), {static_cast<double>(crop.first), 0},
                          fmt::format(" columns {} to {}", crop.first, crop.first + crop.width),
                          std::nullopt, table);
      };
      const bench::Crop crop = bench::random_crop(corners, view.width, random);
      const double in_sight = count_columns(crop, cut);
      if (is_upright(corners)) {
        count_columns(bench::side_crop(corners, view.width, random_side), sides);
        const double kept = std::uniform_real_distribution(0.4, 1.0)(random_height);
        const bool above = random_height() % 2 == 0;
        const auto rows = bench::row_crop_at(above ? kept : 1 - kept, above, corners, view.height);
        count_part(bench::cropped(view, rows), {0, static_cast<double>(rows.first)},
                   fmt::format(" rows {} to {}", rows.first, rows.first + rows.height), kept,
                   heights);
      }
      const GrayImage behind = with_post(view, corners, crop, random);
      options.camera = camera_of(item, view, {});
      count_plate(read_tags(behind.view(), options), code, corners, in_sight,
                  file + " behind a post", verbose, posts);
    }
  }
  fmt::print("\n{}: whole frames, by the share of the plate that nothing hides\n\n",
             folder.string());
  print(whole);
  fmt::print("\n{}: cut by the border, {} px a module and more\n\n", folder.string(),
             bench::kLeastCroppedModule);
  print(as_they_are);
  fmt::print("\n{}: cropped\n\n", folder.string());
  print(cut);
  fmt::print("\n{}: cropped beside the bars\n\n", folder.string());
  print(sides);
  fmt::print("\n{}: cropped along the bars' height, by the share of it that is left\n\n",
             folder.string());
  print(heights);
  fmt::print("\n{}: behind a post\n\n", folder.string());
  print(posts);
  return true;
}

// --- simulated drives ---

struct Positions {
  int located = 0;
  int confirmed = 0;
  int off = 0;         // by five standard deviations
  double squares = 0;  // normalised, of all three coordinates

  void count(const Fix& fix, const VehiclePose& truth, const Grid& grid) {
    if (!fix.position_in_grid) return;
    const bench::PoseError error = bench::error_of(fix, truth, grid);
    const Eigen::Vector3d position = error.error.head<3>();
    const Eigen::Matrix3d covariance = error.covariance.topLeftCorner<3, 3>();
    ++located;
    confirmed += fix.confirmations > 0 ? 1 : 0;
    off += error.greatest_sigmas() > 5 ? 1 : 0;
    squares += position.dot(covariance.ldlt().solve(position)) / 3;
  }
};

// What was seen at a place of a drive, and what came of it.
struct Driven {
  int poses = 0;
  int parts = 0, wrong = 0;  // parts read; with no candidate that hangs there
  Positions without, with, only_changed;
};

bench::Site exact_site(bench::Site site, double k1, int rows) {
  constexpr double kExact = 1e-6;  // metres, radians
  for (PlacedTag& tag : site.survey.tags) tag.sigma = kExact;
  site.survey.angle_sigma = kExact;
  for (RigCamera& camera : site.rig.cameras) {
    camera.calibration_sigma = {};
    camera.camera.distortion = {k1, k1 * k1};
    camera.camera.height = std::min(camera.camera.height, rows);
  }
  return site;
}

void drive(const bench::Site& site, Draws& draws, Driven& driven) {
  const Tunnel& tunnel = site.survey.tunnel;
  const CenterlinePoint point = tunnel.centerline.at(draws.uniform(0, tunnel.centerline.length()));
  VehiclePose vehicle;
  vehicle.position = point.position + site.rig.vehicle_height * Eigen::Vector3d::UnitZ();
  vehicle.heading = point.heading;
  const std::vector<Survey> surveys{site.survey};
  Observation seen;
  for (const RigCamera& camera : site.rig.cameras) {
    ViewOptions options;
    options.lighting = tunnel_lighting();
    options.sensor.noise_sigma = 2;
    options.seed = draws.index(1U << 30U);
    const SurveyView view =
        render_survey_view(site.survey, camera, world_from_vehicle(vehicle), options, 7);
    observe_image(seen, camera, view.view.image.view(), camera.name, surveys,
                  {read_tags, kFittedCornerSigmaPx});
    for (const SeenPart& part : seen.parts) {
      if (part.camera != camera.name) continue;
      ++driven.parts;
      driven.wrong +=
          std::ranges::none_of(view.tags,
                               [&](std::size_t tag) {
                                 return std::ranges::any_of(
                                     part.candidates, [&](const SurveyedTag& candidate) {
                                       return candidate.tag->digits == site.survey.tags[tag].digits;
                                     });
                               })
              ? 1
              : 0;
    }
  }
  Observation whole = seen;
  whole.parts.clear();
  const Fix with = localize_jointly(seen, surveys, site.rig);
  ++driven.poses;
  driven.without.count(localize_jointly(whole, surveys, site.rig), vehicle, site.survey.grid);
  driven.with.count(with, vehicle, site.survey.grid);
  const bool changed = std::ranges::any_of(
      with.corners, [](const FittedCorners& corners) { return corners.used && corners.is_part; });
  if (changed) driven.only_changed.count(with, vehicle, site.survey.grid);
}

int read_drives(int count, std::uint64_t seed, double k1, int rows) {
  fmt::print(
      "| survey | places | parts read | wrong | located, confirmed, off by 5 sigma, NEES: "
      "without parts | with parts | where parts are used |\n|---|---|---|---|---|---|---|\n");
  for (const char* name : {"corridor", "curved"}) {
    auto site = bench::load_shipped_site(name);
    if (!site) {
      fmt::print(stderr, "{}\n", site.error().message);
      return 2;
    }
    const bench::Site exact = exact_site(*std::move(site), k1, rows);
    Driven driven;
    Draws draws(seed);
    for (int i = 0; i < count; ++i) drive(exact, draws, driven);
    const auto cells = [](const Positions& positions) {
      return fmt::format("{}, {}, {}, {:.2f}", positions.located, positions.confirmed,
                         positions.off, positions.squares / std::max(1, positions.located));
    };
    fmt::print("| {} | {} | {} | {} | {} | {} | {} |\n", name, driven.poses, driven.parts,
               driven.wrong, cells(driven.without), cells(driven.with), cells(driven.only_changed));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool verbose = std::erase(arguments, "-v") > 0;
  if (!arguments.empty() && arguments[0] == "drive") {
    return read_drives(arguments.size() > 1 ? std::stoi(arguments[1]) : 200,
                       arguments.size() > 2 ? std::stoull(arguments[2]) : 1,
                       arguments.size() > 3 ? std::stod(arguments[3]) : 0,
                       arguments.size() > 4 ? std::stoi(arguments[4]) : 1 << 20);
  }
  for (const std::string& argument : arguments) {
    if (!read_folder(argument, verbose)) return 2;
  }
  return 0;
}
